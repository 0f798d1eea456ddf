// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace perp::lcp {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

bool parse(std::string_view token, double& value) {
  if (token.starts_with('+')) token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(token).c_str(), nullptr);  // 0, inf
  return (error == std::errc() || error == std::errc::result_out_of_range) && end == token.data() + token.size();
}

}  // namespace

Index Numbers::integer(const char* what, Index least, Index most) {
  const std::string_view token = next(what);
  long long value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || end != token.data() + token.size()) refuse(what, " is '", token, "', not an integer");
  if (value < least || value > most) refuse(what, " is ", value, ", not within ", least, " and ", most);
  return static_cast<Index>(value);
}

double Numbers::number(const char* what) {
  const std::string_view token = next(what);
  double value = 0;
  if (!parse(token, value)) refuse(what, ": '", token, "' is not a number");
  if (!std::isfinite(value)) refuse(what, " has an entry ", token);
  return value;
}

void Numbers::expect(const char* what, Index rows, Index columns) const {
  const auto room = static_cast<double>(rest_.size() + 1) / 2;
  if (static_cast<double>(rows) * static_cast<double>(columns) > room)
    refuse(what, " has ", rows, " x ", columns, " entries, more than the rest of the file can hold");
}

Vec Numbers::vector(const char* what, Index n) {
  expect(what, n, 1);
  Vec v(n);
  for (Index i = 0; i < n; ++i) v[i] = number(what);
  return v;
}

void Numbers::word(const std::string& expected) {
  if (const std::string_view found = next(expected.c_str()); found != expected)
    refuse("'", found, "' stands where '", expected, "' should be");
}

void Numbers::skip_line() { rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size())); }

Eigen::MatrixXd Numbers::by_rows(const char* what, Index rows, Index columns) {
  expect(what, rows, columns);
  Eigen::MatrixXd A(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) A(i, j) = number(what);
  return A;
}

Index Numbers::left() const {
  Index count = 0;
  bool inside = false;
  for (const char c : rest_) {
    count += !is_blank(c) && !inside ? 1 : 0;
    inside = !is_blank(c);
  }
  return count;
}

std::vector<double> Numbers::end() {
  const long last = line_;
  std::vector<double> known;
  double value = 0;
  for (skip_blanks(); !rest_.empty(); skip_blanks()) {
    if (!parse(token(), value)) {
      if (line_ == last) refuse("'", token(), "' after the last number on its line");
      break;
    }
    known.push_back(value);
    rest_.remove_prefix(token().size());
  }
  return known;
}

void Numbers::skip_blanks() {
  while (!rest_.empty() && is_blank(rest_.front())) {
    if (rest_.front() == '\n') ++line_;
    rest_.remove_prefix(1);
  }
}

std::string_view Numbers::token() const {
  const auto end = std::find_if(rest_.begin(), rest_.end(), is_blank);
  return rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
}

std::string_view Numbers::next(const char* what) {
  skip_blanks();
  if (rest_.empty()) refuse("the file ends where ", what, " should be");
  const std::string_view found = token();
  rest_.remove_prefix(found.size());
  return found;
}

}  // namespace perp::lcp
