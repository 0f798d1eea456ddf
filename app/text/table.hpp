// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Plain-text tables with aligned columns, and numbers for people.
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace perp::app {

enum class Align { Left, Right };

struct Column {
  Column(std::string name, Align side) : header(std::move(name)), align(side) {}
  /// "method" is aligned left, ">seconds" right.
  Column(const char* text)  // NOLINT(google-explicit-constructor): lists of columns are lists of texts
      : Column(*text == '>' ? text + 1 : text, *text == '>' ? Align::Right : Align::Left) {}

  std::string header;
  Align align;
};

class Table {
 public:
  explicit Table(std::vector<Column> columns);
  void add(const std::vector<std::string>& row);  ///< one cell a column
  /// Adds rows 0 to count - 1, but makes only those that print() shows with this limit.
  void fill(std::size_t count, std::size_t limit, const std::function<std::vector<std::string>(std::size_t)>& row);
  std::size_t rows() const { return made() + left_out_; }
  /// Header, rule and rows. Where there are more than `limit` rows (0: no limit), only the first and the last ones are
  /// printed, and a line between them says how many are left out and `how` to see them.
  void print(std::ostream& out, int indent = 0, std::size_t limit = 0, std::string_view how = "") const;

 private:
  std::size_t made() const { return ends_.size() / columns_.size(); }
  std::string_view cell(std::size_t i, std::size_t j) const;

  std::vector<Column> columns_;
  std::vector<std::size_t> width_;
  std::string cells_{};              ///< of the rows that were made, one after the other: there may be millions
  std::vector<std::size_t> ends_{};  ///< of each cell
  std::size_t left_out_ = 0;         ///< rows that were not made
};

/// `digits` significant ones, no trailing zeros; "inf", "-inf", "nan".
std::string number(double value, int digits = 7);
/// "1 iteration", "3 iterations".
std::string count(long long n, std::string_view noun);
/// With its unit: "12 us", "3.4 ms", "5.678 s".
std::string seconds_text(double seconds);
/// "what . . . .", so wide.
std::string dotted(std::string what, std::size_t width);
/// The text, broken at spaces into lines of at most `width` columns.
void print_wrapped(std::ostream& out, std::string_view text, int indent, std::size_t width = 100);
/// The same after `begin`, which the other lines keep free.
void print_wrapped(std::ostream& out, std::string_view text, std::string begin, std::size_t width);

}  // namespace perp::app
