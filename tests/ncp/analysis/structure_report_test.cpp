// SPDX-License-Identifier: Apache-2.0
// Which equations and variables a singular Jacobian is blamed on: small matrices whose defects are known by
// construction.
#include "ncp/analysis/structure_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ncp/problem/affine.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<Mcp> free_problem(const SpMat& J) {
  return make_affine_mcp({J, Vec::Zero(J.rows()), Box::free(J.rows())}, "free");
}
std::string name(int i) { return "F[" + std::to_string(i + 1) + "]"; }
/// All variables free, F = 0.
std::string explain(const SpMat& J) {
  return explain_singularity(*free_problem(J), J, Vec::Zero(J.rows()), Vec::Zero(J.rows()));
}

TEST(Listed, ShortensLongLists) {
  const auto letters = [](std::size_t n) {
    return listed(n, [](std::size_t k) { return std::string(1, static_cast<char>('a' + k)); });
  };
  EXPECT_EQ(letters(0), "");
  EXPECT_EQ(letters(1), "a");
  EXPECT_EQ(letters(3), "a, b and c");
  EXPECT_EQ(letters(6), "a, b, c, d, e and f");
  EXPECT_EQ(letters(8), "a, b, c, d, e and 3 more");
}

// x_i at l with F_i > 0 or F_i = 0 stays, with F_i < 0 moves; mirrored at u; fixed variables never move.
TEST(ActiveBlock, IsWhatMoves) {
  const Box box{vec({0, 0, 0, -infinity, -infinity, 0, 2, -infinity}),
                vec({infinity, infinity, 1, 1, 1, 1, 2, infinity})};
  EXPECT_THAT(active_block(box, vec({0, 0, 0.5, 1, 1, 1e-12, 2, 7}), vec({1, -1, 3, -1, 1, 0, -5, 0})),
              ElementsAre(1, 2, 4, 7));
}

TEST(ExplainSingularity, IsSilentWhereThereIsNothing) {
  EXPECT_EQ(explain(matrix({{1, 2}, {3, 4}})), "");
  EXPECT_EQ(explain(matrix({{0, 1}, {1, 0}})), "");
  EXPECT_EQ(explain(matrix({{1e-9, 2e4}, {1e-13, 4}})), "") << "units, not dependence";
  EXPECT_EQ(explain(SpMat(0, 0)), "");
  const SpMat ones = dense_pattern(2);
  EXPECT_EQ(explain_singularity(*free_problem(ones), NAN * ones, Vec::Zero(2), Vec::Zero(2)), "");
  EXPECT_EQ(explain_singularity(*free_problem(ones), ones, Vec::Zero(2), Vec::Constant(2, NAN)), "");
  const auto bounded = make_affine_mcp({matrix({{0, 0}, {0, 0}}), vec({1, 1}), Box::nonnegative(2)}, "at bounds");
  EXPECT_EQ(explain_singularity(*bounded, matrix({{0, 0}, {0, 0}}), Vec::Zero(2), Vec::Ones(2)), "");
}

TEST(ExplainSingularity, NamesEmptyRowsAndColumns) {
  EXPECT_EQ(explain(matrix({{1, 2, 0}, {0, 0, 0}, {3, 5, 0}})),
            "the Jacobian of the 3 variables off their bounds is singular: 1 equation depends on none of them (F[2]); "
            "1 variable is in none of their equations (x[3])");
}

// Three equations for x1, x2; x3, x4 and x5 in two (by hand). Would catch indices of the block taken for the problem's.
TEST(ExplainSingularity, NamesThePartsThatDoNotMatch) {
  const SpMat J = matrix({{1, 1, 0, 0, 0, 0},
                          {0, 0, 1, 0, 0, 0},
                          {1, 2, 0, 0, 0, 0},
                          {2, 1, 0, 0, 0, 0},
                          {1, 0, 0, 1, 1, 1},
                          {0, 1, 0, 1, 1, 2}});
  EXPECT_EQ(explain(J),
            "the Jacobian of the 6 variables off their bounds is singular: too many equations: 3 rows (F[1], F[3] and "
            "F[4]) for 2 variables (x[1] and x[2]); too many unknowns: 3 variables (x[4], x[5] and x[6]) in 2 rows "
            "(F[5] and F[6])");
  // With x3 at its bound F2, which has nothing else, is blamed, and F3 no longer takes part.
  Functions f = support::affine({J, Vec::Zero(6), Box::free(6)});
  f.box.lower[2] = 0;
  EXPECT_EQ(explain_singularity(*make_mcp(f), J, Vec::Zero(6), Vec::Ones(6)),
            "the Jacobian of the 5 variables off their bounds is singular: 1 equation depends on none of them (F[2]); "
            "too many unknowns: 3 variables (x[4], x[5] and x[6]) in 2 rows (F[5] and F[6])");
}

TEST(ExplainSingularity, NamesParallelRowsAndColumns) {
  EXPECT_EQ(explain(matrix({{1, 2, 1}, {0, 1, 5}, {-2, -4, -2}})),
            "the Jacobian of the 3 variables off their bounds is singular: the gradient of equation F[3] is -2 times "
            "that of F[1]");
  EXPECT_THAT(explain(matrix({{1, 2, 3}, {3, 1, 9}, {1, 1, 3}})),
              HasSubstr("the column of variable x[3] is 3 times that of x[1]"));
}

// Row 1 + row 2 = row 4 and column 1 - column 3 = 0 only together with column 5, among rows that have no part in it.
TEST(ExplainSingularity, NamesDependentRows) {
  const SpMat J = matrix({{1, 2, 0, 4, 1}, {3, 1, 1, 0, 0}, {0, 5, 1, 1, 0}, {4, 3, 1, 4, 1}, {1, 0, 0, 0, 2}});
  const std::string text = explain(J);
  EXPECT_THAT(text, HasSubstr("a combination of 3 equations does not change with any variable (F[1], F[2] and F[4])"));
  EXPECT_THAT(text, HasSubstr("can move together"));
}

// Walras' law with prices that only count relative to each other: z(p) homogeneous, p'z = 0. All equations and all
// prices are told, whatever their units.
TEST(ExplainSingularity, SeesWalras) {
  const Index n = 8;
  Random random(5);
  Dense J = random.normals(n, n);
  const Vec p = random.normals(n).cwiseAbs() + Vec::Ones(n);
  J -= p * (p.transpose() * J) / p.squaredNorm();
  J -= (J * p) * p.transpose() / p.squaredNorm();
  for (Index i = 0; i < n; ++i) J.row(i) *= std::pow(10, random.integer(-3, 3));
  const std::string text = explain(support::sparse(J));
  EXPECT_THAT(text, HasSubstr("8 variables can move together without changing any equation (x[1], x[2], x[3], x[4], "
                              "x[5] and 3 more)"));
}

// Random matrices with planted defects: a regular one is never blamed, and a planted dependent set is found exactly
// (unless the pattern or parallel columns came to say it shorter).
TEST(ExplainSingularity, FindsPlantedDependences) {
  Random random(6);
  int found = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Index n = random.integer(6, 30);
    Dense J = support::random_sparse(n, 2, random);
    J.diagonal().array() += 6;
    EXPECT_EQ(explain(support::sparse(J)), "") << trial;
    const int a = random.integer(0, 1), b = random.integer(2, 3), c = random.integer(4, 5);
    J.row(c) = 0.5 * J.row(a) - 2 * J.row(b);
    std::string names = "a combination of 3 equations does not change with any variable (";
    names.append(name(a)).append(", ").append(name(b)).append(" and ").append(name(c)).append(")");
    const std::string text = explain(support::sparse(J));
    EXPECT_THAT(text, AnyOf(HasSubstr(names), HasSubstr("too many"), HasSubstr("times that of"))) << trial;
    found += text.find(names) != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(found, 30);
}

TEST(ExplainSingularity, RefusesSizesThatDoNotFit) {
  const SpMat J = matrix({{1, 2}, {3, 4}});
  const auto mcp = free_problem(J);
  EXPECT_THROW((void)explain_singularity(*mcp, J, Vec::Zero(3), Vec::Zero(2)), std::invalid_argument);
  EXPECT_THROW((void)explain_singularity(*mcp, SpMat(3, 3), Vec::Zero(2), Vec::Zero(2)), std::invalid_argument);
}

}  // namespace
}  // namespace perp::ncp
