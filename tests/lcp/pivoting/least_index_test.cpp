// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/least_index.hpp"

#include <gtest/gtest.h>

#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

// Planted solutions of P-matrices in every kind of box: finite for every start. Catches a wrong index rule (it would
// cycle), a wrong direction at an upper bound.
TEST(LeastIndex, SolvesPMatrices) {
  Random random(1);
  for (int run = 0; run < 200; ++run) {
    const Index n = random.integer(1, 12);
    const SpMat M = run % 2 == 0 ? support::h_plus(n, 3, random) : support::p_matrix(n, 2, random);
    const Box box = run % 3 == 0 ? Box::nonnegative(n) : support::mixed_box(n, random);
    const auto [problem, solution] = plant(M, box, run % 4 < 2 ? 0 : 0.5, random);
    for (const Vec& start : {Vec(Vec::Zero(n)), Vec(10 * random.normals(n)), solution}) {
      const Result result = least_index(problem, start);
      expect_solved(problem, result, "run " + std::to_string(run));
    }
  }
}

// Cottle, Pang & Stone 1992, example 4.1.3: the simple rule "any index" cycles on this P-matrix with q = -e; the
// least-index rule ends.
TEST(LeastIndex, ThePMatrixOnWhichOtherRulesCycle) {
  const AffineMcp problem = standard_lcp(matrix({{1, 2, 0}, {0, 1, 2}, {2, 0, 1}}), vec({-1, -1, -1}));
  const Result result = least_index(problem, Vec::Zero(3));
  expect_solved(problem, result, "circulant");
  EXPECT_LT(norm_inf(result.z - Vec::Constant(3, 1.0 / 3)), 1e-15);
}

// Exponential, as the theory says: from 0 on I + 2 (strict upper triangle) with q = -e the method passes through all
// 2^n sets (Murty 1988, section 6.2: 2^n - 1 steps); with the lower triangle it needs one.
TEST(LeastIndex, ExponentialOnMurty) {
  for (const Index n : {1, 4, 8, 12}) {
    const SpMat U = support::murty(n);
    const AffineMcp upper = standard_lcp(U, Vec::Constant(n, -1));
    const AffineMcp lower = standard_lcp(SpMat(U.transpose()), Vec::Constant(n, -1));
    const Result u = least_index(upper, Vec::Zero(n));
    expect_solved(upper, u, "upper");
    EXPECT_EQ(u.iterations, (1L << n) - 1);
    const Result l = least_index(lower, Vec::Zero(n));
    expect_solved(lower, l, "lower");
    EXPECT_EQ(l.iterations, 1);
  }
}

// No P-matrix: a cycle is noticed, a singular block is told, with its index.
TEST(LeastIndex, HonestOnAnything) {
  const Result cycle = least_index(standard_lcp(matrix({{-1}}), vec({-1})), Vec::Zero(1));
  EXPECT_EQ(cycle.status, Status::Stalled) << cycle.message;
  const Result singular = least_index(standard_lcp(matrix({{1, 0}, {0, 0}}), vec({1, -1})), Vec::Zero(2));
  EXPECT_EQ(singular.status, Status::Singular);
  EXPECT_NE(singular.message.find("index 2"), std::string::npos) << singular.message;
  Random random(4);
  for (int run = 0; run < 300; ++run) {
    const Index n = random.integer(0, 8);
    Dense M = random.normals(n, n);
    if (run % 2 == 1) M = M.unaryExpr([&](double a) { return random.chance(0.6) ? 0 : std::round(a); });
    const AffineMcp problem{support::sparse(M), random.normals(n), support::mixed_box(n, random)};
    expect_honest(problem, least_index(problem, random.normals(n)), "run " + std::to_string(run));
  }
}

TEST(LeastIndex, EdgesAndRefusals) {
  const AffineMcp one = standard_lcp(matrix({{2}}), vec({-1}));
  EXPECT_TRUE(least_index({SpMat(0, 0), Vec(0), Box::nonnegative(0)}, Vec(0)).solved());
  EXPECT_EQ(least_index(one, vec({0}), {.max_iterations = 0}).status, Status::IterationLimit);
  Limits limits;
  limits.deadline = std::chrono::steady_clock::now();
  EXPECT_EQ(least_index(one, vec({0}), {}, limits).status, Status::TimeLimit);
  EXPECT_THROW(least_index(one, vec({0, 0})), std::invalid_argument);
  EXPECT_THROW(least_index(one, vec({0}), {.max_iterations = -1}), std::invalid_argument);
  EXPECT_THROW(least_index(one, vec({0}), {.degenerate_tol = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
