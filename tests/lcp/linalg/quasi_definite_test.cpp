// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/quasi_definite.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>

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

SpMat with_diagonal(const SpMat& M, const Vec& theta) {
  SpMat K = M;
  for (Index i = 0; i < K.rows(); ++i) K.coeffRef(i, i) += theta[i];
  return K;
}

// Vanderbei (1995), theorem 2.1: L D L' exists for every order. Beside a dense LU with full pivoting. Catches a sign
// that is wrong in one of the components, and a refinement that makes the solution worse.
TEST(QuasiDefinite, SolvesSystemsOfInteriorPoints) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-4, 4);
  std::uniform_real_distribution<double> value(-1, 1);
  for (int k = 0; k < 60; ++k) {
    const Index n = 1 + k % 12, m = k % 9;
    const SpMat M = bisymmetric(random, n, m);
    QuasiDefinite ldlt;
    ASSERT_TRUE(ldlt.analyze(M)) << k;
    const Vec theta = Vec::NullaryExpr(n + m, [&](Index) { return std::pow(10, exponent(random)); });
    const SpMat K = with_diagonal(M, theta);
    ASSERT_TRUE(ldlt.factor(K)) << k;
    const Vec b = Vec::NullaryExpr(n + m, [&](Index) { return value(random); });
    Vec x(n + m);
    ASSERT_TRUE(ldlt.solve(K, b, x, 1e-10)) << k;
    EXPECT_LE((K * x - b).lpNorm<Eigen::Infinity>(), 1e-10 * b.lpNorm<Eigen::Infinity>()) << k;
    const Vec exact = Eigen::FullPivLU<Eigen::MatrixXd>(Eigen::MatrixXd(K)).solve(b);
    EXPECT_LE((x - exact).norm(), 1e-6 * (1 + exact.norm())) << k;
  }
}

// A matrix that no signs make symmetric is left to the LU: M_12 = 1, M_21 = 2; a triangle with an odd number of
// minuses; an entry without its mirror image.
TEST(QuasiDefinite, RefusesWhatNoSignsMakeSymmetric) {
  QuasiDefinite ldlt;
  EXPECT_FALSE(ldlt.analyze(support::matrix({{1, 1}, {2, 1}})));
  EXPECT_FALSE(ldlt.analyze(support::matrix({{1, 1, 1}, {-1, 1, 1}, {1, 1, 1}})));
  EXPECT_FALSE(ldlt.analyze(support::matrix({{1, 1}, {0, 1}})));
  EXPECT_TRUE(ldlt.analyze(support::matrix({{1, 1}, {-1, 1}})));
  EXPECT_TRUE(ldlt.analyze(support::matrix({{1, 3}, {3, 1}})));
}

// A zero pivot, and a residual that stays large, are told: the caller goes on by LU.
TEST(QuasiDefinite, SaysWhereItIsNoGood) {
  QuasiDefinite ldlt;
  const SpMat K = support::matrix({{1, 1}, {1, 1}});
  ASSERT_TRUE(ldlt.analyze(K));
  EXPECT_FALSE(ldlt.factor(K));
  const SpMat other = support::matrix({{1, 1}, {1, 2}});  // factors of one matrix for another one
  ASSERT_TRUE(ldlt.factor(other));
  Vec x(2);
  EXPECT_FALSE(ldlt.solve(K, Vec{{1, -1}}, x, 1e-12));
}

// No factorization that would end after the deadline is begun. The lower left of 800 rows is full: 10^8 operations.
TEST(QuasiDefinite, KeepsTheDeadline) {
  KernelClock clock(std::chrono::steady_clock::now());
  const KernelCost one{.flops = 1};
  clock.before(1, one);  // of a machine that takes 2 ms for one operation: fast ones would begin what is short
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  clock.after(one);
  constexpr Index n = 400;
  Eigen::MatrixXd K = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  K.bottomLeftCorner(n, n).setConstant(0.5);
  K.topRightCorner(n, n).setConstant(-0.5);
  const SpMat M = K.sparseView();
  QuasiDefinite ldlt(clock);
  ASSERT_TRUE(ldlt.analyze(M));
  EXPECT_THROW((void)ldlt.factor(M), KernelTooLong);
}

// What fills up is left to the LU, whose blocks are quicker.
TEST(QuasiDefinite, LeavesMuchFillToTheLu) {
  constexpr Index n = 800;
  Eigen::MatrixXd K = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  K.bottomLeftCorner(n, n).setConstant(0.5);
  K.topRightCorner(n, n).setConstant(-0.5);
  EXPECT_FALSE(QuasiDefinite().analyze(K.sparseView()));
}

}  // namespace
}  // namespace perp::lcp
