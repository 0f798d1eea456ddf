// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One cell, made by processes: a run of the method, the judge, and further runs after a failure.
#include <atomic>
#include <optional>
#include <string>

#include "app/campaign/campaign.hpp"
#include "app/campaign/cell.hpp"
#include "app/campaign/process.hpp"
#include "app/worker/worker.hpp"

namespace perp::app::compare {

/// How a run ended, as far as processes tell.
struct RunEnd {
  ProcessEnd process{};
  Answer answer{};
  double natural = std::numeric_limits<double>::quiet_NaN();  ///< by the judge; NaN: no point, or none judged
  bool to_rounding = false;  ///< by the judge: every row's residual is within the rounding of its terms
};

/// The one word. In this order: limits, crashes and garbage; what the method says, held against the judge's residual
/// and against what is known of the problem. A run of more than memory_mb counts as stopped by that limit however it
/// ended; a claim to have solved a problem that has no solution is a false one, small as the residual may be. A proof
/// that there is none counts unless a solution is listed or in hand; settle() has the last word on it.
Outcome outcome_of_run(const RunEnd& end, const AskedProblem& problem, const Campaign& campaign);

/// After these a further run from another start makes sense.
bool is_failure(Outcome outcome);

class CellRunner {
 public:
  /// `program` is what is run for each process; `folder`, which nobody else uses, holds its files.
  CellRunner(const Campaign& campaign, std::string program, std::string folder, const std::atomic<bool>* interrupt);
  ~CellRunner();
  CellRunner(const CellRunner&) = delete;
  CellRunner& operator=(const CellRunner&) = delete;

  /// Nothing if it was interrupted. Throws InputError if no process can be started.
  std::optional<Cell> run(const AskedMethod& method, const AskedProblem& problem, int start);

  /// Size, starts and the like of a problem of which name and file are known. Nothing if interrupted; throws InputError
  /// if it cannot be built.
  std::optional<AskedProblem> describe(const AskedProblem& problem);

 private:
  std::optional<RunEnd> attempt(const AskedMethod& method, const AskedProblem& problem, int start, int run);
  ProcessEnd run_task(Task task, const ProcessLimits& limits);
  std::string log_tail() const;

  const Campaign& campaign_;
  std::string program_, folder_;
  const std::atomic<bool>* interrupt_;
};

}  // namespace perp::app::compare
