// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/coarse_problem.hpp"

#include <gtest/gtest.h>

#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Random;

// The five-point stars on N x N points with random bounds: coarse unknowns are fine ones with their bounds, their rows
// of P are unit rows, and M_C = P'M P by dense products. Catches a permutation or a transposed product.
TEST(CoarseProblem, HasTheUnknownsOfTheFineOne) {
  Random random(1);
  const int N = 12;
  AffineMcp problem = standard_lcp(support::five_point(N, 4), random.normals(N * N));
  for (Index i = 0; i < N * N; ++i) problem.M.coeffRef(i, i) += random.uniform(0, 1);
  problem.box.lower = random.normals(N * N);
  problem.box.upper = problem.box.lower + Vec::Ones(N * N);
  const auto coarse = coarser(problem);
  ASSERT_TRUE(coarse);
  const support::Dense P(coarse->P);
  EXPECT_LT(P.cols(), N * N);
  EXPECT_GE(P.minCoeff(), 0);
  for (Index c = 0; c < P.cols(); ++c) {
    const int fine = coarse->fine_of[static_cast<std::size_t>(c)];
    EXPECT_EQ(P.row(fine), Vec(Vec::Unit(P.cols(), c)).transpose());
    EXPECT_EQ(coarse->problem.box.lower[c], problem.box.lower[fine]);
    EXPECT_EQ(coarse->problem.box.upper[c], problem.box.upper[fine]);
  }
  EXPECT_LT((support::Dense(coarse->problem.M) - P.transpose() * support::Dense(problem.M) * P).cwiseAbs().maxCoeff(),
            1e-13);
  EXPECT_LT((coarse->problem.q - P.transpose() * problem.q).cwiseAbs().maxCoeff(), 1e-13);
}

// Unknowns of C keep their cells, and between neighbours in one cell there is no other.
TEST(CoarseProblem, GivesCells) {
  const int N = 12;
  const auto coarse = coarser(standard_lcp(support::five_point(N, 4), Vec::Zero(N * N)));
  ASSERT_TRUE(coarse);
  const Box box{Vec::Zero(N * N), Vec::Ones(N * N)};
  Random random(2);
  Cells cells(coarse->fine_of.size());
  for (Cell& cell : cells) cell = static_cast<Cell>(random.integer(0, 2));
  const Cells fine = coarse->finer(cells, box);
  for (std::size_t c = 0; c < cells.size(); ++c)
    EXPECT_EQ(fine[static_cast<std::size_t>(coarse->fine_of[c])], cells[c]);
  for (const Cell cell : {Cell::Below, Cell::Above, Cell::Inside})
    EXPECT_EQ(coarse->finer(Cells(cells.size(), cell), box), Cells(static_cast<std::size_t>(N * N), cell));
}

// Free unknowns beside bounded ones at a bound stay inside, fixed ones never go there. Catches z = -infinity.
TEST(CoarseProblem, PutsNothingAtAnInfiniteBound) {
  const int N = 12;
  AffineMcp problem = standard_lcp(support::five_point(N, 4), Vec::Zero(N * N));
  for (int i = 0; i < N * N; i += 3) problem.box.lower[i] = -infinity;
  for (int i = 1; i < N * N; i += 7) problem.box.lower[i] = problem.box.upper[i] = 1;
  const auto coarse = coarser(problem);
  ASSERT_TRUE(coarse);
  for (const Cell cell : {Cell::Below, Cell::Above, Cell::Inside}) {
    const Cells fine = coarse->finer(Cells(coarse->fine_of.size(), cell), problem.box);
    for (Index i = 0; i < N * N; ++i) {
      const Cell at = fine[static_cast<std::size_t>(i)];
      EXPECT_TRUE(problem.box.lower[i] != problem.box.upper[i] || at == Cell::Below) << i;
      EXPECT_FALSE(problem.box.lower[i] == -infinity && at == Cell::Below) << i;
      EXPECT_FALSE(problem.box.upper[i] == infinity && at == Cell::Above) << i;
    }
  }
}

// What has no mesh is refused: entries that are mostly positive, a diagonal, a graph whose coarse problem fills in.
TEST(CoarseProblem, RefusesWhatIsNoMesh) {
  Random random(3);
  const auto refused = [](const SpMat& M) { return !coarser(standard_lcp(M, Vec::Zero(M.rows()))); };
  EXPECT_TRUE(refused(SpMat(-support::five_point(8, -4))));
  SpMat identity(50, 50);
  identity.setIdentity();
  EXPECT_TRUE(refused(identity));
  EXPECT_TRUE(refused(support::m_matrix(400, 8, random)));
}

}  // namespace
}  // namespace perp::lcp
