// SPDX-License-Identifier: Apache-2.0
/// LuBackend::Auto of more than 300 rows: Cholesky where the matrix is symmetric positive definite. That Cholesky has
/// factored shows in pivot_ratio(), which is then its rcond().
#include <gtest/gtest.h>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/lu/lu_factors.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Random;
using support::Triplets;

/// Five points on an m x m grid, `shift` on the diagonal, the entries below it times `below`.
SpMat grid(int m, double shift, double below = 1) {
  Triplets entries;
  for (int i = 0; i < m * m; ++i) {
    entries.emplace_back(i, i, 4 + shift);
    for (const int j : {i % m > 0 ? i - 1 : -1, i >= m ? i - m : -1}) {
      if (j < 0) continue;
      entries.emplace_back(j, i, -1);
      entries.emplace_back(i, j, -below);
    }
  }
  return support::from(m * m, entries);
}

/// Tridiagonal (-1, 2, -1) + 0.1: simplicial for CHOLMOD, where the grids are supernodal.
SpMat band(int n) {
  Triplets entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.1);
    if (i > 0) {
      entries.emplace_back(i - 1, i, -1);
      entries.emplace_back(i, i - 1, -1);
    }
  }
  return support::from(n, entries);
}

bool by_cholesky(const SparseLu& lu, const SpMat& A) {
  Cholesky cholesky;
  return cholesky.factor(A) == CholeskyStatus::Ok && lu.pivot_ratio() == cholesky.rcond();
}

double relative_residual(const SpMat& A, const Vec& x, const Vec& b) { return (A * x - b).norm() / b.norm(); }

void expect_solves(const SparseLu& lu, const SpMat& A) {
  const Vec b = Vec::LinSpaced(A.rows(), -1, 2);
  Vec x(A.rows());
  lu.solve(b, x);
  EXPECT_LE(relative_residual(A, x, b), 1e-12);
  lu.solve_transposed(b, x);
  EXPECT_LE(relative_residual(A.transpose(), x, b), 1e-12);
}

// Catches: a definite matrix that is not seen; factors that are shown in another order than they solve in, L for its
// transpose, a diagonal without its square.
TEST(LuDefinite, SolvesByCholeskyAndShowsItsFactors) {
  Random random(1);
  for (const SpMat& A : {grid(20, 0.1), grid(60, 0), band(400)}) {
    SparseLu lu(LuBackend::Auto);
    ASSERT_EQ(lu.factor(A), LuStatus::Ok);
    EXPECT_TRUE(by_cholesky(lu, A));
    expect_solves(lu, A);
    LuFactors factors;
    ASSERT_TRUE(lu.factors(factors));
    LuSolver solver(std::move(factors));
    SparseVector b(A.rows());
    SparseVector x(A.rows());
    for (const Vec& dense : {random.normals(A.rows()), Vec(Vec::Unit(A.rows(), 17))}) {
      b.assign(dense);
      solver.solve(b, x);
      EXPECT_LE(relative_residual(A, x.values(), dense), 1e-12);
      solver.solve_transposed(b, x);
      EXPECT_LE(relative_residual(A, x.values(), dense), 1e-12);
    }
  }
}

// Catches: a lower triangle taken for the matrix.
TEST(LuDefinite, LeavesOthersToTheGeneralLibrary) {
  SpMat indefinite = grid(20, -3);
  SpMat turned = grid(20, 0.1);
  turned.coeffRef(5, 5) = -1;
  for (const SpMat& A : {grid(20, 0.1, 1 + 1e-9), indefinite, turned}) {
    SparseLu lu(LuBackend::Auto);
    ASSERT_EQ(lu.factor(A), LuStatus::Ok);
    EXPECT_FALSE(by_cholesky(lu, A));
    expect_solves(lu, A);
    LuFactors factors;
    EXPECT_TRUE(lu.factors(factors));
  }
}

// Values of one pattern that change from definite to indefinite, unsymmetric and nearly singular, and back. Catches:
// the last values' answer, an analysis that is not there, factors of the wrong library.
TEST(LuDefinite, TakesValuesAsTheyCome) {
  SparseLu lu(LuBackend::Auto);
  for (int round = 0; round < 3; ++round)
    for (const SpMat& A : {grid(20, 0.1), grid(20, -3), grid(20, 0), grid(20, 0.1, 0.5), band(400), grid(20, 1)}) {
      ASSERT_EQ(lu.factor(A), LuStatus::Ok);
      expect_solves(lu, A);
    }
}

// -Laplace with Neumann conditions and little on the diagonal: whether it is regular is for pivoting to say, whose
// answer the methods' thresholds are made for. Catches: rounding that passes for definiteness.
TEST(LuDefinite, LeavesNearlySingularMatricesToTheGeneralLibrary) {
  SpMat A = grid(20, 0);
  for (Index j = 0; j < A.cols(); ++j) A.coeffRef(j, j) = 1e-12 - (A.col(j).sum() - A.coeff(j, j));
  SparseLu lu(LuBackend::Auto);
  SparseLu general(LuBackend::General);
  EXPECT_EQ(lu.factor(A), general.factor(A));
  EXPECT_EQ(lu.pivot_ratio(), general.pivot_ratio());
}

}  // namespace
}  // namespace perp::lcp
