// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/multilevel.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lcp/qp/bound_qp_support.hpp"

namespace perp::lcp {
namespace {

Dense dense(const SparseRows& A, Index columns) {
  Dense D = Dense::Zero(A.rows(), columns);
  for (int i = 0; i < A.rows(); ++i)
    for (int s = A.start[static_cast<std::size_t>(i)]; s < A.start[static_cast<std::size_t>(i) + 1]; ++s)
      D(i, A.column[static_cast<std::size_t>(s)]) += A.value[static_cast<std::size_t>(s)];
  return D;
}

SpMat symmetric_m_matrix(Index n, Random& random) {
  const SpMat half = support::m_matrix(n, 2, random);
  SpMat M = half + SpMat(half.transpose());
  for (Index j = 0; j < n; ++j) M.coeffRef(j, j) += std::max(0.0, -M.col(j).sum());
  return M;
}

Mask random_face(Index n, double share, Random& random) {
  Mask free(static_cast<std::size_t>(n));
  for (char& f : free) f = random.chance(share) ? 1 : 0;
  return free;
}

/// The largest factor by which I - B A on the face lengthens the error, in A's norm.
double convergence_factor(const SpMat& M, FacePreconditioner& B, const Mask& free, Random& random) {
  const auto on_face = [&](Vec v) {
    for (Index i = 0; i < v.size(); ++i)
      if (!free[static_cast<std::size_t>(i)]) v[i] = 0;
    return v;
  };
  Vec e = on_face(random.normals(M.rows()));
  Vec x(M.rows());
  double factor = 0;
  for (int k = 0; k < 30; ++k) {
    e /= std::sqrt(e.dot(M * e));
    B.apply(on_face(M * e), x);
    e -= x;
    factor = std::sqrt(e.dot(M * e));
  }
  return factor;
}

// Coarse matrices are P'A P with R = P', and a coarse unknown is the fine one it stands for: its row of P is a unit
// row.
TEST(Multilevel, HierarchyIsGalerkin) {
  Random random(1);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Index n = random.integer(20, 120);
    const Hierarchy hierarchy(rows_of(symmetric_m_matrix(n, random)), 0.25, 5);
    ASSERT_GT(hierarchy.grids.size(), 1U);
    for (std::size_t k = 0; k + 1 < hierarchy.grids.size(); ++k) {
      const Grid& fine = hierarchy.grids[k];
      const Grid& coarse = hierarchy.grids[k + 1];
      const Dense A = dense(fine.A, fine.A.rows());
      const Dense P = dense(fine.P, coarse.A.rows());
      EXPECT_EQ(dense(fine.R, fine.A.rows()), Dense(P.transpose()));
      EXPECT_LE((P.transpose() * A * P - dense(coarse.A, coarse.A.rows())).cwiseAbs().maxCoeff(),
                1e-12 * A.cwiseAbs().maxCoeff());
      for (Index I = 0; I < P.cols(); ++I)
        EXPECT_EQ(Vec(P.row(fine.c_points[static_cast<std::size_t>(I)])), Vec(Vec::Unit(P.cols(), I)));
    }
  }
}

// Constants are interpolated exactly where rows add up to zero: catches wrong weights.
TEST(Multilevel, InterpolatesConstants) {
  const Hierarchy hierarchy(rows_of(laplacian(20, 1, true)), 0.25, 10);
  for (std::size_t k = 0; k + 1 < hierarchy.grids.size(); ++k) {
    const Grid& grid = hierarchy.grids[k];
    Vec one(grid.A.rows());
    grid.P.multiply(Vec::Ones(hierarchy.grids[k + 1].A.rows()), one);
    EXPECT_LE((one - Vec::Ones(one.size())).lpNorm<Eigen::Infinity>(), 1e-12);
  }
}

// Conjugate gradients need B symmetric and positive definite on every face, and zero off it.
TEST(Multilevel, VCycleIsSymmetricPositiveDefinite) {
  Random random(2);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Index n = random.integer(10, 150);
    const Hierarchy hierarchy(rows_of(symmetric_m_matrix(n, random)), 0.25, 5);
    VCycle B(hierarchy, 0, repeat % 2 ? 5 : 0);
    for (const double share : {1.0, 0.7, 0.2, 0.0}) {
      const Mask free = random_face(n, share, random);
      ASSERT_EQ(B.set_free(free), FaceStatus::Ok);
      Dense inverse(n, n);
      Vec x(n);
      for (Index j = 0; j < n; ++j) {
        const bool is_free = free[static_cast<std::size_t>(j)] != 0;
        B.apply(Vec::Unit(n, j) * (is_free ? 1 : 0), x);
        inverse.col(j) = x;
        for (Index i = 0; i < n; ++i)
          if (!free[static_cast<std::size_t>(i)]) {
            ASSERT_EQ(x[i], 0);
          }
        if (!is_free) inverse(j, j) = 1;
      }
      EXPECT_LE((inverse - inverse.transpose()).cwiseAbs().maxCoeff(), 1e-12 * inverse.cwiseAbs().maxCoeff());
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Dense>(inverse).eigenvalues()[0], 0);
    }
  }
}

// The factor does not grow with the grid, on faces neither: catches truncation that leaves the coarse grids wrong. One
// with conjugate gradients from it is twice as good.
TEST(Multilevel, ConvergesAlikeOnAllGrids) {
  Random random(3);
  for (const int N : {16, 32, 64, 128}) {
    const SpMat M = laplacian(N);
    const Hierarchy hierarchy(rows_of(M), 0.25, 50);
    VCycle B(hierarchy, 0, 50);
    Mask free(static_cast<std::size_t>(N) * static_cast<std::size_t>(N), 1);
    ASSERT_EQ(B.set_free(free), FaceStatus::Ok);
    EXPECT_LT(convergence_factor(M, B, free, random), 0.35) << N;
    for (int k = 0; k < N * N; ++k) {  // outside a disc
      const double x = (k % N + 1.0) / (N + 1) - 0.5;
      const double y = (k / N + 1.0) / (N + 1) - 0.4;
      free[static_cast<std::size_t>(k)] = x * x + y * y > 0.04 ? 1 : 0;
    }
    ASSERT_EQ(B.set_free(free), FaceStatus::Ok);
    EXPECT_LT(convergence_factor(M, B, free, random), 0.5) << N;
  }
}

TEST(CholeskyFace, InvertsTheFreeBlock) {
  Random random(4);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Index n = random.integer(1, 60);
    const SpMat M = symmetric_m_matrix(n, random);
    const SparseRows A = rows_of(M);
    CholeskyFace B(A, infinity);
    const Mask free = random_face(n, 0.6, random);
    ASSERT_EQ(B.set_free(free), FaceStatus::Ok);
    Vec x = random.normals(n);
    for (Index i = 0; i < n; ++i)
      if (!free[static_cast<std::size_t>(i)]) x[i] = 0;
    Vec y(n);
    Vec r = M * x;
    for (Index i = 0; i < n; ++i)
      if (!free[static_cast<std::size_t>(i)]) r[i] = 0;
    B.apply(r, y);
    EXPECT_LE((x - y).lpNorm<Eigen::Infinity>(), 1e-10);
  }
}

TEST(CholeskyFace, TellsSingularFromIndefinite) {
  const SparseRows singular = rows_of(support::matrix({{1, -1, 0}, {-1, 1, 0}, {0, 0, 1}}));
  CholeskyFace shifted(singular, infinity);
  EXPECT_EQ(shifted.set_free({1, 1, 1}), FaceStatus::Ok);
  EXPECT_GT(shifted.factorizations, 1);
  const SparseRows indefinite = rows_of(support::matrix({{1, 0, 2}, {0, 5, 0}, {2, 0, 1}}));
  CholeskyFace B(indefinite, infinity);
  EXPECT_EQ(B.set_free({1, 1, 0}), FaceStatus::Ok);
  ASSERT_EQ(B.set_free({1, 1, 1}), FaceStatus::NegativeCurvature);
  EXPECT_TRUE(curvature(indefinite, B.direction).negative());
  CholeskyFace small(singular, 1);
  EXPECT_EQ(small.set_free({1, 1, 1}), FaceStatus::OutOfMemory);
}

}  // namespace
}  // namespace perp::lcp
