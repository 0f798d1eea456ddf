// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/structure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "lcp/dense_factors.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::Triplets;
using Indices = std::vector<Index>;

/// A matching along entries, each row and column at most once.
void expect_matching(const SpMat& A, const Matching& m) {
  ASSERT_EQ(static_cast<Index>(m.column_of_row.size()), A.rows());
  ASSERT_EQ(static_cast<Index>(m.row_of_column.size()), A.cols());
  Index pairs = 0;
  for (std::size_t j = 0; j < m.row_of_column.size(); ++j) {
    const Index i = m.row_of_column[j];
    if (i < 0) continue;
    ++pairs;
    EXPECT_EQ(m.column_of_row[static_cast<std::size_t>(i)], static_cast<Index>(j));
    EXPECT_NE(A.coeff(i, static_cast<Index>(j)), 0);
  }
  EXPECT_EQ(pairs, m.size);
  EXPECT_EQ(std::count_if(m.column_of_row.begin(), m.column_of_row.end(), [](Index j) { return j >= 0; }), m.size);
}

/// The structural rank by Koenig's theorem in Ore's form: n - max over sets of columns of (size - rows they meet).
Index rank_by_sets(const Dense& A) {
  Index deficiency = 0;
  for (int set = 0; set < (1 << A.cols()); ++set) {
    Index columns = 0;
    std::set<Index> rows;
    for (Index j = 0; j < A.cols(); ++j) {
      if (((set >> j) & 1) == 0) continue;
      ++columns;
      for (Index i = 0; i < A.rows(); ++i)
        if (A(i, j) != 0) rows.insert(i);
    }
    deficiency = std::max(deficiency, columns - static_cast<Index>(rows.size()));
  }
  return A.cols() - deficiency;
}

SpMat random_pattern(Index m, Index n, double density, Random& random) {
  const Dense A = Dense::NullaryExpr(m, n, [&] { return random.chance(density) ? random.uniform(1, 2) : 0.0; });
  return A.sparseView();
}

SpMat without(const SpMat& A, Index row, Index column) {
  Dense B(A);
  if (row >= 0) B.row(row).setZero();
  if (column >= 0) B.col(column).setZero();
  return B.sparseView();
}

TEST(Structure, MatchingsAreMaximum) {
  Random random(1);
  for (int trial = 0; trial < 400; ++trial) {
    const Index m = random.integer(0, 9);
    const Index n = random.integer(0, 9);
    const SpMat A = random_pattern(m, n, random.uniform(0, 0.5), random);
    const Matching matching = maximum_matching(A);
    expect_matching(A, matching);
    ASSERT_EQ(matching.size, rank_by_sets(Dense(A))) << Dense(A);
  }
}

// Lower bidiagonal with an entry in the corner above: the diagonal pairs of the greedy start leave column 1 and row n +
// 1 alone, and only the path through all of them mends it. Would catch recursion too deep and pairs lost on the way.
TEST(Structure, LongAugmentingPath) {
  constexpr int n = 200'000;
  Triplets entries;
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k + 1, k, 1);
    if (k > 0) entries.emplace_back(k, k, 1);
  }
  entries.emplace_back(0, n, 1);
  const SpMat A = support::from(n + 1, entries);
  const Matching matching = maximum_matching(A);
  EXPECT_EQ(matching.size, n + 1);
  expect_matching(A, matching);
}

// Almost all values give the structural rank: random ones do (Edmonds 1967).
TEST(Structure, RankOfRandomValues) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const SpMat A = random_pattern(random.integer(1, 30), random.integer(1, 30), random.uniform(0.02, 0.2), random);
    EXPECT_EQ(structural_rank(A), Eigen::FullPivLU<Dense>(Dense(A)).rank()) << Dense(A);
  }
}

// The example drawn in the header, smallest of each kind; would catch parts exchanged or indices of the wrong side.
TEST(Structure, PartsOfASmallMatrix) {
  const SpMat A = matrix({{1, 1, 0, 1, 0},    //
                          {0, 0, 1, 1, 0},    //
                          {0, 0, 1, 1, 1},    //
                          {0, 0, 0, 0, 1},    //
                          {0, 0, 0, 0, 1}});  //
  const Structure s = dulmage_mendelsohn(A);
  EXPECT_EQ(s.rank, 4);
  EXPECT_EQ(s.under.rows, (Indices{0}));
  EXPECT_EQ(s.under.columns, (Indices{0, 1}));
  EXPECT_EQ(s.square.rows, (Indices{1, 2}));
  EXPECT_EQ(s.square.columns, (Indices{2, 3}));
  EXPECT_EQ(s.over.rows, (Indices{3, 4}));
  EXPECT_EQ(s.over.columns, (Indices{4}));
}

TEST(Structure, EmptyRowsAndColumns) {
  const Structure s = dulmage_mendelsohn(matrix({{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(s.rank, 2);
  EXPECT_EQ(s.under.columns, (Indices{1}));
  EXPECT_TRUE(s.under.rows.empty());
  EXPECT_EQ(s.over.rows, (Indices{1}));
  EXPECT_TRUE(s.over.columns.empty());
  EXPECT_EQ(s.square.rows, (Indices{0, 2}));
}

TEST(Structure, NothingAndRectangles) {
  const Structure nothing = dulmage_mendelsohn(SpMat(0, 0));
  EXPECT_EQ(nothing.rank, 0);
  EXPECT_TRUE(nothing.under.empty() && nothing.square.empty() && nothing.over.empty());
  EXPECT_EQ(dulmage_mendelsohn(SpMat(3, 0)).over.rows.size(), 3U);
  EXPECT_EQ(dulmage_mendelsohn(SpMat(0, 2)).under.columns.size(), 2U);
  EXPECT_EQ(dulmage_mendelsohn(matrix({{1, 1, 1}})).under.columns.size(), 3U);
}

// A zero that is stored is an entry of a pattern and none of a matrix; a NaN is always one.
TEST(Structure, StoredZeros) {
  SpMat A = matrix({{1, 0}, {0, 1}});
  A.coeffRef(1, 1) = 0;
  EXPECT_EQ(structural_rank(A), 1);
  EXPECT_EQ(structural_rank(A, Entries::Stored), 2);
  A.coeffRef(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(structural_rank(A), 2);
  SpMat loose(2, 2);  // not compressed
  loose.insert(1, 0) = 1;
  loose.insert(0, 1) = 1;
  ASSERT_FALSE(loose.isCompressed());
  EXPECT_EQ(structural_rank(loose), 2);
}

/// What the header promises of the parts, each recomputed: the zeros, the shapes, and that the rows of `over` and the
/// columns of `under` are exactly those without which the rank stays.
void expect_decomposition(const SpMat& A) {
  const Structure s = dulmage_mendelsohn(A);
  expect_matching(A, s.matching);
  std::vector<int> row(static_cast<std::size_t>(A.rows()), -1);
  std::vector<int> column(static_cast<std::size_t>(A.cols()), -1);
  int k = 0;
  for (const StructurePart* part : {&s.under, &s.square, &s.over}) {
    EXPECT_TRUE(std::is_sorted(part->rows.begin(), part->rows.end()));
    for (const Index i : part->rows) row[static_cast<std::size_t>(i)] = k;
    for (const Index j : part->columns) column[static_cast<std::size_t>(j)] = k;
    ++k;
  }
  EXPECT_EQ(std::count(row.begin(), row.end(), -1) + std::count(column.begin(), column.end(), -1), 0);
  EXPECT_EQ(s.square.rows.size(), s.square.columns.size());
  EXPECT_TRUE(s.under.empty() || s.under.rows.size() < s.under.columns.size());
  EXPECT_TRUE(s.over.empty() || s.over.rows.size() > s.over.columns.size());
  EXPECT_EQ(s.rank, static_cast<Index>(s.under.rows.size() + s.square.rows.size() + s.over.columns.size()));
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      EXPECT_LE(row[static_cast<std::size_t>(it.row())], column[static_cast<std::size_t>(j)]) << Dense(A);
  for (Index i = 0; i < A.rows(); ++i)
    EXPECT_EQ(structural_rank(without(A, i, -1)) == s.rank, row[static_cast<std::size_t>(i)] == 2) << i << '\n'
                                                                                                   << Dense(A);
  for (Index j = 0; j < A.cols(); ++j)
    EXPECT_EQ(structural_rank(without(A, -1, j)) == s.rank, column[static_cast<std::size_t>(j)] == 0) << j << '\n'
                                                                                                      << Dense(A);
}

TEST(Structure, PartsAreWhatTheyShouldBe) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial)
    expect_decomposition(
        random_pattern(random.integer(1, 12), random.integer(1, 12), random.uniform(0.02, 0.4), random));
}

// Permutations move the parts and change nothing else; would catch a dependence on the matching found.
TEST(Structure, IndependentOfTheOrder) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const SpMat A = random_pattern(15, 15, 0.1, random);
    Indices p(15);
    Indices q(15);
    std::iota(p.begin(), p.end(), 0);
    std::iota(q.begin(), q.end(), 0);
    for (std::size_t k = 15; k-- > 1;) {
      std::swap(p[k], p[static_cast<std::size_t>(random.integer(0, static_cast<int>(k)))]);
      std::swap(q[k], q[static_cast<std::size_t>(random.integer(0, static_cast<int>(k)))]);
    }
    const Structure s = dulmage_mendelsohn(A);
    const Structure t = dulmage_mendelsohn(Dense(Dense(A)(p, q)).sparseView());
    const auto back = [](const Indices& order, const Indices& indices) {
      Indices original;
      for (const Index i : indices) original.push_back(order[static_cast<std::size_t>(i)]);
      std::sort(original.begin(), original.end());
      return original;
    };
    EXPECT_EQ(back(p, t.over.rows), s.over.rows);
    EXPECT_EQ(back(q, t.over.columns), s.over.columns);
    EXPECT_EQ(back(p, t.under.rows), s.under.rows);
    EXPECT_EQ(back(q, t.under.columns), s.under.columns);
  }
}

// Three random entries a column and no diagonal to help: a fraction of a second, where the plain depth-first search
// would take minutes.
TEST(Structure, Large) {
  constexpr int n = 200'000;
  Random random(5);
  Triplets entries;
  entries.reserve(3 * n);
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < 3; ++k) entries.emplace_back(random.integer(0, n - 1), j, 1);
  const SpMat A = support::from(n, entries);
  const auto begin = std::chrono::steady_clock::now();
  const Structure s = dulmage_mendelsohn(A);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  // Row degrees are Poisson with mean 3: e^-3 of the rows are empty and nothing repairs them.
  EXPECT_LT(static_cast<double>(s.rank), n * (1 - std::exp(-3.0)) + 1500);
  EXPECT_GT(static_cast<double>(s.rank), 0.9 * n);
  EXPECT_EQ(s.rank, static_cast<Index>(s.under.rows.size() + s.square.rows.size() + s.over.columns.size()));
  EXPECT_LT(time.count(), 20) << "seconds";
}

}  // namespace
}  // namespace perp::lcp
