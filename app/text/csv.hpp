// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Fields of CSV files (RFC 4180). A text that a spreadsheet would take for a formula, beginning with = + - @, a tab or
/// a carriage return, gets an apostrophe before it (OWASP, "CSV Injection"); numbers stay as they are, and reading
/// takes the apostrophe off again.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace perp::app {

/// The text as a field, quoted if it has to be.
std::string csv_field(std::string_view text);
/// Fields as a line, with its newline; `text` makes one of what is given.
template <class Fields, class Text = std::identity>
std::string csv_row(const Fields& fields, Text text = {}) {
  std::string line;
  for (const auto& field : fields) line += csv_field(text(field)) + ',';
  if (!line.empty()) line.back() = '\n';
  return line;
}

/// Records of fields, header included. Throws InputError, "NAME:3: ...", if a quote has no end; a byte order mark is
/// skipped.
std::vector<std::vector<std::string>> parse_csv(std::string_view text, const std::string& name = "CSV");

}  // namespace perp::app
