// SPDX-License-Identifier: Apache-2.0
#include "app/findings/robustness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace perp::app::comparison {

std::string text(const Failures& failures) {
  if (failures.pairs == 0) return "-";
  if (failures.failures == 0) return "0";
  return fmt::format("{} ({})", failures.failures, failures.after);
}

Robustness robustness(const CampaignData& data) {
  Robustness table{.classes = data.classes(true)};
  table.pairs.assign(table.classes.size(), 0);
  const auto cls = [&](std::size_t pair) {
    return static_cast<std::size_t>(std::ranges::lower_bound(table.classes, data.problem(pair).cls) -
                                    table.classes.begin());
  };
  for (std::size_t p = 0; p < data.pairs().size(); ++p)
    if (data.problem(p).solvable()) ++table.pairs[cls(p)];

  for (std::size_t m = 0; m < data.methods().size(); ++m) {
    RobustnessRow row{.method = m, .by_class = std::vector<Failures>(table.classes.size())};
    for (std::size_t p = 0; p < data.pairs().size(); ++p) {
      if (!data.problem(p).solvable()) continue;
      const Cell* cell = data.at(m, p);
      row.unfinished += cell == nullptr ? 1 : 0;
      if (cell == nullptr) continue;
      row.not_applicable += applies(*cell) ? 0 : 1;
      if (!applies(*cell)) continue;
      for (Failures* count : {&row.by_class[cls(p)], &row.total}) {
        ++count->pairs;
        count->failures += solved(*cell) ? 0 : 1;
        count->after += !solved(*cell) && cell->outcome_after_restarts != Outcome::Solved ? 1 : 0;
      }
    }
    table.rows.push_back(std::move(row));
  }
  std::ranges::sort(table.rows, {}, [&](const RobustnessRow& row) {
    return std::tuple(row.not_applicable > 0, row.total.failures + row.unfinished, row.total.after,
                      data.label(row.method));
  });
  return table;
}

std::vector<UnsolvableRow> unsolvable(const CampaignData& data) {
  if (data.classes(false).empty()) return {};
  std::vector<UnsolvableRow> rows;
  for (std::size_t m = 0; m < data.methods().size(); ++m) {
    UnsolvableRow row{.method = m};
    for (std::size_t p = 0; p < data.pairs().size(); ++p) {
      if (data.problem(p).solvable()) continue;
      const Cell* cell = data.at(m, p);
      if (cell == nullptr)
        ++row.unfinished;
      else if (!applies(*cell))
        ++row.not_applicable;
      else if (cell->outcome == Outcome::Infeasible)
        ++row.infeasible;
      else if (cell->outcome == Outcome::Crashed || cell->outcome == Outcome::Garbage)
        ++row.broken;
      else if (cell->outcome == Outcome::Failed || cell->outcome == Outcome::TimeLimit ||
               cell->outcome == Outcome::MemoryLimit)
        ++row.honest;
      else
        ++row.wrong;
    }
    rows.push_back(row);
  }
  std::ranges::sort(rows, {}, [&](const UnsolvableRow& row) {
    return std::tuple(row.wrong, row.broken, -static_cast<long>(row.infeasible), data.label(row.method));
  });
  return rows;
}

}  // namespace perp::app::comparison
