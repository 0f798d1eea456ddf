// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/sol.hpp"

#include "lcp/io/output_file.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/ampl/nl_tokens.hpp"

namespace perp::ncp::ampl {
namespace {

// Lines without an empty one among them, for an empty line ends the message.
std::string message_lines(const std::string& message) {
  std::string text;
  for (std::size_t begin = 0; begin < message.size();) {
    std::size_t end = message.find('\n', begin);
    if (end == std::string::npos) end = message.size();
    std::string line = message.substr(begin, end - begin);
    std::erase_if(line, [](char c) { return c == '\0' || c == '\r'; });
    text += (line.empty() ? " " : line) + "\n";
    begin = end + 1;
  }
  // Trailing empty lines say nothing.
  while (text.ends_with("\n \n")) text.resize(text.size() - 2);
  return text == " \n" ? "" : text;
}

bool has_tolerance(const SolFormat& f) { return f.options.size() > 2 && f.options[0] > 2 && f.options[2] == 3; }

// The block's own first number; a tolerance counts for two.
int announced(const SolFormat& f) { return f.options[0] + (has_tolerance(f) ? 2 : 0); }

std::string as_text(const SolFormat& f, const std::string& message, std::span<const double> x, int code) {
  std::string out = message_lines(message) + "\n";
  const auto line = [&](const std::string& value) { out += value + "\n"; };
  if (f.options[0] > 0) {
    line("Options");
    line(std::to_string(announced(f)));
    for (std::size_t i = 1; i < f.options.size(); ++i) line(std::to_string(f.options[i]));
    for (int size : {f.n_con, 0, f.n_var, static_cast<int>(x.size())}) line(std::to_string(size));
    if (has_tolerance(f)) line(number(f.tolerance));
  }
  for (double value : x) line(number(value));
  line("objno 0 " + std::to_string(code));
  return out;
}

// Every record lies between two copies of its length, as Fortran's unformatted files have it.
class Records {
 public:
  template <class... T>
  void record(const T&... values) {
    std::string content;
    (append(content, values), ...);
    integer(out_, static_cast<int>(content.size()));
    out_ += content;
    integer(out_, static_cast<int>(content.size()));
  }
  std::string take() { return std::move(out_); }

 private:
  static void integer(std::string& to, int value) { to.append(reinterpret_cast<const char*>(&value), sizeof value); }
  static void append(std::string& to, const std::string& text) { to += text; }
  static void append(std::string& to, std::span<const int> values) {
    for (int v : values) integer(to, v);
  }
  static void append(std::string& to, std::span<const double> values) {
    to.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  std::string out_;
};

std::string as_binary(const SolFormat& f, const std::string& message, std::span<const double> x, int code) {
  Records out;
  out.record(std::string("binary"));
  std::string lines = message_lines(message);
  if (!lines.empty()) {
    lines.pop_back();
    out.record(lines);
  }
  out.record();
  if (f.options[0] > 0) {
    std::vector<int> numbers = f.options;
    numbers[0] = announced(f);
    for (int size : {f.n_con, 0, f.n_var, static_cast<int>(x.size())}) numbers.push_back(size);
    const std::vector<double> tolerance(has_tolerance(f) ? 1 : 0, f.tolerance);
    out.record(std::string("Options"), std::span<const int>(numbers), std::span<const double>(tolerance));
  }
  out.record();  // the dual values
  out.record(x);
  const std::vector<int> objno{0, code};
  out.record(std::span<const int>(objno));
  return out.take();
}

}  // namespace

std::string sol_text(const SolFormat& format, const std::string& message, std::span<const double> x, int code) {
  return format.binary ? as_binary(format, message, x, code) : as_text(format, message, x, code);
}

void write_whole(const std::string& path, const std::string& content) {
  try {
    lcp::write_file(path, content, lcp::Sync::No);  // AMPL reads it at once; a sync takes ten times the solve
  } catch (const lcp::FileError& error) {
    throw ModelError(bad_file, error.what());
  }
}

}  // namespace perp::ncp::ampl
