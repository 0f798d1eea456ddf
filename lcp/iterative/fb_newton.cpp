// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/fb_newton.hpp"

#include <cmath>
#include <utility>

#include "lcp/iterative/newton_search.hpp"
#include "lcp/judge/shared_options.hpp"

namespace perp::lcp {
namespace {

/// Tries the point of a cell once the same cell has been pointed to twice.
class LastDigits {
 public:
  LastDigits(const AffineMcp& problem, LuBackend lu) : problem_(problem), cells_(problem, lu, 1e-13) {}
  void offer(const Vec& z, Best& best) {
    const Places places = places_of(problem_, z);
    const std::uint64_t key = key_of(places);
    if (key == last_ && key != tried_) {
      tried_ = key;
      if (cells_.solve(places) == LuStatus::Ok) best.offer(cells_.z());
    }
    last_ = key;
  }
  int factorizations() const { return cells_.factorizations(); }

 private:
  const AffineMcp& problem_;
  CellSolver cells_;
  std::uint64_t last_ = 0;
  std::uint64_t tried_ = 0;
};

}  // namespace

void describe(FbNewton& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  describe_memory(m.memory, f);
  describe_steps(m.armijo, m.shortest, f);
  describe_descent(m.descent_rho, m.descent_p, f);
  describe_lu(m.lu, f);
}

Result fb_newton(const AffineMcp& problem, In start, const FbNewton& options, const Limits& limits) {
  check_input("fb_newton", problem, start, limits);
  refuse_invalid("fb_newton", options);
  NewtonSystem system(problem.M, options.lu, limits.deadline);
  LastDigits last_digits(problem, options.lu);
  const SafeStep safe_step{.armijo = options.armijo, .shortest = options.shortest};
  Best best(problem, start);
  long k = 0;
  const auto end = [&](Status status, std::string message) {
    Result result = judged(problem, best.z(), limits, status, std::move(message));
    result.iterations = k;
    result.factorizations = system.factorizations() + last_digits.factorizations();
    return result;
  };
  const auto merit = [&](const Vec& point) { return fb_equations(problem, point).merit(); };

  Vec z = project(problem.box, start);
  Vec d;
  Equations at = fb_equations(problem, z);
  Memory memory(options.memory);
  memory.push(at.merit());
  Stall stall(60, 0.9, at.merit());
  const auto iterate = [&] {
    for (; !solves(problem, best.z(), limits.tol); ++k) {
      if (const auto stop = limits.reached()) return end(*stop, "stopped between two steps");
      if (k >= options.max_iterations) return end(Status::IterationLimit, "the limit of Newton steps is reached");
      double t = 0;
      if (system.newton(at, d)) {
        const double slope = system.gradient(at).dot(d);
        if (slope <= -options.descent_rho * std::pow(d.norm(), options.descent_p))
          t = backtrack(merit, z, d, memory.reference(), -options.armijo * slope, options.shortest);
        if (t > 0) z += t * d;
      }
      if (t == 0 && !safe_step(problem, system, at, memory.reference(), z))
        return end(Status::Stalled,
                   "a stationary point of ||Phi||^2 (Fischer-Burmeister) that is no solution, or rounding");
      at = fb_equations(problem, z);
      if (!std::isfinite(at.merit())) return end(Status::Stalled, "the iterates overflow");
      memory.push(at.merit());
      best.offer(z);
      last_digits.offer(z, best);
      if (stall.stalled(at.merit()))
        return end(Status::Stalled, "||Phi||^2 (Fischer-Burmeister) has not fallen by a tenth in 60 steps");
    }
    return end(Status::Stalled, "");
  };
  return within_limits(iterate, end);
}

}  // namespace perp::lcp
