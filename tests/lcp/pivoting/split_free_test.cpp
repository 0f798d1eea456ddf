// SPDX-License-Identifier: Apache-2.0
/// Lemke's method from a ray where free variables have a rank-deficient block: multipliers of equations.
#include <gtest/gtest.h>

#include "lcp/judge/result.hpp"
#include "lcp/pivoting/lemke_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

/// min c'x, A x = b, 0 <= x <= u, as the MCP of x and the free multipliers y:  M = [0 -A'; A 0], q = (c, -b).
AffineMcp linear_program(const Dense& A, const Vec& b, const Vec& c, double upper = infinity) {
  const Index m = A.rows(), n = A.cols();
  Dense M = Dense::Zero(n + m, n + m);
  M.topRightCorner(n, m) = -A.transpose();
  M.bottomLeftCorner(m, n) = A;
  AffineMcp problem{M.sparseView(), Vec(n + m), Box::free(n + m)};
  problem.q << c, -b;
  problem.box.lower.head(n).setZero();
  problem.box.upper.head(n).setConstant(upper);
  return problem;
}

// min x_1 + 2 x_2, x_1 + x_2 = 1, twice the same equation: x = (1, 0), y_1 + y_2 = 1. M_FF = 0 of rank 0, and the rows
// of A depend on each other. Catches a split that covers one row of a pair only.
TEST(SplitFree, EquationsThatRepeat) {
  const AffineMcp problem = linear_program(Dense::Ones(2, 2), vec({1, 1}), vec({1, 2}));
  const PivotResult result = lemke_ray(problem);
  expect_solved(problem, result);
  EXPECT_EQ(result.repaired, 2);
  EXPECT_NEAR(result.z[0], 1, 1e-12);
  EXPECT_NEAR(result.z[2] + result.z[3], 1, 1e-12);
  EXPECT_EQ(result.cells[2], Cell::Inside);
}

// Cottle, Pang & Stone 1992, theorem 4.4.13: M + M' = 0, so that a linear program that has an optimum, made of a
// feasible x and a feasible dual, is solved, however dependent its rows. With artificials in the place of the
// multipliers some of these ended on rays.
TEST(SplitFree, SolvesEveryLinearProgramThatHasAnOptimum) {
  Random random(11);
  for (int k = 0; k < 400; ++k) {
    const Index m = random.integer(1, 6), n = m + random.integer(0, 8);
    Dense A = (random.normals(m, n) * 2).array().round();
    if (m > 1 && k % 3 == 0) A.row(m - 1) = A.row(0);
    const Vec x = random.normals(n).cwiseMax(0).array().round();
    const Vec slack = random.normals(n).cwiseMax(0).array().round();
    const AffineMcp problem =
        linear_program(A, A * x, A.transpose() * random.normals(m) + slack, k % 4 == 0 ? x.maxCoeff() + 1 : infinity);
    const PivotResult result = lemke_ray(problem);
    SCOPED_TRACE("program " + std::to_string(k));
    expect_solved(problem, result);
  }
}

// The same without a feasible x, or without a feasible dual: the ray is a certificate. Catches one of the split problem
// that is handed on as it is.
TEST(SplitFree, RaysAreCertificates) {
  Random random(12);
  int proven = 0;
  for (int k = 0; k < 200; ++k) {
    const Index m = random.integer(1, 5), n = m + random.integer(0, 6);
    const Dense A = (random.normals(m, n) * 2).array().round().abs();
    Vec b = A * Vec::Ones(n);
    Vec c = random.normals(n).cwiseAbs();
    b[0] = -1 - b[0];  // A >= 0, x >= 0
    const AffineMcp problem = linear_program(A, b, c);
    const PivotResult result = lemke_ray(problem);
    ASSERT_FALSE(result.solved()) << k;
    if (result.certificate.size() == 0) continue;
    ++proven;
    EXPECT_TRUE(proves_infeasible(problem, result.certificate)) << k;
  }
  EXPECT_GT(proven, 150);
}

// A free variable whose only entry is in the row of a bounded one: its unit column and the slack depend on each other,
// and the slack may be the one that is replaced. Catches a split of bounded variables.
TEST(SplitFree, LeavesBoundedVariablesAlone) {
  AffineMcp problem{matrix({{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}), vec({-1, -1, 2}), Box::nonnegative(3)};
  problem.box.lower[2] = -infinity;  // z_3 free: z_1 = 2, z_3 = 1
  const PivotResult result = lemke_ray(problem);
  expect_solved(problem, result);
  EXPECT_NEAR(result.z[0], 2, 1e-12);
  EXPECT_NEAR(result.z[2], 1, 1e-12);
}

}  // namespace
}  // namespace perp::lcp
