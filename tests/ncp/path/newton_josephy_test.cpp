// SPDX-License-Identifier: Apache-2.0
/// Josephy 1979; Robinson 1992: the method by its behaviour on problems with known solutions.
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

// The linearisation of an affine problem is the problem. Catches a q that is not F - J x, or a step that is damped.
TEST(NewtonJosephy, SolvesAffineProblemsInOneStep) {
  Random random(2);
  for (int k = 0; k < 30; ++k) {
    const Index n = 2 + k;
    const auto mcp =
        make_mcp(support::affine({.M = k % 2 == 0 ? support::p_matrix(n, 2, random) : support::h_plus(n, 3, random),
                                  .q = 5 * random.normals(n),
                                  .box = support::mixed_box(n, random)}));
    for (const auto& [label, method] : support::josephy_variants()) {
      const Result result = expect_solved(*mcp, random.normals(n), method, label);
      EXPECT_LE(result.stats.iterations, 1) << label << ", n = " << n;
    }
  }
}

// 10^4 unknowns from the solution of the double load; one dense matrix of them would take 800 MB.
TEST(NewtonJosephy, ObstacleProblemStaysSparse) {
  const double before = support::peak_megabytes();
  const Result near = solve(*make_mcp(support::obstacle(100, 2)), Vec::Zero(10000), SemismoothNewton{});
  const Result result = expect_solved(*make_mcp(support::obstacle(100)), near.x, NewtonJosephy{});
  EXPECT_EQ(result.stats.iterations, 1);
  EXPECT_GT(result.stats.pivots, 1);
  EXPECT_LT(support::peak_megabytes() - before, 250);
}

// Equal solutions by other ways: the two methods share nothing but F and the line search.
TEST(NewtonJosephy, AgreesWithSemismoothNewtonOnTheObstacleProblem) {
  const auto mcp = make_mcp(support::obstacle(20));
  const Result a = expect_solved(*mcp, Vec::Zero(400), NewtonJosephy{.stop = {.tol = 1e-12}});
  const Result b = expect_solved(*mcp, Vec::Zero(400), SemismoothNewton{.stop = {.tol = 1e-12}});
  EXPECT_LE((a.x - b.x).lpNorm<Eigen::Infinity>(), 1e-9);
}

}  // namespace
}  // namespace perp::ncp
