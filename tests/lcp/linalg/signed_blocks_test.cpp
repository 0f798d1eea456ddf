// SPDX-License-Identifier: Apache-2.0
/// L D L' of blocks against dense matrices.
#include "lcp/linalg/signed_blocks.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "lcp/classes/classify.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;

/// (Q -A'; A R) with n and m rows, in a random order; Q = B B' of this rank, R = 0.
SpMat program(Index n, Index m, Index rank, Random& random) {
  const Dense B = Dense(support::random_sparse(n, 2, random)).leftCols(rank);
  const Dense A = Dense(support::random_sparse(std::max(n, m), 2, random)).topLeftCorner(m, n);
  Dense M = Dense::Zero(n + m, n + m);
  const Dense Q = B * B.transpose();
  M.topLeftCorner(n, n) = 0.5 * (Q + Q.transpose());
  M.topRightCorner(n, m) = -A.transpose();
  M.bottomLeftCorner(m, n) = A;
  std::vector<Index> order(static_cast<std::size_t>(n + m));
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<Index>(i);
    std::swap(order[i], order[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
  }
  Dense permuted(n + m, n + m);
  for (Index i = 0; i < n + m; ++i)
    for (Index j = 0; j < n + m; ++j) permuted(i, j) = M(order[at(i)], order[at(j)]);
  return sparse(permuted);
}

/// max |(M_II + lambda I) x_I - b_I| of all rows in I, and of x outside of it.
double residual(const SpMat& M, const std::vector<bool>& in, double lambda, const Vec& x, const Vec& b) {
  const Vec r = M * x + lambda * x - b;
  double largest = 0;
  for (Index i = 0; i < x.size(); ++i) largest = std::max(largest, std::abs(in[at(i)] ? r[i] : x[i]));
  return largest;
}

// Catches: entries of rows that are out, a sign or a lambda that is lost, the fill of one block that is left for the
// next.
TEST(SignedBlocks, SolveWithBlocksOfAProgram) {
  Random random(1);
  int solved = 0;
  int tried = 0;
  for (int k = 0; k < 40; ++k) {
    const Index n = random.integer(5, 60);
    const SpMat M = program(n, random.integer(0, 30), n, random);
    SignedBlocks blocks;
    ASSERT_TRUE(blocks.analyze(M));
    for (int t = 0; t < 10; ++t) {
      std::vector<bool> in(at(M.rows()));
      for (auto&& i : in) i = random.uniform(0, 1) < 0.7;
      const double lambda = t % 2 == 0 ? 0.3 : 0;
      const Vec b = random.normals(M.rows());
      ++tried;
      Vec x = Vec::Constant(M.rows(), support::nan);
      if (!blocks.factor(in, lambda) || !blocks.solve(b, 1e-9, x)) continue;
      ++solved;
      ASSERT_LE(residual(M, in, lambda, x, b), 1e-8) << k << ' ' << t;
    }
  }
  EXPECT_GE(solved, tried / 2);
}

// Vanderbei, SIAM J. Optim. 5 (1995) 100, theorem 2.1: with lambda > 0 the block is quasi-definite, and has factors in
// any order. Catches: pivots that are refused although they are regular.
TEST(SignedBlocks, WithLambdaAllBlocksHaveFactors) {
  Random random(2);
  for (int k = 0; k < 40; ++k) {
    const Index n = random.integer(5, 60);
    const SpMat M = program(n, random.integer(1, 30), random.integer(1, static_cast<int>(n)), random);
    SignedBlocks blocks;
    ASSERT_TRUE(blocks.analyze(M));
    const std::vector<bool> in(at(M.rows()), true);
    const Vec b = random.normals(M.rows());
    Vec x;
    ASSERT_TRUE(blocks.factor(in, 0.3));
    ASSERT_TRUE(blocks.solve(b, 1e-9, x));
    EXPECT_LE(residual(M, in, 0.3, x, b), 1e-8);
  }
}

// Catches: wrong signs that pass, dense factors of a large matrix, and pivots of nothing but rounding.
TEST(SignedBlocks, RefuseWhatIsNotTheirs) {
  SignedBlocks blocks;
  EXPECT_FALSE(blocks.analyze(matrix({{1, 2}, {3, 1}})));
  EXPECT_FALSE(blocks.analyze(matrix({{1, 1, 1}, {1, 1, -1}, {1, 1, 1}})));  // its signs contradict each other
  EXPECT_FALSE(blocks.analyze(sparse(Dense::Ones(300, 300))));
  ASSERT_TRUE(blocks.analyze(matrix({{1, 1}, {1, 1}})));
  EXPECT_FALSE(blocks.factor({true, true}, 0)) << "singular";
  EXPECT_TRUE(blocks.factor({true, true}, 1));
  EXPECT_TRUE(blocks.factor({true, false}, 0));
  const double third = 1.0 / 3;
  ASSERT_TRUE(blocks.analyze(matrix({{3 * third, third}, {third, third * third}})));
  EXPECT_FALSE(blocks.factor({true, true}, 0)) << "singular but for rounding";
  ASSERT_TRUE(blocks.analyze(matrix({{0, 1}, {-1, 0}})));
  EXPECT_FALSE(blocks.factor({true, true}, 0)) << "regular, but not without pivoting";
}

// A first pivot of 1e-20 spoils the second. Catches: a solution that nobody has looked at.
TEST(SignedBlocks, LookAtWhatTheySolve) {
  for (const double tiny : {1e-20, 1e-12, 1e-8, -1e-20}) {
    const SpMat M = matrix({{tiny, 1, 1}, {1, 1, 2}, {1, 2, 0}});
    SignedBlocks blocks;
    ASSERT_TRUE(blocks.analyze(M));
    const Vec b = support::vec({1, 2, 3});
    Vec x;
    const std::vector<bool> in{true, true, true};
    if (blocks.factor(in, 0) && blocks.solve(b, 1e-8, x)) {
      EXPECT_LE(residual(M, in, 0, x, b), 3.1e-8) << tiny;
    }
  }
}

// The judge is positive_semidefinite. Catches: a "yes" that is wrong; no "yes" for a definite Q.
TEST(SignedBlocks, SayWhatIsSemidefinite) {
  Random random(3);
  int yes = 0;
  int no = 0;
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(2, 30);
    SpMat M = program(n, random.integer(0, 10), k % 3 == 0 ? random.integer(1, static_cast<int>(n)) : n, random);
    if (k % 4 == 0) M.coeffRef(0, 0) -= random.uniform(0, 2);
    M.makeCompressed();
    SignedBlocks blocks;
    ASSERT_TRUE(blocks.analyze(M));
    const bool semidefinite = blocks.semidefinite();
    const bool judged = positive_semidefinite(M).yes();
    EXPECT_LE(semidefinite, judged) << k;
    EXPECT_TRUE(semidefinite || k % 3 == 0 || k % 4 == 0) << k;
    ++(semidefinite ? yes : no);
  }
  EXPECT_GE(yes, 50);
  EXPECT_GE(no, 20);
  SignedBlocks blocks;
  ASSERT_TRUE(blocks.analyze(matrix({{0, -1}, {1, 0}})));
  EXPECT_TRUE(blocks.semidefinite());
  ASSERT_TRUE(blocks.analyze(matrix({{0, 1}, {1, 0}})));
  EXPECT_FALSE(blocks.semidefinite());
}

}  // namespace
}  // namespace perp::lcp
