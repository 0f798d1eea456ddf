// SPDX-License-Identifier: Apache-2.0
#include "app/text/csv.hpp"

#include <fmt/format.h>

#include <charconv>
#include <utility>

#include "app/program/program.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::app {

namespace {

bool is_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error != std::errc::invalid_argument && end == text.data() + text.size();
}

/// After its apostrophes, would the text be a formula?
bool like_formula(std::string_view text) {
  const std::size_t first = text.find_first_not_of('\'');
  return first != std::string_view::npos && std::string_view("=+-@\t\r\n").find(text[first]) != std::string_view::npos;
}

void unprotect(std::string& field) {
  if (field.starts_with('\'') && like_formula(field)) field.erase(0, 1);
}

}  // namespace

std::string csv_field(std::string_view text) {
  std::string field;
  if (like_formula(text) && !is_number(text)) field += '\'';
  field += text;
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

std::vector<std::vector<std::string>> parse_csv(std::string_view text, const std::string& name) {
  std::vector<std::vector<std::string>> records;
  std::vector<std::string> record(1);
  bool quote = false;
  std::size_t line = 1;
  std::size_t begin = 0;  // the line of the quote
  text = lcp::without_utf8_mark(text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && quote && i + 1 < text.size() && text[i + 1] == '"') {
      record.back() += text[++i];
    } else if (c == '"') {
      quote = !quote;
      begin = line;
    } else if (c == ',' && !quote) {
      unprotect(record.back());
      record.emplace_back();
    } else if (c == '\n' && !quote) {
      unprotect(record.back());
      records.push_back(std::exchange(record, {1, std::string{}}));
    } else if (c != '\r' || quote) {
      record.back() += c;
    }
    if (c == '\n') ++line;
  }
  if (quote) throw input_error("{}:{}: a quote without its end", name, begin);
  unprotect(record.back());
  if (record.size() > 1 || !record.front().empty()) records.push_back(std::move(record));
  return records;
}

}  // namespace perp::app
