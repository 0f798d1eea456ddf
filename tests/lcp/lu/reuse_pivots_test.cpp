// SPDX-License-Identifier: Apache-2.0
/// Sequences of matrices with one pattern, with and without SparseLu::reuse_pivots().
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "lcp/lu/sparse_lu.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Random;

class ReusePivots : public testing::TestWithParam<LuBackend> {};

INSTANTIATE_TEST_SUITE_P(Backends, ReusePivots,
                         testing::Values(LuBackend::General, LuBackend::Klu, LuBackend::Eigen, LuBackend::Dense,
                                         LuBackend::Auto),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

// The entries change by a little, by much, and to zero. By default no digit depends on the matrices before; pivots that
// are taken again must be as accurate, and give way where they no longer do.
TEST_P(ReusePivots, ASequenceIsSolvedAsEachMatrixAlone) {
  Random random(6);
  SparseLu lu(GetParam());
  SparseLu reusing(GetParam());
  reusing.reuse_pivots();
  for (const Index n : {20, 60, 150}) {
    SpMat A = support::random_sparse(n, 4, random);
    for (int k = 0; k < 12; ++k) {
      for (Index e = 0; e < A.nonZeros(); ++e) A.valuePtr()[e] *= k % 3 == 2 ? random.uniform(-2, 2) : 1.01;
      if (k == 6) A.valuePtr()[n] = 0;
      const Vec b = random.normals(n);
      SparseLu alone(GetParam());
      Vec fresh(n);
      Vec x(n);
      Vec again(n);
      ASSERT_EQ(alone.factor(A), LuStatus::Ok);
      ASSERT_EQ(lu.factor(A), LuStatus::Ok);
      ASSERT_EQ(reusing.factor(A), LuStatus::Ok);
      alone.solve(b, fresh);
      lu.solve(b, x);
      reusing.solve(b, again);
      EXPECT_EQ(x, fresh) << n << ' ' << k;
      const SpMat sizes = A.cwiseAbs();
      const Vec terms = sizes * again.cwiseAbs() + b.cwiseAbs();
      EXPECT_LT((A * again - b).lpNorm<Eigen::Infinity>(), 1e-12 * terms.maxCoeff()) << n << ' ' << k;
    }
  }
}

class PivotsAgain : public testing::TestWithParam<LuBackend> {};

INSTANTIATE_TEST_SUITE_P(Backends, PivotsAgain, testing::Values(LuBackend::Klu, LuBackend::Auto),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

/// Five rows of a triangle, whose entries below the diagonal are `below`, and four full ones, all with an entry in
/// column 5; the rest is the identity. With its diagonal as pivots, column 5 grows by 1 - below / diagonal a step.
SpMat growing(double diagonal, double below) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Identity(40, 40);
  D.block(5, 5, 4, 4).setOnes();
  D.block(5, 5, 4, 4).diagonal().setConstant(5);
  D.block(0, 5, 5, 1).setOnes();
  for (Index i = 0; i < 9; ++i)
    for (Index j = 0; j < std::min<Index>(i, 5); ++j) D(i, j) = below;
  D.diagonal().head(5).setConstant(diagonal);
  return support::sparse(D);
}

// Each pivot alone is large enough to be taken again, but U grows to 8e6. Catches pivots that lose as many digits.
TEST_P(PivotsAgain, NotWhereTheyWouldGrow) {
  const SpMat A = growing(1, 0.01);
  const SpMat B = growing(0.031, -1);
  SparseLu reusing(GetParam());
  reusing.reuse_pivots();
  ASSERT_EQ(reusing.factor(A), LuStatus::Ok);
  ASSERT_EQ(reusing.factor(B), LuStatus::Ok);
  Vec x(40);
  reusing.solve(B * Vec::Ones(40), x);
  EXPECT_LT((x - Vec::Ones(40)).lpNorm<Eigen::Infinity>(), 1e-12);
}

// The only entry of a row is its pivot whatever its size: here 1e-310. Catches factors that are called Ok without a
// sign of it, and reused pivots that are no good after them.
TEST(PivotsOfAuto, TellATinyPivot) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Identity(40, 40);
  D.topLeftCorner(4, 4) << 1, 1, 0, 0,  //
      1, 0, 0, 0,                       //
      0, 1, 1, 1,                       //
      0, 0, 1, 2;
  const SpMat regular = support::sparse(D);
  SpMat tiny = regular;
  tiny.coeffRef(0, 1) = 1e-310;
  SparseLu fresh(LuBackend::Auto);
  SparseLu reusing(LuBackend::Auto);
  reusing.reuse_pivots();
  const auto told = [](SparseLu& lu, LuStatus status) {
    return status == LuStatus::Singular || lu.pivot_ratio() < 1e-300;
  };
  EXPECT_TRUE(told(fresh, fresh.factor(tiny)));
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(reusing.factor(regular), LuStatus::Ok);
    EXPECT_TRUE(told(reusing, reusing.factor(tiny)));
  }
  const Vec x = Vec::LinSpaced(40, 1, 2);
  Vec found(40);
  ASSERT_EQ(reusing.factor(regular), LuStatus::Ok);
  reusing.solve(regular * x, found);
  EXPECT_LT((found - x).norm(), 1e-13);
}

}  // namespace
}  // namespace perp::lcp
