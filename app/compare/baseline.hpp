// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Comparison with an earlier campaign's cells.csv or outcomes.csv: nothing that was solved may become unsolved.
#include <cstddef>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/campaign/cell.hpp"

namespace perp::app::compare {

struct BaselineRow {
  CellKey key{};
  Outcome outcome = Outcome::Failed;
};

/// By the columns method, problem, start, outcome, which the header names. Throws InputError naming file and line.
std::vector<BaselineRow> read_baseline(const std::string& path);
/// The same from the text of a file; `path` is for the errors.
std::vector<BaselineRow> parse_baseline(std::string_view text, const std::string& path);

struct Regression {
  BaselineRow before{};
  Cell now{};
};

struct BaselineComparison {
  std::vector<Regression> regressions{};  ///< solved, or rightly infeasible, there and not here
  std::vector<CellKey> gained{};          ///< not there, but here
  std::size_t compared = 0;               ///< cells of both
};
BaselineComparison compare_with(const std::vector<BaselineRow>& baseline, std::span<const Cell> cells);

void print_comparison(std::ostream& out, const std::string& path, const BaselineComparison& comparison);

}  // namespace perp::app::compare
