// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/min_newton.hpp"

#include <cmath>
#include <utility>

#include "lcp/iterative/newton_search.hpp"
#include "lcp/judge/shared_options.hpp"

namespace perp::lcp {

void describe(MinNewton& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  describe_memory(m.memory, f);
  describe_steps(m.armijo, m.shortest, f);
  describe_lu(m.lu, f);
}

Result min_newton(const AffineMcp& problem, In start, const MinNewton& options, const Limits& limits) {
  check_input("min_newton", problem, start, limits);
  refuse_invalid("min_newton", options);
  constexpr double rounding = 1e-13;
  CellSolver cells(problem, options.lu, rounding, limits.deadline);
  NewtonSystem system(problem.M, options.lu, limits.deadline);
  const SafeStep safe_step{.armijo = options.armijo, .shortest = options.shortest};
  Best best(problem, start);
  long k = 0;
  const auto end = [&](Status status, std::string message) {
    Result result = judged(problem, best.z(), limits, status, std::move(message));
    result.iterations = k;
    result.factorizations = cells.factorizations() + system.factorizations();
    return result;
  };
  const auto merit = [&](const Vec& point) { return min_equations(problem, point).merit(); };

  Vec z = project(problem.box, start);
  Memory memory(options.memory);
  double psi = merit(z);
  memory.push(psi);
  Stall stall(60, 0.9, psi);
  const auto iterate = [&] {
    for (; !solves(problem, best.z(), limits.tol); ++k) {
      if (const auto stop = limits.reached()) return end(*stop, "stopped between two steps");
      if (k >= options.max_iterations) return end(Status::IterationLimit, "the limit of Newton steps is reached");
      double t = 0;
      const LuStatus status = cells.solve(places_of(problem, z));
      if (status == LuStatus::OutOfMemory) return end(Status::OutOfMemory, "no memory for the factors of M_II");
      if (status == LuStatus::Ok) {
        const Vec d = cells.z() - z;
        best.offer(cells.z());
        t = backtrack(merit, z, d, memory.reference(), options.armijo * 2 * psi, options.shortest);
        if (t > 0) z = t == 1 ? cells.z() : Vec(z + t * d);
      }
      if (t == 0) {
        const Equations at = fb_equations(problem, z);
        if (!safe_step(problem, system, at, at.merit(), z))
          return end(Status::Stalled,
                     "a stationary point of the merit functions of min and Fischer-Burmeister that is "
                     "no solution, or rounding");
        memory.reset(merit(z));
      }
      best.offer(z);
      psi = merit(z);
      memory.push(psi);
      if (!std::isfinite(psi)) return end(Status::Stalled, "the iterates overflow");
      if (stall.stalled(psi)) return end(Status::Stalled, "||H||^2 has not fallen by a tenth in 60 steps");
    }
    return end(Status::Stalled, "");
  };
  return within_limits(iterate, end);
}

}  // namespace perp::lcp
