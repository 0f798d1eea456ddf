// SPDX-License-Identifier: Apache-2.0
#include "app/compare/baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>
#include <ostream>

#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/text/csv.hpp"
#include "app/text/table.hpp"

namespace perp::app::compare {

std::vector<BaselineRow> read_baseline(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) throw input_error("--baseline: there is no file '{}'", path);
  return parse_baseline(read_text(path), path);
}

std::vector<BaselineRow> parse_baseline(std::string_view text, const std::string& path) {
  const auto records = parse_csv(text, path);
  if (records.empty()) throw input_error("{}: no header", path);
  constexpr std::array<std::string_view, 4> wanted{"method", "problem", "start", "outcome"};
  std::array<std::size_t, wanted.size()> at{};
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto found = std::ranges::find(records.front(), wanted.at(k));
    if (found == records.front().end()) throw input_error("{}: no column '{}'", path, wanted.at(k));
    at.at(k) = static_cast<std::size_t>(found - records.front().begin());
  }
  std::vector<BaselineRow> rows;
  for (std::size_t line = 1; line < records.size(); ++line) {
    const std::vector<std::string>& record = records[line];
    if (record.size() != records.front().size())
      throw input_error("{}: record {} has {} fields, the header {}", path, line + 1, record.size(),
                        records.front().size());
    const std::string& start = record[at[2]];
    BaselineRow row{.key = {.method = record[at[0]], .problem = record[at[1]]}};
    const auto [end, error] = std::from_chars(start.data(), start.data() + start.size(), row.key.start);
    if (error != std::errc{} || end != start.data() + start.size())
      throw input_error("{}: record {}: '{}' is no start", path, line + 1, start);
    try {
      row.outcome = outcome_of(record[at[3]]);
    } catch (const InputError& wrong) {
      throw input_error("{}: record {}: {}", path, line + 1, wrong.what());
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

BaselineComparison compare_with(const std::vector<BaselineRow>& baseline, std::span<const Cell> cells) {
  std::map<CellKey, const Cell*> now;
  for (const Cell& cell : cells) now.emplace(key(cell), &cell);
  BaselineComparison comparison;
  for (const BaselineRow& row : baseline) {
    const auto found = now.find(row.key);
    if (found == now.end()) continue;
    ++comparison.compared;
    const bool before = good(row.outcome);
    const bool denied = row.outcome == Outcome::Solved && found->second->outcome == Outcome::Infeasible;
    if (before && (denied || !good(found->second->outcome))) comparison.regressions.push_back({row, *found->second});
    if (!before && good(found->second->outcome)) comparison.gained.push_back(row.key);
  }
  return comparison;
}

void print_comparison(std::ostream& out, const std::string& path, const BaselineComparison& comparison) {
  out << fmt::format("\nAgainst {}: {} compared, {} solved there and not here, {} here and not there.\n", path,
                     count(static_cast<long long>(comparison.compared), "cell"), comparison.regressions.size(),
                     comparison.gained.size());
  if (comparison.regressions.empty()) return;
  out << '\n';
  Table table({"regression", "problem", ">start", "was", "is", "because"});
  for (const Regression& regression : comparison.regressions) {
    const Cell& cell = regression.now;
    table.add({cell.method, cell.problem, fmt::format("{}", cell.start),
               std::string(to_string(regression.before.outcome)), std::string(to_string(cell.outcome)), cell.message});
  }
  table.print(out, 2);
}

}  // namespace perp::app::compare
