// SPDX-License-Identifier: Apache-2.0
// The door for small dense problems.
#include "lcp/solve/dense.hpp"

#include <gtest/gtest.h>

#include "support/campaign.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;
using support::vec;

const Result& solve(DenseSolver& solver, const AffineMcp& p) {
  return solver.solve(Dense(p.M), p.q, p.box.lower, p.box.upper);
}

// Small problems of eight classes, with any bounds, one after the other with one solver: a P-matrix is solved, whatever
// was kept of the problem before, and nothing is called solved that is not, by a judge of its own. Infeasible ones must
// prove themselves. Catches places, factors or certificates left over from another problem.
TEST(DenseSolver, KeepsNothingThatIsWrong) {
  Random random(7);
  DenseSolver solver;
  int solved = 0;
  for (int k = 0; k < 2000; ++k) {
    const AffineMcp p = support::campaign_problem(k, random);
    const Result& result = solve(solver, p);
    SCOPED_TRACE("problem " + std::to_string(k) + ": " + result.message);
    ASSERT_TRUE((result.z.array() >= p.box.lower.array()).all() && (result.z.array() <= p.box.upper.array()).all());
    ASSERT_TRUE(result.solved() || k % 8 != 1);
    if (result.solved()) {
      ++solved;
      const double rounding = 1e-18 * (p.M.cwiseAbs() * result.z.cwiseAbs() + p.q.cwiseAbs()).maxCoeff();
      ASSERT_LE(support::violation(p, result.z), 1.01e-9 + rounding);
      ASSERT_EQ(result.residual, judge(p, result.z).natural) << "the judges of dense and sparse problems differ";
    }
    ASSERT_TRUE(result.certificate.size() == 0 || proves_infeasible(p, result.certificate));
  }
  EXPECT_GT(solved, 1000);
}

// The solution of a neighbour takes one round, a matrix by rows is the one by columns, and Murty's matrix, on which
// rules for single exchanges take 2^n pivots, is solved. Catches a cell that is not kept, and strides taken wrongly.
TEST(DenseSolver, BeginsInTheLastCell) {
  Random random(8);
  const Index n = 30;
  const Dense A = random.normals(n, n), S = random.normals(n, n);
  const Dense M = A * A.transpose() + Dense::Identity(n, n) + S - S.transpose();
  const Vec q = random.normals(n), lower = Vec::Zero(n), upper = Vec::Ones(n);
  DenseSolver solver;
  ASSERT_TRUE(solver.solve(M, q, lower, upper).solved());
  const Vec z = solver.solve(M, q, lower, upper).z;
  EXPECT_EQ(solver.solve(M, q, lower, upper).iterations, 1);
  EXPECT_EQ(solver.solve(M, q, lower, upper).factorizations, 0);
  solver.forget();
  EXPECT_GT(solver.solve(M, q, lower, upper).iterations, 1);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = M;
  const Eigen::Map<const Dense, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>> by_rows(
      rows.data(), n, n, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>(1, n));
  EXPECT_EQ(solver.solve(by_rows, q, lower, upper).z, z);

  Dense murty = Dense::Identity(n, n);
  murty.triangularView<Eigen::StrictlyUpper>().setConstant(2);
  EXPECT_EQ(DenseSolver().solve(murty, -Vec::Ones(n), lower, Vec::Constant(n, infinity)).z, Vec::Unit(n, n - 1));
}

// A problem that is refused leaves nothing behind: neither its M, nor the factors of the one before for its M. Catches
// a matrix that is taken for checked, or for factored, because it was seen before.
TEST(DenseSolver, KeepsNothingOfARefusedProblem) {
  const Vec q = vec({-1, -2}), zero = vec({0, 0}), one = vec({9, 9});
  const Dense M = Dense::Identity(2, 2), other = 2 * M;
  Dense infinite = M;
  infinite(0, 1) = infinity;
  DenseSolver solver;
  EXPECT_EQ(solver.solve(M, q, zero, one).z, vec({1, 2}));
  EXPECT_THROW(solver.solve(other, vec({infinity, 1}), zero, one), std::invalid_argument);
  const Result& result = solver.solve(other, q, zero, one);
  EXPECT_EQ(result.z, vec({0.5, 1}));
  EXPECT_EQ(result.iterations, 1);
  for (int k = 0; k < 2; ++k) EXPECT_THROW(solver.solve(infinite, q, zero, one), std::invalid_argument);
}

TEST(DenseSolver, RefusesWhatIsNoProblem) {
  DenseSolver solver;
  const Dense M = Dense::Identity(2, 2);
  const Vec q = vec({1, 2}), zero = vec({0, 0}), one = vec({1, 1});
  EXPECT_THROW(solver.solve(M.topRows(1), q, zero, one), std::invalid_argument);
  EXPECT_THROW(solver.solve(M, vec({1, infinity}), zero, one), std::invalid_argument);
  EXPECT_THROW(solver.solve(M, q, one, zero), std::invalid_argument);
  EXPECT_THROW(solver.solve(M, q, vec({0}), one), std::invalid_argument);
  EXPECT_THROW(solver.solve(M, q, zero, one, {.tol = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
