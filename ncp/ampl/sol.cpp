#include "ncp/ampl/sol.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

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

[[noreturn]] void refuse(const std::string& path, int error) {
  throw ModelError(bad_file, path + ": cannot be written: " + std::strerror(error));
}

// A new file beside `path`, so that the rename stays within one file system.
int create_beside(const std::string& path, std::string& temporary) {
  for (int attempt = 0;; ++attempt) {
    temporary = path + "." + std::to_string(::getpid()) + "-" + std::to_string(attempt);
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST || attempt >= 1000) return fd;
  }
}

}  // namespace

std::string sol_text(const SolFormat& format, const std::string& message, std::span<const double> x, int code) {
  return format.binary ? as_binary(format, message, x, code) : as_text(format, message, x, code);
}

void write_whole(const std::string& path, const std::string& content) {
  std::string temporary;
  const int fd = create_beside(path, temporary);
  if (fd < 0) refuse(path, errno);
  int error = 0;
  for (std::size_t done = 0; done < content.size() && error == 0;) {
    const ssize_t wrote = ::write(fd, content.data() + done, content.size() - done);
    if (wrote >= 0)
      done += static_cast<std::size_t>(wrote);
    else if (errno != EINTR)
      error = errno;
  }
  if (::close(fd) != 0 && error == 0) error = errno;
  if (error == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    refuse(path, error);
  }
}

}  // namespace perp::ncp::ampl
