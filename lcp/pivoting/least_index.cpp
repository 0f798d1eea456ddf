// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/least_index.hpp"

#include <unordered_set>

#include "lcp/judge/cell.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// The least violated index, or -1.
Index least_violated(const CellSolver& cell, const Places& places) {
  for (Index i = 0; i < static_cast<Index>(places.size()); ++i)
    if (cell.violated(places, i)) return i;
  return -1;
}

}  // namespace

void describe(LeastIndex& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  describe_degenerate(m.degenerate_tol, f);
  describe_lu(m.lu, f);
}

Result least_index(const AffineMcp& problem, In start, const LeastIndex& options, const Limits& limits) {
  check_input("least_index", problem, start, limits);
  refuse_invalid("least_index", options);
  const auto solve = [&] {
    CellSolver cell(problem, options.lu, options.degenerate_tol, limits.deadline);
    Places places = places_of(problem.box, start);
    Best best(problem, start);
    std::unordered_set<std::uint64_t> seen;
    long steps = 0;
    const auto end = [&](Status status, const std::string& what) {
      Result result = judged(problem, best.z(), limits, status, what);
      result.iterations = steps;
      result.factorizations = cell.factorizations();
      return result;
    };
    const auto failed = [&](LuStatus status, Index r) {
      if (status == LuStatus::OutOfMemory) return end(Status::OutOfMemory, "M_FF does not fit into the memory");
      if (r < 0) return end(Status::Singular, "M_FF is singular at the start, and with all variables inside");
      return end(Status::Singular, text_of("M_FF is singular after the exchange of index ", r + 1));
    };

    LuStatus status = cell.solve(places);
    if (status == LuStatus::Singular) status = cell.solve(places = all_inside(problem.box));
    if (status != LuStatus::Ok) return failed(status, -1);
    for (;; ++steps) {
      best.offer(cell.z());
      const Index r = least_violated(cell, places);
      if (r < 0) return end(Status::Stalled, "no sign is violated, but the residual is above the tolerance");
      if (steps == options.max_iterations) return end(Status::IterationLimit, "signs are still violated");
      if (const auto reached = limits.reached()) return end(*reached, "signs are still violated");
      if (!seen.insert(key_of(places)).second)
        return end(Status::Stalled, "a set of places comes again: M is not a P-matrix, or rounding");
      places[static_cast<std::size_t>(r)] = cell.exchanged(places, r);
      if (status = cell.solve(places); status != LuStatus::Ok) return failed(status, r);
    }
  };
  return within_limits(solve, at_start("least_index", problem, start, limits));
}

}  // namespace perp::lcp
