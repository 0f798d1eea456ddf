// SPDX-License-Identifier: Apache-2.0
/// Attempts of PathSearch that are left and gone on with.
#include "ncp/path/path_attempt.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "ncp/collection/collection.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

constexpr Index few_variables = 60;

Stop short_run() {
  Stop stop;
  stop.max_iterations = 60;
  stop.max_time = Seconds::max();
  return stop;
}

/// An attempt that is left, and gone on with, for every patience from `from` to that of the method.
Result outcome(const Mcp& mcp, const Vec& start, const PathSearch& method, int from, int& left) {
  const Stop stop = short_run();
  const Observer nobody;
  Run run(mcp, stop, nobody);
  Point point;
  if (!run.start(start, point)) return run.result(start);
  PathAttempt attempt(run, method, std::move(point));
  attempt.go_on(from);
  for (int patience = from + 1; attempt.stalled() && patience <= method.patience; ++patience) {
    ++left;
    run.resume("on");
    attempt.go_on(patience);
  }
  return run.result(start);
}

// An attempt that is left again and again takes the steps of one that is not, to the last digit. Catches what is
// forgotten or counted twice in between: cells, references of the merit, proximal terms, patience.
TEST(PathAttempt, IsTheSameWhetherItIsLeftOrNot) {
  const PathSearch method{.patience = 8};
  int left = 0;
  for (const auto& entry : collection::entries()) {
    const collection::Problem problem = entry.make();
    if (problem.mcp->size() > few_variables) continue;
    for (const Vec& start : problem.starts) {
      const std::string what =
          std::string(entry.name) + ", start " + std::to_string(&start - problem.starts.data() + 1);
      const Result whole = outcome(*problem.mcp, start, method, method.patience, left);
      const Result parts = outcome(*problem.mcp, start, method, 1, left);
      EXPECT_EQ(parts.status, whole.status) << what;
      EXPECT_EQ(parts.x, whole.x) << what;
      EXPECT_EQ(parts.stats.iterations, whole.stats.iterations) << what;
      EXPECT_EQ(parts.stats.pivots, whole.stats.pivots) << what;
      EXPECT_EQ(parts.basis, whole.basis) << what;
    }
  }
  EXPECT_GT(left, 20);
}

}  // namespace
}  // namespace perp::ncp
