// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/quasi_definite.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

/// S (Q -A'; A R) S for random Q, R positive semidefinite and sparse A, rows and columns in a random order.
SpMat bisymmetric(std::mt19937& random, Index n, Index m) {
  std::uniform_real_distribution<double> value(-1, 1);
  std::uniform_int_distribution<int> few(0, 4);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + m, n + m);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < m; ++i)
      if (few(random) == 0) M(n + i, j) = value(random), M(j, n + i) = -M(n + i, j);
  for (Index i = 0; i + 1 < n; i += 2) {
    const double a = value(random), b = value(random);
    M(i, i) += a * a, M(i + 1, i + 1) += b * b;
    M(i, i + 1) += a * b, M(i + 1, i) += a * b;
  }
  Eigen::PermutationMatrix<Eigen::Dynamic> P(n + m);
  P.setIdentity();
  std::shuffle(P.indices().data(), P.indices().data() + n + m, random);
  SpMat out = (P * M * P.transpose()).eval().sparseView();
  for (Index i = 0; i < n + m; ++i) out.coeffRef(i, i) += 0;  // the pattern holds the diagonal
  out.makeCompressed();
  return out;
}

// Vanderbei (1995), theorem 2.1: L S L' exists for every order. Beside a dense LU with full pivoting. Catches a sign
// that is wrong in one of the components, in the columns of a supernode, or on the way back.
TEST(QuasiDefinite, SolvesSystemsOfInteriorPoints) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-3, 3);
  std::uniform_real_distribution<double> value(-1, 1);
  for (int k = 0; k < 60; ++k) {
    const Index n = k < 58 ? 1 + k % 12 : 300, m = k < 58 ? k % 9 : 200;  // the last ones are supernodal
    const SpMat M = bisymmetric(random, n, m);
    QuasiDefinite ldlt;
    ASSERT_TRUE(ldlt.analyze(M)) << k;
    for (int again = 0; again < 2; ++again) {
      const Vec theta = Vec::NullaryExpr(n + m, [&](Index) { return std::pow(10, exponent(random)); });
      ASSERT_TRUE(ldlt.factor(theta)) << k;
      const Vec b = Vec::NullaryExpr(n + m, [&](Index) { return value(random); });
      Vec x(n + m);
      ldlt.solve(b, x);
      EXPECT_LE((M * x + theta.cwiseProduct(x) - b).lpNorm<Eigen::Infinity>(), 1e-8 * b.lpNorm<Eigen::Infinity>()) << k;
      const Eigen::MatrixXd K = Eigen::MatrixXd(M) + Eigen::MatrixXd(theta.asDiagonal());
      const Vec exact = Eigen::PartialPivLU<Eigen::MatrixXd>(K).solve(b);
      EXPECT_LE((x - exact).norm(), 1e-7 * (1 + exact.norm())) << k;
    }
  }
}

// A matrix that no row factors make symmetric is left to the LU: a cycle whose factors do not close, an odd number of
// minuses in a triangle, entries without their mirror images one after another. One of these alone is left to the
// refinement.
TEST(QuasiDefinite, RefusesWhatNoRowFactorsMakeSymmetric) {
  QuasiDefinite ldlt;
  EXPECT_FALSE(ldlt.analyze(support::matrix({{1, 1, 1}, {2, 1, 1}, {1, 1, 1}})));
  EXPECT_FALSE(ldlt.analyze(support::matrix({{1, 1, 1}, {-1, 1, 1}, {1, 1, 1}})));
  EXPECT_FALSE(ldlt.analyze(support::matrix({{1, 1, 0}, {0, 1, 1}, {0, 0, 1}})));
  EXPECT_TRUE(ldlt.analyze(support::matrix({{1, 1}, {-1, 1}})));
  EXPECT_TRUE(ldlt.analyze(support::matrix({{1, 3}, {3, 1}})));
  EXPECT_TRUE(ldlt.analyze(support::matrix({{1, 1}, {0, 1}})));
}

// Rows in other units, as where a definition v = sum x is met with a slope: R is found, and the factors of
// another M of the pattern follow it. Beside the equations themselves. Catches a row factor that is left out on the
// way to L or back, and the R of the M before.
TEST(QuasiDefinite, FindsTheUnitsOfRows) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> exponent(-3, 3);
  std::uniform_real_distribution<double> value(-1, 1);
  QuasiDefinite ldlt;
  const SpMat M = bisymmetric(random, 40, 20);
  for (int k = 0; k < 4; ++k) {
    const Vec units = Vec::NullaryExpr(60, [&](Index) { return std::pow(10, exponent(random)); });
    const SpMat N = units.asDiagonal() * M;
    ASSERT_TRUE(ldlt.analyze(N));
    const Vec theta = units * 0.5;
    ASSERT_TRUE(ldlt.factor(theta));
    const Vec b = Vec::NullaryExpr(60, [&](Index) { return value(random); });
    Vec x(60);
    ldlt.solve(b, x);
    EXPECT_LE(((N * x + theta.cwiseProduct(x) - b).cwiseQuotient(units)).norm(),
              1e-7 * (1 + b.cwiseQuotient(units).norm()));
  }
}

// A zero pivot, and one of the wrong sign, are told: the caller goes on by LU. The next matrix is factored again.
TEST(QuasiDefinite, SaysWhereThereIsNoFactor) {
  QuasiDefinite ldlt;
  ASSERT_TRUE(ldlt.analyze(support::matrix({{1, 2}, {2, 1}})));
  EXPECT_FALSE(ldlt.factor(Vec{{0, 0}}));
  EXPECT_FALSE(ldlt.factor(Vec{{1, 1}}));
  ASSERT_TRUE(ldlt.factor(Vec{{2, 2}}));
  Vec x(2);
  ldlt.solve(Vec{{5, 5}}, x);
  EXPECT_LE((x - Vec{{1, 1}}).norm(), 1e-14);
}

}  // namespace
}  // namespace perp::lcp
