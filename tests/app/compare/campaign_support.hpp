// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Made-up campaigns: what was asked, and cells with the outcomes a test wants.
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "app/findings/campaign_data.hpp"
#include "app/support.hpp"

namespace perp::app::test {

using compare::Cell;
using compare::Outcome;

struct MadeUp {
  compare::Campaign campaign{};
  std::vector<Cell> cells{};

  MadeUp() {
    campaign.restarts = 2;
    campaign.version = "0.1.0";
    campaign.date = "2026-11-21T12:00:00Z";
    campaign.machine = {.cpu = "a processor", .cores = 2, .memory_mb = 8000, .system = "Linux 6.1"};
    campaign.command_line = {"perp", "compare"};
  }

  /// "semismooth:cfunction=min" is semismooth with an option.
  MadeUp& method(const std::string& label, const std::string& default_cfunction = "") {
    compare::AskedMethod asked{.label = label, .name = label.substr(0, label.find(':'))};
    for (std::size_t k = label.find(':'); k != std::string::npos; k = label.find(':', k + 1))
      asked.options.push_back(label.substr(k + 1, label.find(':', k + 1) - k - 1));
    if (!default_cfunction.empty()) asked.in_force.emplace_back("cfunction", default_cfunction);
    campaign.methods.push_back(std::move(asked));
    return *this;
  }

  /// Those of class lcp are affine.
  MadeUp& problem(const std::string& name, const std::string& cls, long long n = 1, int starts = 1,
                  const std::string& no_solution = "") {
    compare::AskedProblem asked{.name = name, .file = {}, .cls = cls};
    asked.n = n;
    asked.nonzeros = n;
    asked.affine = cls == "lcp";
    asked.starts = starts;
    asked.no_solution = no_solution;
    campaign.problems.push_back(std::move(asked));
    return *this;
  }

  /// A finished cell; change what else is wanted of it.
  Cell& run(const std::string& method, const std::string& problem, Outcome outcome, double seconds = 0.01,
            int F_evals = 10, int factorizations = 5) {
    Cell cell{.method = method, .problem = problem};
    cell.outcome = cell.outcome_after_restarts = outcome;
    cell.status = std::string(to_string(outcome));
    cell.claimed = outcome == Outcome::Solved || outcome == Outcome::FalseConvergence;
    cell.natural = outcome == Outcome::Solved ? 1e-9 : 0.1;
    cell.seconds = seconds;
    cell.F_evals = F_evals;
    cell.J_evals = cell.iterations = cell.factorizations = factorizations;
    cell.krylov_iterations = 0;
    cell.peak_mb = 12.5;
    cell.curve = {1, 0.1, cell.natural};
    cells.push_back(std::move(cell));
    return cells.back();
  }

  /// The method on `count` problems of a class, p1, p2, ..., of which it solves the first `solved`.
  MadeUp& runs(const std::string& method, const std::string& cls, int count, int solved, int F_evals = 10) {
    for (int k = 1; k <= count; ++k)
      run(method, cls + std::to_string(k), k <= solved ? Outcome::Solved : Outcome::Failed, 0.01, F_evals);
    return *this;
  }
  MadeUp& problems(const std::string& cls, int count) {
    for (int k = 1; k <= count; ++k) problem(cls + std::to_string(k), cls);
    return *this;
  }

  comparison::CampaignData data() const {
    compare::CellsRead read;
    read.cells = cells;
    return {campaign, read};
  }

  void write(const Folder& folder) const {
    test::write(folder / "campaign.json", compare::campaign_json(campaign));
    std::ofstream lines(folder / "cells.jsonl");
    for (const Cell& cell : cells) lines << compare::cell_line(cell);
  }
};

}  // namespace perp::app::test
