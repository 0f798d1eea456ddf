// SPDX-License-Identifier: Apache-2.0
#include "app/worker/sol_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "app/program/program.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::app::compare {

namespace {

static_assert(std::endian::native == std::endian::little, "binary .sol files are of the machine that writes them");

constexpr std::size_t most_options = 11;  // 9, and two for a tolerance
constexpr std::string_view binary_head{"\x06\0\0\0binary\x06\0\0\0", 14};

struct Sizes {
  long long rows = 0, duals = 0, variables = 0, values = 0;
};

void check_sizes(const Sizes& sizes, ncp::Index variables) {
  const auto check = [](const char* what, long long is, long long should) {
    if (is != should && is != 0) throw input_error("{} {} instead of {}", is, what, should);
  };
  if (sizes.variables != variables) throw input_error("for {} variables, the model has {}", sizes.variables, variables);
  if (sizes.rows < 0) throw input_error("for {} rows", sizes.rows);
  check("dual values", sizes.duals, sizes.rows);
  check("values", sizes.values, sizes.variables);
}

/// Of k options announced: is the second of them 3? (Two of the k are a tolerance then.)
bool has_tolerance(long long announced, const std::vector<long long>& options) {
  return announced > 4 && options.size() > 1 && options[1] == 3;
}

/// Text, line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  bool ended() const { return text_.empty(); }
  std::string_view next() {
    if (text_.empty()) throw InputError("it ends too early");
    const std::size_t end = text_.find('\n');
    if (end == std::string_view::npos) throw InputError("its last line is cut off");
    std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  double real(std::string_view what) {
    const std::string line(next());
    char* end = nullptr;
    const double value = std::strtod(line.c_str(), &end);
    if (end == line.c_str() || !blank(line, end)) throw input_error("'{:.40}' is no {}", line, what);
    return value;
  }
  long long integer(std::string_view what) {
    const std::string line(next());
    char* end = nullptr;
    const long long value = std::strtoll(line.c_str(), &end, 10);
    if (end == line.c_str() || !blank(line, end)) throw input_error("'{:.40}' is no {}", line, what);
    return value;
  }

 private:
  /// From there to the line's end, which the first NUL need not be.
  static bool blank(const std::string& line, const char* from) {
    return line.find_first_not_of(" \t", static_cast<std::size_t>(from - line.c_str())) == std::string::npos;
  }
  std::string_view text_;
};

SolFile parse_text(std::string_view text, ncp::Index variables) {
  SolFile sol;
  Lines lines(text);
  bool ended = false;  // the message, by an empty line: "Options" may be a line of it
  for (std::string_view line = lines.next(); !ended || line != "Options"; line = lines.next()) {
    (sol.message += sol.message.empty() || line.empty() ? "" : "\n") += line;
    ended = line.empty();
  }
  const long long announced = lines.integer("number of options");
  if (announced < 0 || announced > static_cast<long long>(most_options)) throw input_error("{} options", announced);
  std::vector<long long> options;
  while (static_cast<long long>(options.size()) < announced - (has_tolerance(announced, options) ? 2 : 0))
    options.push_back(lines.integer("option"));
  Sizes sizes;
  for (long long* size : {&sizes.rows, &sizes.duals, &sizes.variables, &sizes.values}) *size = lines.integer("size");
  check_sizes(sizes, variables);
  if (has_tolerance(announced, options)) lines.real("tolerance");
  for (long long i = 0; i < sizes.duals; ++i) lines.real("dual value");
  sol.x.resize(sizes.values);
  for (double& value : sol.x) value = lines.real("value");
  const std::string objno(lines.next());
  int objective = 0;
  int length = 0;  // of what is read; nine digits are within an int
  if (std::sscanf(objno.c_str(), "objno %9d %9d %n", &objective, &sol.code, &length) != 2 ||
      static_cast<std::size_t>(length) != objno.size())
    throw input_error("'{:.40}' where objno belongs", objno);
  return sol;
}

/// Fortran's records.
class Records {
 public:
  explicit Records(std::string_view bytes) : bytes_(bytes) {}

  std::string_view next() {
    const auto length = static_cast<std::size_t>(integer());
    if (length > bytes_.size()) throw InputError("it ends within a record");
    const std::string_view record = bytes_.substr(0, length);
    bytes_.remove_prefix(length);
    if (static_cast<std::size_t>(integer()) != length) throw InputError("a record's two lengths differ");
    return record;
  }

 private:
  std::uint32_t integer() {
    std::uint32_t value = 0;
    if (bytes_.size() < sizeof value) throw InputError("it ends too early");
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  std::string_view bytes_;
};

std::vector<long long> integers(std::string_view record) {
  std::vector<long long> numbers;
  for (; record.size() >= sizeof(int); record.remove_prefix(sizeof(int))) {
    int number = 0;
    std::memcpy(&number, record.data(), sizeof number);
    numbers.push_back(number);
  }
  return numbers;
}

SolFile parse_binary(std::string_view bytes, ncp::Index variables) {
  SolFile sol;
  Records records(bytes.substr(binary_head.size()));
  for (std::string_view record = records.next(); !record.empty(); record = records.next()) sol.message += record;
  std::string_view record = records.next();
  constexpr std::string_view head = "Options";
  if (!record.starts_with(head)) throw InputError("no record of options");
  std::vector<long long> numbers = integers(record.substr(head.size()));
  const long long announced = numbers.empty() ? -1 : numbers.front();
  if (announced < 0 || announced > static_cast<long long>(most_options)) throw input_error("{} options", announced);
  numbers.erase(numbers.begin());
  const auto count = static_cast<std::size_t>(announced) - (has_tolerance(announced, numbers) ? 2U : 0U);
  if (numbers.size() < count + 4) throw InputError("its record of options is short");
  const Sizes sizes{numbers[count], numbers[count + 1], numbers[count + 2], numbers[count + 3]};
  check_sizes(sizes, variables);
  if (records.next().size() != static_cast<std::size_t>(sizes.duals) * sizeof(double))
    throw InputError("its record of dual values has another length");
  record = records.next();
  if (record.size() != static_cast<std::size_t>(sizes.values) * sizeof(double))
    throw InputError("its record of values has another length");
  sol.x.resize(sizes.values);
  if (!record.empty()) std::memcpy(sol.x.data(), record.data(), record.size());  // none: no address to copy to
  const std::vector<long long> objno = integers(records.next());
  if (objno.size() < 2) throw InputError("no record of objno");
  sol.code = static_cast<int>(objno[1]);
  return sol;
}

}  // namespace

SolFile parse_sol(std::string_view text, ncp::Index variables) {
  text = lcp::without_utf8_mark(text);
  if (text.empty()) throw InputError("it is empty");
  return text.starts_with(binary_head) ? parse_binary(text, variables) : parse_text(text, variables);
}

}  // namespace perp::app::compare
