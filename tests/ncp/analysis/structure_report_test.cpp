// SPDX-License-Identifier: Apache-2.0
// Which equations and variables a singular Jacobian is blamed on: small matrices whose defects are known by
// construction.
#include "ncp/analysis/structure_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ncp/problem/affine.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

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

/// Of the affine problem at a point that has to be a solution.
std::string undetermined_at(const SpMat& M, const Vec& q, const Box& box, const Vec& x, double tol = 1e-8) {
  const auto mcp = make_affine_mcp({M, q, box}, "affine");
  Vec F(x.size());
  EXPECT_TRUE(mcp->eval(x, F) && residual(*mcp, x).natural <= tol);
  return undetermined(*mcp, M, x, F, tol);
}

// Solutions that a line of others goes through, by construction, and some that are alone. Catches a continuum that
// nobody mentions, variables that do not take part in it, and a singular Jacobian that passes for a continuum.
TEST(Undetermined, NamesWhatMoves) {
  const std::string many = "the solution is not the only one: ";
  // x - y = 0 twice: x and y move together, z = 1 does not.
  const std::string homogeneous =
      undetermined_at(matrix({{1, -1, 0}, {-1, 1, 0}, {0, 0, 2}}), vec({0, 0, -2}), Box::free(3), vec({5, 5, 1}));
  EXPECT_THAT(homogeneous, testing::StartsWith(many));
  EXPECT_THAT(homogeneous, AllOf(HasSubstr("x[1]"), HasSubstr("x[2]"), Not(HasSubstr("x[3]"))));
  // The same away from zero, in other units.
  EXPECT_THAT(undetermined_at(matrix({{1, -1e6}, {-1e-3, 1e3}}), vec({0, 0}), Box::nonnegative(2), vec({1e6, 1})),
              testing::StartsWith(many));
  // An equation without variables, whose variable is free.
  EXPECT_THAT(undetermined_at(matrix({{0, 0}, {0, 1}}), vec({0, -3}), Box::free(2), vec({0, 3})),
              AllOf(testing::StartsWith(many), HasSubstr("x[1]"), Not(HasSubstr("x[2]"))));
  // q = 2 twice and nothing on p, which is at its bound.
  EXPECT_EQ(undetermined_at(matrix({{0, 1}, {0, 1}}), vec({-2, -2}), Box::nonnegative(2), vec({0, 2})),
            many + "variable x[1] is in no equation");
  // p >= 0 of q - 1 = 1 is at its bound, and stays there.
  EXPECT_EQ(undetermined_at(matrix({{0, 1}, {0, 1}}), vec({-1, -2}), Box::nonnegative(2), vec({0, 2})), "");
  EXPECT_EQ(undetermined_at(matrix({{2, 1}, {1, 2}}), vec({-3, -3}), Box::nonnegative(2), vec({1, 1})), "");
  // x^2 = 0 has one solution, where its Jacobian is 0.
  const auto square = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x; }, [](double x) { return 2 * x; }));
  EXPECT_THAT(undetermined(*square, matrix({{0}}), vec({0}), vec({0}), 1e-8),
              testing::StartsWith("the solution is perhaps not the only one: "));
}

// Walras: excess demands of Cobb-Douglas consumers depend on relative prices alone. Catches curvature that hides a
// continuum, and prices that are not named.
TEST(Undetermined, NamesPricesWithoutANumeraire) {
  Functions f;
  f.name = "walras";
  f.variable_names = {"p_bread", "p_wine"};
  f.box = Box::nonnegative(2);
  f.box.lower = vec({1e-3, 1e-3});
  // Supply 1 of each less demand (p_bread + p_wine) / (2 p).
  f.F = [](In p, Out F) {
    const double income = p[0] + p[1];
    F << 1 - income / (2 * p[0]), 1 - income / (2 * p[1]);
    return true;
  };
  const auto mcp = make_mcp(std::move(f));
  const Result result = solve(*mcp, vec({1, 3}), method_of("path"));
  ASSERT_TRUE(result.solved()) << result;
  ASSERT_FALSE(result.notes.empty());
  EXPECT_THAT(result.notes.back(), AllOf(testing::StartsWith("the solution is not the only one: "),
                                         HasSubstr("p_bread"), HasSubstr("p_wine")));
}

}  // namespace
}  // namespace perp::ncp
