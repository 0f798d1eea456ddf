// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a report is made of: the methods, problems and cells of a campaign directory, by index.
#include <cstddef>
#include <string>
#include <vector>

#include "app/campaign/campaign.hpp"
#include "app/campaign/cell.hpp"

namespace perp::app::comparison {

using compare::Cell;
using compare::Outcome;

/// A problem from a start: what is counted in all of the report.
struct Pair {
  std::size_t problem = 0;
  int start = 1;
};

class CampaignData {
 public:
  /// Seconds of the cells are rounded as cells.csv prints them, so that whatever is computed from here can be computed
  /// from there. Cells that are not of the campaign's methods, problems and starts are left out.
  CampaignData(compare::Campaign campaign, compare::CellsRead cells);

  const compare::Campaign& campaign() const { return campaign_; }
  const std::vector<compare::AskedMethod>& methods() const { return campaign_.methods; }
  const std::vector<Cell>& cells() const { return read_.cells; }
  const std::vector<Pair>& pairs() const { return pairs_; }  ///< by problem, then start
  /// Lines of cells.jsonl that do not count and cells that are not of the campaign, with the reason.
  const std::vector<std::string>& dropped() const { return read_.dropped; }

  /// nullptr: not finished.
  const Cell* at(std::size_t method, std::size_t pair) const {
    const std::size_t k = at_[method * pairs_.size() + pair];
    return k == none ? nullptr : &read_.cells[k];
  }
  const compare::AskedProblem& problem(std::size_t pair) const { return campaign_.problems[pairs_[pair].problem]; }
  const std::string& label(std::size_t method) const { return campaign_.methods[method].label; }
  /// Distinct ones, sorted, of the problems with or without a solution.
  std::vector<std::string> classes(bool solvable) const;
  std::size_t pairs(bool solvable) const;  ///< how many

 private:
  static constexpr auto none = static_cast<std::size_t>(-1);
  compare::Campaign campaign_;
  compare::CellsRead read_;
  std::vector<Pair> pairs_{};
  std::vector<std::size_t> at_{};  // index into cells()
};

/// Of DIR/campaign.json and DIR/cells.jsonl. Throws InputError naming the file and what is wrong.
CampaignData read_data(const std::string& dir);

/// What one wants of a solvable problem. A solution that its method does not claim is none: its user would not know.
inline bool solved(const Cell& cell) { return cell.outcome == Outcome::Solved; }
inline bool applies(const Cell& cell) { return cell.outcome != Outcome::NotApplicable; }
/// Claims that are wrong: of a solution, or of there being none.
inline bool false_claim(const Cell& cell) {
  return cell.outcome == Outcome::FalseConvergence || cell.outcome == Outcome::FalseInfeasible;
}

/// Value of the option cfunction that it was given, with that of its parameter; "" if it was not given.
std::string given_cfunction(const compare::AskedMethod& method);
/// The same of the options in force, given or not.
std::string cfunction_in_force(const compare::AskedMethod& method);
/// Name and all options that are not of the C-function: what methods that differ in it have in common.
std::string without_cfunction(const compare::AskedMethod& method);

}  // namespace perp::app::comparison
