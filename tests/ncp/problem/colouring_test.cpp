// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/colouring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <set>
#include <vector>

namespace perp::ncp {
namespace {

using lcp::SpMat;

SpMat pattern_where(int n, const std::function<bool(int, int)>& entry) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (entry(i, j)) entries.emplace_back(i, j, 1.0);
  SpMat pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  pattern.makeCompressed();
  return pattern;
}

/// Every column once, and no row twice in a group: Curtis, Powell & Reid's condition, checked entry by entry.
void expect_valid_groups(const SpMat& pattern, const std::vector<std::vector<int>>& groups) {
  std::set<int> columns;
  for (const auto& group : groups) {
    EXPECT_FALSE(group.empty());
    std::set<int> rows;
    for (const int j : group) {
      EXPECT_TRUE(columns.insert(j).second) << "column " << j << " twice";
      for (SpMat::InnerIterator it(pattern, j); it; ++it)
        EXPECT_TRUE(rows.insert(static_cast<int>(it.row())).second) << "row " << it.row() << " twice";
    }
  }
  EXPECT_EQ(static_cast<int>(columns.size()), pattern.cols());
}

std::size_t fullest_row_of(const SpMat& pattern) {
  std::vector<std::size_t> rows(lcp::at(pattern.rows()));
  for (int j = 0; j < pattern.cols(); ++j)
    for (SpMat::InnerIterator it(pattern, j); it; ++it) ++rows[lcp::at(it.row())];
  return rows.empty() ? 0 : *std::ranges::max_element(rows);
}

// The definition, on 300 random patterns of 1 to 40 columns, with empty rows and columns. Catches two columns of a row
// in one group, whose derivatives would be added up, and a column left out, whose derivatives would stay 0.
TEST(ColumnGroups, AreValidForRandomPatterns) {
  std::mt19937 engine(74);
  for (int round = 0; round < 300; ++round) {
    const int n = std::uniform_int_distribution<int>(1, 40)(engine);
    std::bernoulli_distribution entry(std::uniform_real_distribution<double>(0, 0.4)(engine));
    const SpMat pattern = pattern_where(n, [&](int, int) { return entry(engine); });
    const auto groups = column_groups(pattern);
    expect_valid_groups(pattern, groups);
    EXPECT_GE(groups.size(), fullest_row_of(pattern));
    EXPECT_LE(groups.size(), static_cast<std::size_t>(n));
  }
}

// Curtis, Powell & Reid 1974: columns j, j + w, j + 2 w, ... of a band of width w go together, and a full row needs w.
// Catches an order of the columns that costs more evaluations than the band.
TEST(ColumnGroups, OfBandedMatricesAreAsManyAsTheBandIsWide) {
  for (int below = 0; below <= 4; ++below)
    for (int above = 0; above <= 4; ++above)
      for (const int n : {below + above + 1, 13, 50}) {
        const SpMat pattern = pattern_where(n, [&](int i, int j) { return i - j <= below && j - i <= above; });
        const auto groups = column_groups(pattern);
        expect_valid_groups(pattern, groups);
        EXPECT_EQ(groups.size(), static_cast<std::size_t>(below + above + 1)) << below << " " << above << " " << n;
      }
}

// An arrow's full row meets every column: n groups, the worst case (Coleman & More 1983). Its mirror, a full column and
// a diagonal, needs 2. Catches the shortcut for full rows taken for full columns.
TEST(ColumnGroups, OfArrowsAreTheWorstAndTheBestCase) {
  const int n = 30;
  const SpMat row = pattern_where(n, [](int i, int j) { return i == 0 || i == j; });
  expect_valid_groups(row, column_groups(row));
  EXPECT_EQ(column_groups(row).size(), 30U);
  const SpMat column = pattern_where(n, [](int i, int j) { return j == 0 || i == j; });
  expect_valid_groups(column, column_groups(column));
  EXPECT_EQ(column_groups(column).size(), 2U);
}

// Nothing, no entries, all entries. Catches sizes of 0 taken for sizes of 1.
TEST(ColumnGroups, OfTheSmallestAndTheFullestPatterns) {
  EXPECT_TRUE(column_groups(SpMat(0, 0)).empty());
  SpMat none(3, 3);
  none.makeCompressed();
  EXPECT_EQ(column_groups(none).size(), 1U);
  EXPECT_EQ(column_groups(pattern_where(5, [](int, int) { return true; })).size(), 5U);
}

}  // namespace
}  // namespace perp::ncp
