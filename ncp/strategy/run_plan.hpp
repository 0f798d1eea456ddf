// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The interpreter of methods (ncp/strategy/plan.hpp). Private to ncp/.
#include "ncp/run/run.hpp"
#include "ncp/strategy/plan.hpp"

namespace perp::ncp {

/// Runs the method from x0 until the run ends.
void run_plan(Run& run, In x0, const Method& method);

/// Returns whether the run has ended so that something else may help. EvaluationFailed does after a step: the iterates,
/// which may leave the box, ran against the border of the domain.
bool stuck(const Run& run);
bool stuck(Status status, const Stats& stats);

/// Returns half of the iterations and evaluations left, or all where that is few or nothing follows.
Share part_of_left(const Run& run, bool last);

}  // namespace perp::ncp
