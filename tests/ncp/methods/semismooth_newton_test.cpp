// SPDX-License-Identifier: Apache-2.0
/// De Luca, Facchinei & Kanzow 1996: the method by its behaviour on problems with known solutions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::expect_solution;
using support::expect_solved;
using support::Random;
using support::vec;

// min's own merit is not differentiable: full Newton steps are taken where they halve ||Phi|| (De Luca, Facchinei &
// Kanzow 2000), others are searched on the Fischer-Burmeister merit. atan(x) = 0: from 0.5 Newton's steps shrink |F| at
// least fivefold each, one evaluation a step; from 1.3 the first goes to -1.16, which is no half, but descends;
// from 1.5 Newton's method diverges. Catches: full steps that do not halve taken for good, or none taken without a
// search.
TEST(SemismoothNewton, MinTakesFullStepsThatHalvePhi) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::atan(x); }, [](double x) { return 1 / (1 + x * x); }));
  const auto first_step = [&mcp](double x0, Result& result) {
    Iteration first;
    result = solve(*mcp, vec({x0}), SemismoothNewton{.cfunction = natural_min()}, [&first](const Iteration& it) {
      if (it.k == 1) first = it;
      return Next::Continue;
    });
    EXPECT_TRUE(result.solved()) << result;
    return first;
  };
  Result result;
  const Iteration halving = first_step(0.5, result);
  EXPECT_EQ(halving.F_evals, 2);
  EXPECT_NEAR(halving.merit, 0.5 * std::pow(std::atan(0.5 - std::atan(0.5) * 1.25), 2), 1e-15);
  EXPECT_EQ(result.stats.F_evals, 1 + result.stats.iterations + 1);  // the last one is the judge's
  const Iteration descending = first_step(1.3, result);
  EXPECT_EQ(descending.step, 1);
  EXPECT_EQ(descending.F_evals, 3);  // tried, and then searched
  EXPECT_LT(first_step(1.5, result).step, 1);
}

// 10^4 unknowns; one dense matrix of them would take 800 MB.
TEST(SemismoothNewton, ObstacleProblemStaysSparse) {
  const double before = support::peak_megabytes();
  const auto mcp = make_mcp(support::obstacle(100));
  const Result result = expect_solved(*mcp, Vec::Zero(10000), SemismoothNewton{});
  EXPECT_LT(result.stats.iterations, 30);
  EXPECT_LT(support::peak_megabytes() - before, 250);
}

// H is singular all along: two equal rows, then a row of zeros. Levenberg-Marquardt steps go on where Newton's cannot.
TEST(SemismoothNewton, TakesLevenbergMarquardtStepsWhereHIsSingular) {
  const SpMat M = support::matrix({{1, 1}, {1, 1}});
  const auto mcp = make_mcp(support::affine({.M = M, .q = vec({-2, -2}), .box = Box::free(2)}));
  for (const auto& [label, method] : support::semismooth_variants()) {
    std::vector<Iteration> records;
    const Result result = expect_solved(*mcp, vec({10, -30}), method, label, record(records));
    EXPECT_NEAR(result.x.sum(), 2, 1e-8) << label;
    ASSERT_GE(records.size(), 2U);
    EXPECT_EQ(records[1].kind, 'L') << label;
    EXPECT_GT(records[1].prox, 0) << label;
  }
}

}  // namespace
}  // namespace perp::ncp
