// SPDX-License-Identifier: Apache-2.0
#include "lcp/cholesky/cholesky.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <thread>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::five_point;
using support::from;
using support::matrix;
using support::Random;
using support::sparse;
using support::tridiagonal;
using support::Triplets;
using support::vec;

void expect_solves(const SpMat& A, const Cholesky& cholesky, Random& random) {
  const Vec solution = random.normals(A.rows());
  const Vec b = A * solution;
  Vec x(A.rows());
  cholesky.solve(b, x);
  EXPECT_LE((A * x - b).lpNorm<Eigen::Infinity>(), 1e-11 * (1 + b.lpNorm<Eigen::Infinity>()));
}

// Catches a wrong triangle, a permutation the wrong way round: small matrices are simplicial, large ones supernodal.
TEST(Cholesky, SolvesSimplicialAndSupernodal) {
  Random random(1);
  for (const SpMat& A : {tridiagonal(7, -1, 2, -1), five_point(60, 4), sparse([&] {
                           const Dense B = random.normals(50, 50);
                           return Dense(B * B.transpose() + Dense::Identity(50, 50));
                         }())}) {
    Cholesky cholesky;
    ASSERT_EQ(cholesky.factor(A), CholeskyStatus::Ok);
    EXPECT_EQ(cholesky.size(), A.rows());
    EXPECT_GE(cholesky.nonzeros(), static_cast<double>((A.nonZeros() + A.rows()) / 2));
    EXPECT_EQ(cholesky.failed_column(), -1);
    expect_solves(A, cholesky, random);
  }
}

// The thorough ordering solves the same systems, on a grid in space on which AMD leaves more to do than dissection, and
// on one too small for it. Catches a factor of the first analysis that is kept.
TEST(Cholesky, ThoroughOrderingsTakeLess) {
  Random random(4);
  const SpMat line = five_point(24, 4);
  const Index n = line.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index layer = 0; layer < 12; ++layer)
    for (Index j = 0; j < n; ++j) {
      for (SpMat::InnerIterator it(line, j); it; ++it)
        entries.emplace_back(static_cast<int>(layer * n + it.row()), static_cast<int>(layer * n + j),
                             it.value() + (it.row() == j ? 2 : 0));
      if (layer == 0) continue;
      entries.emplace_back(static_cast<int>(layer * n + j), static_cast<int>((layer - 1) * n + j), -1.0);
      entries.emplace_back(static_cast<int>((layer - 1) * n + j), static_cast<int>(layer * n + j), -1.0);
    }
  SpMat space(12 * n, 12 * n);
  space.setFromTriplets(entries.begin(), entries.end());
  for (const SpMat& A : {line, space}) {
    Cholesky quick;
    Cholesky thorough(CholeskyOrdering::Thorough);
    ASSERT_EQ(quick.factor(A), CholeskyStatus::Ok);
    ASSERT_EQ(thorough.factor(A), CholeskyStatus::Ok);
    EXPECT_LE(thorough.flops(), quick.flops());
    EXPECT_EQ(thorough.analyses(), 1);
    expect_solves(A, thorough, random);
  }
}

// The lower triangle is the matrix: catches reading the upper one, or both.
TEST(Cholesky, ReadsTheLowerTriangle) {
  Cholesky cholesky;
  ASSERT_EQ(cholesky.factor(matrix({{2, 77}, {-1, 2}})), CholeskyStatus::Ok);
  Vec x(2);
  cholesky.solve(vec({1, 1}), x);
  EXPECT_NEAR(x[0], 1, 1e-15);
  EXPECT_NEAR(x[1], 1, 1e-15);
}

// CHOLMOD's default for small matrices is L D L', which accepts a negative D: catches taking that for definite.
TEST(Cholesky, TellsNegativeCurvature) {
  Random random(2);
  Cholesky cholesky;
  for (const Index n : {2, 5, 40, 200}) {
    for (int repeat = 0; repeat < 5; ++repeat) {
      const Dense B = random.normals(n, n);
      Dense A = B * B.transpose() + Dense::Identity(n, n);
      const Vec v = random.normals(n).normalized();
      A -= 2 * v.dot(A * v) * v * v.transpose();
      ASSERT_EQ(cholesky.factor(sparse(A)), CholeskyStatus::NotPositiveDefinite);
      const Vec& d = cholesky.failed_direction();
      ASSERT_EQ(d.size(), n);
      EXPECT_LT(d.dot(A * d), 0);
      EXPECT_EQ(d[cholesky.failed_column()], 1);
      EXPECT_EQ(cholesky.rcond(), 0);
    }
  }
}

// The same where the factor is supernodal and sparse.
TEST(Cholesky, TellsNegativeCurvatureOfALargeMatrix) {
  SpMat A = five_point(60, 4);
  for (Index k = 0; k < A.rows(); ++k) A.coeffRef(k, k) -= 1;
  Cholesky cholesky;
  ASSERT_EQ(cholesky.factor(A), CholeskyStatus::NotPositiveDefinite);
  const Vec& d = cholesky.failed_direction();
  ASSERT_EQ(d.size(), A.rows());
  EXPECT_LT(d.dot(A * d), 0);
}

TEST(Cholesky, TellsZeroPivots) {
  Cholesky cholesky;
  EXPECT_EQ(cholesky.factor(matrix({{1, 0}, {0, 0}})), CholeskyStatus::NotPositiveDefinite);
  EXPECT_EQ(cholesky.failed_column(), 1);
  EXPECT_EQ(cholesky.failed_direction(), vec({0, 1}));
  EXPECT_EQ(cholesky.factor(SpMat(3, 3)), CholeskyStatus::NotPositiveDefinite);
  EXPECT_EQ(cholesky.factor(matrix({{1, -1}, {-1, 1}})), CholeskyStatus::NotPositiveDefinite);
  EXPECT_NEAR(cholesky.failed_direction()[0], cholesky.failed_direction()[1], 1e-15);
}

TEST(Cholesky, ConditionOfADiagonalMatrix) {
  Cholesky cholesky;
  ASSERT_EQ(cholesky.factor(matrix({{1e-6, 0}, {0, 1e6}})), CholeskyStatus::Ok);
  EXPECT_NEAR(cholesky.rcond() / 1e-12, 1, 1e-10);
}

// An object is used again after any outcome, and an empty matrix is one.
TEST(Cholesky, IsUsedAgain) {
  Random random(3);
  Cholesky cholesky;
  Vec x(1);
  EXPECT_THROW(cholesky.solve(vec({1}), x), std::logic_error);
  EXPECT_EQ(cholesky.factor(matrix({{-1}})), CholeskyStatus::NotPositiveDefinite);
  EXPECT_EQ(cholesky.factor(matrix({{std::nan("")}})), CholeskyStatus::NotFinite);
  EXPECT_EQ(cholesky.factor(matrix({{infinity}})), CholeskyStatus::NotFinite);
  EXPECT_THROW(cholesky.solve(vec({1}), x), std::logic_error);
  EXPECT_EQ(cholesky.factor(matrix({{1e308, 0}, {1e308, 1e-308}})), CholeskyStatus::NotPositiveDefinite);
  ASSERT_EQ(cholesky.factor(SpMat(0, 0)), CholeskyStatus::Ok);
  cholesky.solve(Vec(0), Out(x.head(0)));
  const SpMat A = five_point(5, 4);
  ASSERT_EQ(cholesky.factor(A), CholeskyStatus::Ok);
  expect_solves(A, cholesky, random);
  EXPECT_THROW(cholesky.solve(vec({1}), x), std::invalid_argument);
  Cholesky moved = std::move(cholesky);
  expect_solves(A, moved, random);
  EXPECT_THROW((void)moved.factor(SpMat(2, 3)), std::invalid_argument);
}

// One analysis serves all matrices of a pattern, also after one of them was not positive definite, simplicial and
// supernodal; another pattern has its own. Catches factors computed in the place of an older analysis.
TEST(Cholesky, KeepsTheAnalysisOfAPattern) {
  for (const int m : {5, 60}) {
    const SpMat A = five_point(m, 4);
    const Vec b = Vec::LinSpaced(A.rows(), -1, 2);
    Vec x(b.size());
    Cholesky factor;
    ASSERT_EQ(factor.analyze(A), CholeskyStatus::Ok);
    EXPECT_GT(factor.flops(), static_cast<double>(A.rows()));
    for (const double scale : {1.0, 3.0, 0.5}) {
      ASSERT_EQ(factor.factor(SpMat(scale * A)), CholeskyStatus::Ok);
      factor.solve(b, x);
      EXPECT_LE((scale * (A * x) - b).norm(), 1e-10 * b.norm());
    }
    EXPECT_EQ(factor.analyses(), 1);
    EXPECT_EQ(factor.factor(SpMat(-A)), CholeskyStatus::NotPositiveDefinite);
    ASSERT_EQ(factor.factor(A), CholeskyStatus::Ok);
    factor.solve(b, x);
    EXPECT_LE((A * x - b).norm(), 1e-10 * b.norm());
    SpMat I(A.rows(), A.rows());
    I.setIdentity();
    const int before = factor.analyses();
    ASSERT_EQ(factor.factor(I), CholeskyStatus::Ok);
    EXPECT_EQ(factor.analyses(), before + 1);
    factor.solve(b, x);
    EXPECT_LE((x - b).norm(), 1e-14 * b.norm());
  }
}

// A matrix that is not compressed has gaps in its arrays.
TEST(Cholesky, FactorsUncompressed) {
  SpMat A(3, 3);
  A.reserve(Eigen::VectorXi::Constant(3, 3));
  for (Index k = 0; k < 3; ++k) A.insert(k, k) = 4;
  Cholesky cholesky;
  ASSERT_EQ(cholesky.factor(A), CholeskyStatus::Ok);
  Vec x(3);
  cholesky.solve(vec({4, 8, 12}), x);
  EXPECT_NEAR((x - vec({1, 2, 3})).norm(), 0, 1e-15);
}

// Under ThreadSanitizer: solves with one factor share nothing they write.
TEST(Cholesky, SolvesInTwoThreads) {
  const SpMat A = five_point(30, 4);
  Cholesky cholesky;
  ASSERT_EQ(cholesky.factor(A), CholeskyStatus::Ok);
  const auto work = [&](unsigned seed) {
    Random random(seed);
    for (int k = 0; k < 5; ++k) expect_solves(A, cholesky, random);
  };
  std::thread first(work, 4);
  work(5);
  first.join();
}

}  // namespace
}  // namespace perp::lcp
