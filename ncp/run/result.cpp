// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/result.hpp"

#include <algorithm>
#include <ostream>

namespace perp::ncp {

Stats& Stats::operator+=(const Stats& other) {
  for (int Stats::*count :
       {&Stats::iterations, &Stats::crash_iterations, &Stats::F_evals, &Stats::J_evals, &Stats::factorizations,
        &Stats::krylov_iterations, &Stats::pivots, &Stats::presolved, &Stats::restarts, &Stats::gradient_steps,
        &Stats::watchdogs, &Stats::unchecked_steps, &Stats::chord_steps, &Stats::backtracks, &Stats::ray_starts,
        &Stats::rank_deficient, &Stats::proximal_steps, &Stats::J_F_evals})
    this->*count += other.*count;
  J_colours = std::max(J_colours, other.J_colours);
  linear_time += other.linear_time;
  time += other.time;
  return *this;
}

std::ostream& operator<<(std::ostream& out, const Result& result) {
  return out << to_string(result.status) << ", natural residual " << result.residual.natural << " after "
             << result.stats.iterations << " iterations: " << result.message;
}

}  // namespace perp::ncp
