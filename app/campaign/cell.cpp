// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>

#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/text/csv.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::app::compare {

namespace {

constexpr std::array<std::string_view, 12> outcomes{
    "solved",    "solved-to-rounding", "failed",       "false-convergence",
    "unclaimed", "time-limit",         "memory-limit", "crashed",
    "garbage",   "not-applicable",     "infeasible",   "false-infeasible"};

constexpr std::array<std::string_view, 17> columns{"method",         "problem",
                                                   "start",          "outcome",
                                                   "status",         "claimed",
                                                   "natural",        "iterations",
                                                   "F_evals",        "J_evals",
                                                   "factorizations", "krylov_iterations",
                                                   "restarts",       "outcome_after_restarts",
                                                   "seconds",        "peak_mb",
                                                   "message"};
constexpr std::size_t timeless = 14;

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t c = byte;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
    table.at(byte) = c;
  }
  return table;
}

/// The text in a column of cells.csv.
std::string text_in(const Json& cell, std::string_view column) {
  const Json& value = cell.at(std::string(column));
  if (column == "natural" && value == "nan") return "";
  if (!value.is_number_float()) return field_text(value);
  const auto number = value.get<double>();
  if (column == "seconds") return fmt::format("{:.6g}", number);
  return column == "peak_mb" ? fmt::format("{:.1f}", number) : fmt::format("{}", number);
}

std::string csv_of(const Cell& cell, std::span<const std::string_view> names) {
  const Json values = json_of(cell);
  return csv_row(names, [&](std::string_view column) { return text_in(values, column); });
}

}  // namespace

std::span<const std::string_view> outcome_names() { return outcomes; }

std::string_view to_string(Outcome outcome) { return outcomes.at(static_cast<std::size_t>(outcome)); }

Outcome outcome_of(std::string_view name) {
  const auto found = std::ranges::find(outcomes, name);
  if (found == outcomes.end()) throw input_error("'{}' is no outcome", name);
  return static_cast<Outcome>(found - outcomes.begin());
}

bool good(Outcome outcome) { return outcome == Outcome::Solved || outcome == Outcome::Infeasible; }

CellKey key(const Cell& cell) { return {cell.method, cell.problem, cell.start}; }

std::uint32_t crc32(std::string_view text) {
  static constexpr std::array<std::uint32_t, 256> table = crc_table();
  std::uint32_t c = 0xFFFFFFFFU;
  for (const char byte : text) c = table.at((c ^ static_cast<unsigned char>(byte)) & 0xFFU) ^ (c >> 8U);
  return c ^ 0xFFFFFFFFU;
}

std::string file_crc(const std::string& path) { return fmt::format("{:08x}", crc32(read_text(path))); }

std::string checked_line(std::string_view object) {
  return fmt::format("{{\"cell\":{},\"crc\":\"{:08x}\"}}\n", object, crc32(object));
}

std::string_view checked_object(std::string_view line) {
  constexpr std::string_view head = R"({"cell":)";
  constexpr std::string_view middle = R"(,"crc":")";
  constexpr std::string_view tail = R"("})";
  constexpr std::size_t digits = 8;
  constexpr std::size_t around = head.size() + middle.size() + digits + tail.size();
  if (line.size() < around || !line.starts_with(head) || !line.ends_with(tail)) throw InputError("torn");
  const std::string_view text = line.substr(head.size(), line.size() - around);
  const std::string_view rest = line.substr(head.size() + text.size());
  std::uint32_t crc = 0;
  const char* first = rest.data() + middle.size();
  const auto [end, error] = std::from_chars(first, first + digits, crc, 16);
  if (!rest.starts_with(middle) || error != std::errc{} || end != first + digits) throw InputError("torn");
  if (crc != crc32(text)) throw input_error("its CRC is {:08x}, not {:08x}", crc32(text), crc);
  return text;
}

LinesRead read_checked_lines(std::string_view text, const std::function<void(std::string_view)>& take) {
  LinesRead read;
  text = lcp::without_utf8_mark(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    read.torn = end == std::string_view::npos;
    try {
      if (read.torn) throw InputError("torn");
      take(checked_object(text.substr(0, end)));
    } catch (const InputError& error) {
      read.dropped.push_back(fmt::format("line {}: {}", number, error.what()));
    }
    text.remove_prefix(read.torn ? text.size() : end + 1);
  }
  return read;
}

CellsRead parse_cells(std::string_view text) { return cells_of_lines<Cell>(text); }

CellsRead read_cells(const std::string& dir) {
  const std::string path = dir + "/cells.jsonl";
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw input_error("'{}' cannot be read", path);
  return parse_cells(read_text(path));
}

std::span<const std::string_view> csv_columns() { return columns; }
std::span<const std::string_view> outcome_columns() { return std::span(columns).first(timeless); }

std::string cells_csv(std::span<const Cell> cells) {
  std::string text = csv_row(columns);
  for (const Cell& cell : cells) text += csv_of(cell, columns);
  return text;
}

std::string outcomes_csv(std::span<const Cell> cells) {
  std::string text = csv_row(outcome_columns());
  for (Cell cell : cells) {
    if (cell.outcome == Outcome::TimeLimit || cell.outcome == Outcome::MemoryLimit) {
      Cell end{.method = cell.method, .problem = cell.problem, .start = cell.start, .outcome = cell.outcome};
      end.restarts = cell.restarts;
      end.outcome_after_restarts = cell.outcome_after_restarts;
      cell = std::move(end);
    }
    text += csv_of(cell, outcome_columns());
  }
  return text;
}

std::string cells_json(std::span<const Cell> cells) {
  std::string text = "[";
  for (const Cell& cell : cells) text += (text.size() == 1 ? "\n" : ",\n") + line_of(json_of(cell));
  return text + "\n]\n";
}

}  // namespace perp::app::compare
