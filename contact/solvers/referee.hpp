// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What every solver of contact/solvers/solve.hpp shares: the judge, the best point, limits, records. Private to
/// contact/.
#include <chrono>
#include <functional>
#include <string>

#include "contact/classics/trial.hpp"
#include "contact/model/scaling.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {

class Referee : public Trial {
 public:
  /// All outlive *this. No proof is asked for a `part` of a problem.
  Referee(const Problem& problem, const Scaled& scaled, const Options& options, bool part = false);

  /// Judges r~; true if it is the end: solved, or a limit.
  bool judge(In r, Record record);
  /// Whether the run is over.
  bool over() override;
  bool judge_iterate(In r, const TrialStep& step) override;
  /// The larger metric of the point judged last, and of the best one.
  double last() const { return last_; }
  double best() const { return best_metric_; }
  const Vec& best_impulses() const { return result_.solution.r; }
  const Problem& problem() const { return problem_; }
  /// Adds what a solve of a part of the problem took.
  void add(const Stats& of_part);
  const Options& options() const { return options_; }
  double tol() const { return options_.tol; }
  double seconds_left() const;
  const std::atomic<bool>* interrupt() const { return options_.interrupt; }
  /// Asks for a proof that there is no solution; true if that ends the run. For solvers that are about to do long work.
  bool no_solution() override;
  bool solved() const { return result_.solved(); }
  Result result(const std::string& message);

 private:
  Residual take(In r, const Vec& impulses, Origin by);

  const Problem& problem_;
  Judge judge_;
  const Scaled& scaled_;
  const Options& options_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  Result result_;
  Vec best_;
  double best_metric_ = lcp::infinity;
  double last_ = lcp::infinity;
  bool searched_ = false;  // for a certificate, to the end
  bool part_ = false;

  void ask_existence();
};

void run_auto(Referee& referee, const Scaled& problem, const Auto& method, const Vec& start);
void run_ncp(Referee& referee, const Scaled& problem, const GlockerNcp& method, const Vec& start);

}  // namespace perp::contact
