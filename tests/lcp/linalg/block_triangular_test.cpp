// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/block_triangular.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "lcp/pivoting/block_pivoting.hpp"
#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

/// Component numbers by the definition: i and j are in one if each reaches the other, by powers of the graph.
std::vector<std::vector<char>> reach(const AffineMcp& problem) {
  const auto n = static_cast<std::size_t>(problem.size());
  std::vector<std::vector<char>> r(n, std::vector<char>(n, 0));
  const Dense M(problem.M);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const auto row = static_cast<Index>(i);
      r[i][j] = i == j || (M(row, static_cast<Index>(j)) != 0 && problem.box.lower[row] != problem.box.upper[row]);
    }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) r[i][j] = r[i][j] || (r[i][k] && r[k][j]);
  return r;
}

// Against the definition on random graphs of every density, with rows of fixed variables and stored zeros. Catches a
// wrong low link, a component split or two merged, an order in which a component comes before what it depends on.
TEST(BlockTriangular, ComponentsOfTheDefinition) {
  Random random(11);
  for (int run = 0; run < 300; ++run) {
    const Index n = random.integer(0, 14);
    SpMat M = n > 0 ? support::from(n, support::scatter(n, random.integer(0, 2), random)) : SpMat(0, 0);
    for (Index k = 0; k < M.nonZeros(); ++k)
      if (random.chance(0.1)) M.valuePtr()[k] = 0;
    const AffineMcp problem{.M = M, .q = Vec::Zero(n), .box = support::mixed_box(n, random)};
    const Components c = strong_components(problem);
    std::vector<Index> sorted = c.order;
    std::sort(sorted.begin(), sorted.end());
    std::vector<Index> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    ASSERT_EQ(sorted, all);
    std::vector<Index> number(static_cast<std::size_t>(n));
    for (Index k = 0; k < c.count(); ++k) {
      ASSERT_LT(c.first[static_cast<std::size_t>(k)], c.first[static_cast<std::size_t>(k + 1)]);
      for (Index p = c.first[static_cast<std::size_t>(k)]; p < c.first[static_cast<std::size_t>(k + 1)]; ++p)
        number[static_cast<std::size_t>(c.order[static_cast<std::size_t>(p)])] = k;
    }
    const auto r = reach(problem);
    for (std::size_t i = 0; i < number.size(); ++i)
      for (std::size_t j = 0; j < number.size(); ++j) {
        EXPECT_EQ(number[i] == number[j], r[i][j] && r[j][i]) << run << ": " << i << " and " << j;
        if (r[i][j]) {
          EXPECT_GE(number[i], number[j]) << run << ": " << i << " depends on " << j;
        }
      }
  }
}

// A chain of 300000 variables: recursion would overflow the stack, a row search would take n^2.
TEST(BlockTriangular, LongChainsNeedNoStack) {
  const Index n = 300000;
  const AffineMcp chain = standard_lcp(support::tridiagonal(n, -0.5, 1, 0), Vec::Constant(n, -1));
  EXPECT_EQ(strong_components(chain).count(), n);
  const Result result = solve_by_components(
      chain, Vec::Zero(n), [](const AffineMcp&, In, const Limits&) -> Result { throw std::logic_error("not needed"); });
  expect_solved(chain, result, "chain");
  EXPECT_DOUBLE_EQ(result.z[n - 1], 2);  // z_i = 1 + z_{i-1} / 2
  EXPECT_EQ(strong_components(standard_lcp(support::tridiagonal(n, -1, 3, -1), Vec::Zero(n))).count(), 1);
}

// Permuted block triangular problems with P-matrices on the diagonal and planted solutions, in every kind of box.
TEST(BlockTriangular, SolvesWhatIsPlanted) {
  Random random(5);
  for (int run = 0; run < 60; ++run) {
    const Index n = random.integer(1, 40);
    std::vector<int> perm(static_cast<std::size_t>(n));
    std::iota(perm.begin(), perm.end(), 0);
    for (std::size_t i = perm.size(); i > 1; --i)
      std::swap(perm[i - 1], perm[static_cast<std::size_t>(random.integer(0, static_cast<int>(i) - 1))]);
    const SpMat H = support::h_plus(n, 2, random);
    support::Triplets entries;
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(H, j); it; ++it)
        if (it.row() / 5 >= j / 5)  // blocks of five, lower triangular
          entries.emplace_back(perm[static_cast<std::size_t>(it.row())], perm[static_cast<std::size_t>(j)], it.value());
    const auto [problem, solution] = plant(support::from(n, entries), support::mixed_box(n, random), 0.3, random);
    const Result result =
        solve_by_components(problem, Vec::Zero(n), [](const AffineMcp& part, In start, const Limits& limits) {
          EXPECT_LE(part.size(), 5);
          return block_pivoting(part, start, {.components = false}, limits);
        });
    expect_solved(problem, result, "planted");
    EXPECT_LT(norm_inf(result.z - solution), 1e-7);
  }
}

Result no_solver(const AffineMcp& part, In start, const Limits& limits) {
  Result result = judged(part, start, limits, Status::Infeasible, "no");
  const Vec y = Vec::Unit(part.size(), 0);
  if (proves_infeasible(part, y)) result.certificate = y;
  return result;
}

// Infeasible is said of the whole only where that follows. z_1 = 0 or anything above solves 0 >= 0; w_2 = z_1 - 1 needs
// z_1 >= 1: solvable, so that the failure of the second component after z_1 = 0 is no proof.
TEST(BlockTriangular, AFailureIsNoProof) {
  const AffineMcp solvable = standard_lcp(matrix({{0, 0}, {1, 0}}), vec({0, -1}));
  ASSERT_EQ(support::violation(solvable, vec({1, 0})), 0);
  const Result result = solve_by_components(solvable, Vec::Zero(2), no_solver);
  EXPECT_EQ(result.status, Status::Stalled);
  EXPECT_NE(result.message.find("component 2 of 2"), std::string::npos) << result.message;
  // With z_1 = 1/2 forced the same second row has no solution, and there is no certificate y >= 0 with M'y <= 0.
  const AffineMcp forced = standard_lcp(matrix({{2, 0}, {1, 0}}), vec({-1, -1}));
  EXPECT_EQ(solve_by_components(forced, Vec::Zero(2), no_solver).status, Status::Infeasible);
  // A first component without solution is a certificate for the whole.
  const AffineMcp first = standard_lcp(matrix({{0, 0}, {1, 1}}), vec({-1, -1}));
  const Result proven = solve_by_components(first, Vec::Zero(2), no_solver);
  EXPECT_EQ(proven.status, Status::Infeasible);
  EXPECT_TRUE(proves_infeasible(first, proven.certificate));
}

TEST(BlockTriangular, RefusesAndStops) {
  const AffineMcp problem = standard_lcp(matrix({{0, 0}, {1, 1}}), vec({1, 1}));
  EXPECT_THROW(solve_by_components(problem, Vec::Zero(1), no_solver), std::invalid_argument);
  EXPECT_THROW(solve_by_components(problem, Vec::Zero(2), nullptr), std::invalid_argument);
  Limits limits;
  limits.interrupted = [] { return true; };
  EXPECT_EQ(solve_by_components(standard_lcp(matrix({{0}}), vec({-1})), Vec::Zero(1), no_solver, limits).status,
            Status::Interrupted);
  // 1e300 (1e300): the second component's q is not finite.
  const AffineMcp huge = standard_lcp(matrix({{1e-300, 0}, {1e300, 1}}), vec({-1, -1}));
  expect_honest(huge, solve_by_components(huge, Vec::Zero(2), no_solver), "overflow");
}

}  // namespace
}  // namespace perp::lcp
