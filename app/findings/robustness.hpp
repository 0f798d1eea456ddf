// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Failures by method and class of problems, as Billups, Dirkse & Ferris, Comput. Optim. Appl. 7 (1997) 3, print them:
/// those of the runs from the published starts and, in parentheses, those that are left after restarts.
#include "app/findings/campaign_data.hpp"

namespace perp::app::comparison {

/// Of the pairs that a method has finished and is applicable to.
struct Failures {
  std::size_t pairs = 0;
  std::size_t failures = 0;
  std::size_t after = 0;  ///< of these, still unsolved after the restarts
  std::size_t solved() const { return pairs - failures; }
  double share() const { return pairs == 0 ? 0 : static_cast<double>(solved()) / static_cast<double>(pairs); }
};
/// "3 (1)"; "0"; "-" where there is no pair. Without parentheses where there was nothing to restart.
std::string text(const Failures& failures);

struct RobustnessRow {
  std::size_t method = 0;
  std::vector<Failures> by_class{};  ///< in the order of Robustness::classes
  Failures total{};
  std::size_t not_applicable = 0;
  std::size_t unfinished = 0;
};

/// Problems that have a solution. Rows: methods applicable to all pairs first, then by failures (with what is
/// not finished), failures after restarts, label.
struct Robustness {
  std::vector<std::string> classes{};
  std::vector<std::size_t> pairs{};  ///< of each class
  std::vector<RobustnessRow> rows{};
};
Robustness robustness(const CampaignData& data);

/// Problems that have no solution. The best end says so; any other honest end is right too.
struct UnsolvableRow {
  std::size_t method = 0;
  std::size_t infeasible = 0;  ///< says that there is none
  std::size_t honest = 0;      ///< says that it has not solved it, or was ended by a limit
  std::size_t wrong = 0;       ///< claims a solution
  std::size_t broken = 0;      ///< crashed, garbage
  std::size_t not_applicable = 0;
  std::size_t unfinished = 0;
};
/// Rows by wrong, broken, infeasible (most first), label. Empty if the campaign has no such problem.
std::vector<UnsolvableRow> unsolvable(const CampaignData& data);

}  // namespace perp::app::comparison
