// SPDX-License-Identifier: Apache-2.0
#include "app/text/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <ostream>

namespace perp::app {

namespace {

/// Columns on a terminal: UTF-8 continuation bytes take none.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Number of last rows in a table that is shortened to `limit` rows.
std::size_t tail_of(std::size_t limit) { return limit / 6; }

void append_padded(std::string& line, std::string_view text, std::size_t width, Align align, bool last) {
  const std::size_t space = width - std::min(width, width_of(text));
  if (align == Align::Right) line.append(space, ' ');
  line += text;
  if (align == Align::Left && !last) line.append(space, ' ');
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  for (const Column& column : columns_) width_.push_back(width_of(column.header));
}

void Table::add(const std::vector<std::string>& row) {
  assert(row.size() == columns_.size());
  for (std::size_t j = 0; j < row.size(); ++j) {
    cells_ += row[j];
    ends_.push_back(cells_.size());
    width_[j] = std::max(width_[j], width_of(row[j]));
  }
}

std::string_view Table::cell(std::size_t i, std::size_t j) const {
  const std::size_t k = i * columns_.size() + j, begin = k == 0 ? 0 : ends_[k - 1];
  return std::string_view(cells_).substr(begin, ends_[k] - begin);
}

void Table::fill(std::size_t count, std::size_t limit,
                 const std::function<std::vector<std::string>(std::size_t)>& row) {
  const bool shorten = limit > 0 && count > limit;
  const std::size_t head = shorten ? limit - tail_of(limit) : count;
  for (std::size_t i = 0; i < head; ++i) add(row(i));
  if (!shorten) return;
  left_out_ = count - limit;
  for (std::size_t i = count - tail_of(limit); i < count; ++i) add(row(i));
}

void Table::print(std::ostream& out, int indent, std::size_t limit, std::string_view how) const {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text;  // several lines: a stream call for each takes longer than they do
  const auto flush = [&] {
    out << text;
    text.clear();
  };
  const auto line = [&](auto&& text_of) {
    constexpr std::size_t enough = 1 << 16;
    text += margin;
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      if (j > 0) text += "  ";
      append_padded(text, text_of(j), width_[j], columns_[j].align, j + 1 == columns_.size());
    }
    text += '\n';
    if (text.size() > enough) flush();
  };
  line([&](std::size_t j) -> std::string_view { return columns_[j].header; });
  line([&](std::size_t j) { return std::string(width_[j], '-'); });

  const bool shorten = limit > 0 && rows() > limit;
  const std::size_t tail = shorten ? tail_of(limit) : 0;
  const std::size_t head = shorten ? limit - tail : made();
  for (std::size_t i = 0; i < head; ++i) line([&](std::size_t j) { return cell(i, j); });
  if (shorten) {
    text += margin + fmt::format("... {} rows are not shown{}{}\n", rows() - limit, how.empty() ? "" : "; ", how);
    for (std::size_t i = made() - tail; i < made(); ++i) line([&](std::size_t j) { return cell(i, j); });
  }
  flush();
}

std::string number(double value, int digits) {
  if (std::isnan(value)) return "nan";
  if (value == 0) return "0";  // also for -0
  return fmt::format("{:.{}g}", value, digits);
}

std::string count(long long n, std::string_view noun) { return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s"); }

std::string seconds_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.0f} us", 1e6 * seconds);
  if (seconds < 1) return fmt::format("{:.3g} ms", 1e3 * seconds);
  return fmt::format("{:.4g} s", seconds);
}

std::string dotted(std::string what, std::size_t width) {
  if (what.size() % 2 == 1) what += ' ';
  while (what.size() < width) what += " .";
  return what;
}

void print_wrapped(std::ostream& out, std::string_view text, int indent, std::size_t width) {
  print_wrapped(out, text, std::string(static_cast<std::size_t>(indent), ' '), width);
}

void print_wrapped(std::ostream& out, std::string_view text, std::string begin, std::size_t width) {
  const std::string margin(begin.size(), ' ');
  std::string line = std::move(begin);
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (line.size() > margin.size() && line.size() + 1 + word.size() > width) {
      out << line << '\n';
      line = margin;
    }
    if (line.size() > margin.size()) line += ' ';
    line += word;
  }
  out << line << '\n';
}

}  // namespace perp::app
