// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/straight_path.hpp"

#include <gtest/gtest.h>

#include "lcp/pivoting/lemke_support.hpp"

namespace perp::lcp {
namespace {

using support::matrix;
using support::Random;
using support::vec;

AffineMcp p_or_h_plus(int k, Index n, Random& random) {
  SpMat M = k % 2 ? support::p_matrix(n, 3, random) : support::h_plus(n, 3, random);
  return {std::move(M), random.normals(n), support::mixed_box(n, random)};
}

/// The paths from `start` agree: without pivots where one is found, and not missed where lemke() needs none.
void expect_the_same(const AffineMcp& problem, const Vec& start, LemkeOptions options, int& straight) {
  options.keep_basis = options.keep_path = true;
  SharedLu lu{SparseLu(LuBackend::Auto)};
  const PivotResult path = lemke(problem, start, options);
  const std::optional<PivotResult> found = straight_path(problem, start, options, lu);
  if (!found) return;
  ++straight;
  expect_solved(problem, *found);
  EXPECT_EQ(found->pivots, 0);
  EXPECT_EQ(found->path.size(), 2U);
  ASSERT_TRUE(path.solved());
  const double size = 1 + path.x.lpNorm<Eigen::Infinity>();
  EXPECT_LT((found->x - path.x).lpNorm<Eigen::Infinity>(), 1e-7 * size);
  ASSERT_TRUE(found->last_piece);
  if (path.pivots > 0 || !path.last_piece) return;
  EXPECT_EQ(found->cells, path.cells);
  const Vec r = Vec::LinSpaced(problem.size(), -1, 2);
  const Vec dx = chord_step(path, r);
  EXPECT_LT((chord_step(*found, r) - dx).lpNorm<Eigen::Infinity>(), 1e-7 * (1 + dx.lpNorm<Eigen::Infinity>()));
}

// By definition both are the zero of the piece of the start's cell. It would catch a wrong sign outside the bounds, a
// cell taken from the wrong place, or factors of another matrix. Sizes of the dense, the sparse and the general LU.
TEST(StraightPath, IsThatOfLemkeWhereThatHasNoPivots) {
  Random random(7);
  int straight = 0;
  for (int k = 0; k < 120; ++k) {
    const Index n = k % 10 == 0 ? 350 : k % 3 ? 12 : 60;
    const AffineMcp problem = p_or_h_plus(k, n, random);
    const PivotResult solution = lemke(problem, Vec::Zero(n));
    ASSERT_TRUE(solution.solved());
    const Vec near = solution.x + 1e-3 * random.normals(n);
    expect_the_same(problem, near, {}, straight);
    LemkeOptions warm;
    warm.cells = solution.cells;
    expect_the_same(problem, solution.x + random.normals(n), warm, straight);
    expect_the_same(problem, random.normals(n), {}, straight);
  }
  EXPECT_GT(straight, 150);
}

// Cottle, Pang & Stone 1992, chapter 1: from (1, 1) the path of q = (5, -6) has to leave the cell of x > 0; the cell of
// M = [1 1; 1 1] is singular.
TEST(StraightPath, FindsNothingWherePivotsOrArtificialsAreNeeded) {
  SharedLu lu{SparseLu(LuBackend::Auto)};
  EXPECT_FALSE(straight_path(standard_lcp(matrix({{2, 1}, {1, 2}}), vec({5, -6})), vec({1, 1}), {}, lu));
  EXPECT_TRUE(straight_path(standard_lcp(matrix({{2, 1}, {1, 2}}), vec({5, -6})), vec({-1, 1}), {}, lu));
  EXPECT_FALSE(straight_path(standard_lcp(matrix({{1, 1}, {1, 1}}), vec({-1, -1})), vec({1, 1}), {}, lu));
}

// The zero of the piece of x > 0 of the first is (16, -17) / 3, of the second (-1, -1); a regular path stays.
TEST(StraightPath, TellsHowManyVariablesLeaveTheCell) {
  SharedLu lu{SparseLu(LuBackend::Auto)};
  const SpMat M = matrix({{2, 1}, {1, 2}});
  Index leaving = -1;
  EXPECT_FALSE(straight_path(standard_lcp(M, vec({-5, 6})), vec({1, 1}), {}, lu, &leaving));
  EXPECT_EQ(leaving, 1);
  EXPECT_FALSE(straight_path(standard_lcp(M, vec({3, 3})), vec({1, 1}), {}, lu, &leaving));
  EXPECT_EQ(leaving, 2);
  EXPECT_TRUE(straight_path(standard_lcp(M, vec({-5, -6})), vec({1, 1}), {}, lu, &leaving));
  EXPECT_EQ(leaving, 0);
}

// A chord step is one of the piece it was asked of, also when the factorization has served another since.
TEST(StraightPath, ChordStepsAfterTheFactorizationServedAnother) {
  SharedLu lu{SparseLu(LuBackend::Auto)};
  LemkeOptions options;
  options.keep_basis = true;
  const AffineMcp first = standard_lcp(matrix({{2, 1}, {1, 2}}), vec({-5, -6}));
  const AffineMcp second = standard_lcp(matrix({{4, 1}, {1, 7}}), vec({-5, -6}));
  const auto one = straight_path(first, vec({1, 1}), options, lu);
  ASSERT_TRUE(one && straight_path(second, vec({1, 1}), options, lu));
  EXPECT_LT((chord_step(*one, vec({3, 3})) - vec({-1, -1})).norm(), 1e-14);
}

}  // namespace
}  // namespace perp::lcp
