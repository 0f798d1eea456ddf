// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/settle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace perp::app::compare {

namespace {

bool denies(const Cell& cell) {
  return cell.outcome == Outcome::Infeasible || cell.outcome_after_restarts == Outcome::Infeasible;
}

bool has_solution(const Cell& cell, double tol) {
  const auto found = [](Outcome outcome) {
    return outcome == Outcome::Solved || outcome == Outcome::SolvedToRounding || outcome == Outcome::Unclaimed;
  };
  return cell.natural <= tol || found(cell.outcome) || found(cell.outcome_after_restarts);
}

void refute(Cell& cell, const std::string& method) {
  for (Outcome* outcome : {&cell.outcome, &cell.outcome_after_restarts})
    if (*outcome == Outcome::Infeasible) *outcome = Outcome::FalseInfeasible;
  cell.message = fmt::format("{} has a solution; it says: {}", method, cell.message);
}

}  // namespace

void settle(Campaign& campaign, std::vector<Cell>& cells) {
  std::map<std::string, std::vector<Cell*>> of;
  for (Cell& cell : cells) of[cell.problem].push_back(&cell);
  for (AskedProblem& problem : campaign.problems) {
    if (!problem.solvable()) continue;
    const std::vector<Cell*>& all = of[problem.name];
    const auto denier = std::ranges::find_if(all, [](const Cell* cell) { return denies(*cell); });
    if (denier == all.end()) continue;
    const auto solver = std::ranges::find_if(all, [&](const Cell* cell) { return has_solution(*cell, campaign.tol); });
    if (solver == all.end()) {
      problem.denied_by = (*denier)->method;
      problem.no_solution = "proven by " + problem.denied_by;
    } else {
      for (Cell* cell : all)
        if (denies(*cell)) refute(*cell, (*solver)->method);
    }
  }
}

}  // namespace perp::app::compare
