// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/markowitz.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "lcp/lu/past_zeros.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;

Dense dense(const Triangle& T) {
  Dense D = Dense::Zero(T.size(), T.size());
  for (Index j = 0; j < T.size(); ++j)
    for (auto k = at(T.start[at(j)]); k < at(T.start[at(j) + 1]); ++k) D(T.row[k], j) = T.value[k];
  return D;
}

/// || L U - (R A)(P, Q) ||, the largest entry.
double difference(const Markowitz& lu, const SpMat& A, const Vec& R) {
  const Index n = A.rows();
  Dense L = dense(lu.L);
  Dense U = dense(lu.U);
  const Dense given = R.asDiagonal() * Dense(A);
  Dense permuted(n, n);
  for (Index i = 0; i < n; ++i) {
    L(i, i) = 1;
    U(i, i) = lu.diagonal[at(i)];
    for (Index j = 0; j < n; ++j) permuted(i, j) = given(lu.P[at(i)], lu.Q[at(j)]);
  }
  return n > 0 ? (L * U - permuted).cwiseAbs().maxCoeff() : 0;
}

bool is_permutation(std::vector<int> p) {
  std::vector<int> numbers(p.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  std::sort(p.begin(), p.end());
  return p == numbers;
}

Vec inverse_scale(const SpMat& A) { return row_scale(A).cwiseInverse(); }

/// The same pattern, other numbers of the same sizes.
SpMat shaken(SpMat A, double by, Random& random) {
  for (Index k = 0; k < A.nonZeros(); ++k) A.valuePtr()[k] *= 1 + by * random.uniform(-1, 1);
  return A;
}

// Against the product of the factors. Catches a wrong order, an entry of fill that is lost, and multipliers that the
// choice of pivots was to keep small, in sparse matrices and in those that end as full ones.
TEST(Markowitz, TheFactorsAreThoseOfTheMatrix) {
  Random random(1);
  Markowitz lu;
  for (const Index n : {0, 1, 2, 7, 12, 30, 80})
    for (int k = 0; k < 12; ++k) {
      const SpMat A = support::random_sparse(n, k, random);
      const Vec R = inverse_scale(A);
      ASSERT_TRUE(lu.factor(A, R)) << n << ' ' << k;
      ASSERT_TRUE(is_permutation(lu.P) && is_permutation(lu.Q));
      ASSERT_LT(difference(lu, A, R), 1e-12) << n << ' ' << k;
      const Triangle by_rows = lu.U.transpose();
      for (std::size_t j = 0; j < at(n); ++j) {
        if (by_rows.start[j] == by_rows.start[j + 1]) continue;  // nothing is eliminated with the row
        for (auto e = at(lu.L.start[j]); e < at(lu.L.start[j + 1]); ++e)
          ASSERT_LE(std::abs(lu.L.value[e]), 10 * (1 + 1e-12));
      }
      const SpMat other = shaken(A, 1e-6, random);
      ASSERT_TRUE(lu.factor_again(other, R)) << n << ' ' << k;
      ASSERT_LT(difference(lu, other, R), 1e-11) << n << ' ' << k;
    }
}

// Triangular but for the order of rows and columns: no other entry comes in, and an arrow has none but its own. Catches
// pivots that are not those with the fewest entries.
TEST(Markowitz, WhatNeedsNoFillHasNone) {
  Random random(2);
  const Index n = 40;
  Dense lower = Dense::Zero(n, n);
  Dense arrow = Dense::Identity(n, n) * 4;
  for (Index i = 0; i < n; ++i) {
    arrow(i, 0) = arrow(0, i) = 1 + random.uniform(0, 1);
    for (Index j = 0; j < i; ++j)
      if (random.uniform(0, 1) < 0.2) lower(i, j) = 100 * random.uniform(1, 2);
    lower(i, i) = 1;
  }
  Eigen::PermutationMatrix<Eigen::Dynamic> rows(n);
  rows.setIdentity();
  for (Index i = n; i-- > 1;) std::swap(rows.indices()[i], rows.indices()[random.integer(0, static_cast<int>(i))]);
  Markowitz lu;
  for (const Dense& D : {Dense(rows * lower), Dense(rows * arrow)}) {
    const SpMat A = support::sparse(D);
    ASSERT_TRUE(lu.factor(A, Vec::Ones(n)));
    EXPECT_EQ(static_cast<Index>(lu.L.row.size() + lu.U.row.size()) + n, A.nonZeros());
  }
}

// The pivots of the matrix before are taken for another one of its pattern, entries that were zero by chance among
// them, but not where they are too small.
TEST(Markowitz, TheSamePivotsAgainUnlessTheyAreTooSmall) {
  SpMat A = matrix({{4, 1, 1}, {1, 4, 1}, {1, 1, 4}});
  const Vec R = Vec::Ones(3);
  A.coeffRef(0, 1) = A.coeffRef(2, 1) = 0;
  Markowitz lu;
  ASSERT_TRUE(lu.factor(A, R));
  const std::vector<int> P = lu.P;
  A.coeffRef(0, 1) = A.coeffRef(2, 1) = 0.5;
  ASSERT_TRUE(lu.factor_again(A, R));
  EXPECT_EQ(lu.P, P);
  EXPECT_LT(difference(lu, A, R), 1e-15);
  for (const double small : {0.0, 1e-3}) {
    SpMat B = A;
    B.coeffRef(P[0], lu.Q[0]) = small;
    ASSERT_TRUE(lu.factor(A, R));
    EXPECT_FALSE(lu.factor_again(B, R)) << small;
    EXPECT_TRUE(lu.factor(B, R));
    EXPECT_LT(difference(lu, B, R), 1e-14);
  }
}

TEST(Markowitz, ASingularMatrixHasNoFactors) {
  Markowitz lu;
  for (const SpMat& A : {matrix({{1, 1, 1}, {1, 0, 0}, {1, 0, 0}}), matrix({{1, 2}, {2, 4}}), matrix({{1, 0}, {1, 0}}),
                         SpMat(matrix({{1, 1}, {1, 2}}) * 0.0), support::sparse(Dense::Ones(9, 9))})
    EXPECT_FALSE(lu.factor(A, Vec::Ones(A.rows())));
  Random random(3);
  const Dense half = random.normals(20, 10);
  Dense twice(20, 20);
  twice << half, half;
  EXPECT_FALSE(lu.factor(support::sparse(twice), Vec::Ones(20)) && std::abs(lu.diagonal.back()) > 1e-13);
}

}  // namespace
}  // namespace perp::lcp
