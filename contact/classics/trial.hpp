// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a method of this folder is given beside the problem: the judge of its iterates, and its limits. A method never
/// says that a point is solved. Private to contact/.
#include <atomic>

#include "contact/classics/classics.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

/// A step, for the record.
struct TrialStep {
  double step = 0;   ///< its length, of a line search; rho of a projection
  double alpha = 0;  ///< of W + alpha I, where that took the place of W
};

class Trial {
 public:
  virtual ~Trial() = default;
  /// Judges r~; true if the run is over: solved, or a limit.
  virtual bool judge_iterate(In r, const TrialStep& step) = 0;
  /// Whether the run is over.
  virtual bool over() = 0;
  /// Asks for a proof that there is no solution; true if that ends the run.
  virtual bool no_solution() = 0;

  /// After an iteration that may be expensive: always judged.
  bool step(In r, const TrialStep& step);
  /// After an iteration that costs about as much as the judge or less: the first ones and every tenth are judged.
  /// After a thousand a proof that there is no solution is asked for once.
  bool cheap_step(In r, const TrialStep& step);

  Stats stats{};
};

}  // namespace perp::contact
