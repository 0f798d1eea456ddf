// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/no_solution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "ncp/graph_problem.hpp"
#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

using testing::HasSubstr;

/// exp(x) + c in the box.
GraphProblem exponential(double c, Box box) {
  ExpressionGraph g;
  const auto row = g.binary(Operation::Add, g.unary(Operation::Exp, g.variable(0)), g.constant(c));
  return {std::move(g), {row}, std::move(box)};
}

// exp(x) + 0.1 = 0, in real numbers. Catches a proof that is not looked for where the first attempt is stuck: every
// method went through all its iterations and restarts.
TEST(NoSolution, EndsEveryMethodBeforeOtherAttempts) {
  const GraphProblem problem = exponential(0.1, Box::free(1));
  std::vector<std::pair<std::string, Method>> methods;
  for (const Preset& preset : presets()) methods.emplace_back(preset.name, preset.method);
  for (const char* strategy : {"escape(semismooth)", "scaled(semismooth)", "first(josephy, semismooth)"})
    methods.emplace_back(strategy, method_of(strategy));
  for (const auto& [name, method] : methods) {
    const Result result = solve(problem, Vec::Zero(1), method);
    EXPECT_EQ(result.status, Status::Infeasible) << name;
    EXPECT_EQ(result.stats.restarts, 0) << name;
    EXPECT_LT(result.stats.iterations, stop(method).max_iterations) << name;
    EXPECT_THAT(result.message, HasSubstr("equation F[1] lies in [0.1, inf] wherever the variables are within their "
                                          "bounds, and x[1] is free"));
  }
}

// The same F with a finite lower bound has the solution there, and exp(x) - 0.1 has one inside. Catches a proof of what
// is false.
TEST(NoSolution, IsNotClaimedWhereThereIsOne) {
  EXPECT_FALSE(no_solution(exponential(0.1, Box::nonnegative(1))));
  EXPECT_FALSE(no_solution(exponential(-0.1, Box::free(1))));
  const GraphProblem at_bound = exponential(0.1, Box::nonnegative(1));
  EXPECT_TRUE(solve(at_bound, Vec::Ones(1), Method{}).solved());
}

// F < 0 needs an upper bound: exp(x) - 100 on x <= 2, from which x may run to its bound, and on [0, 2].
TEST(NoSolution, LooksAtTheBoundTheSignAsksFor) {
  ExpressionGraph g;
  const auto row =
      g.binary(Operation::Subtract, g.unary(Operation::Negate, g.unary(Operation::Exp, g.variable(0))), g.constant(1));
  const GraphProblem none(g, {row}, Box::nonnegative(1));
  const auto proof = no_solution(none);
  ASSERT_TRUE(proof);
  EXPECT_EQ(proof->range, Interval(-infinity, -2));
  EXPECT_THAT(describe(none, *proof), HasSubstr("x[1] has no upper bound"));
  EXPECT_FALSE(no_solution(GraphProblem(g, {row}, Box{Vec{{0}}, Vec{{2}}})));
}

// x_1 has to be at its bound 0, for F_1 = exp(x_2) > 0, and then F_2 = x_1 - log(2 + x_1) is negative: two steps of
// reasoning. Catches a box that is not narrowed, and a variable that is fixed at the wrong bound.
TEST(NoSolution, GoesOnFromWhatASignForces) {
  ExpressionGraph g;
  const auto x1 = g.variable(0), x2 = g.variable(1);
  const auto F1 = g.unary(Operation::Exp, x2);
  const auto F2 =
      g.binary(Operation::Subtract, x1, g.unary(Operation::Log, g.binary(Operation::Add, g.constant(2), x1)));
  const GraphProblem problem(std::move(g), {F1, F2}, Box::nonnegative(2));
  const auto proof = no_solution(problem);
  ASSERT_TRUE(proof);
  EXPECT_EQ(proof->row, 1);
  EXPECT_NEAR(proof->range.upper, -std::log(2), 1e-15);
}

// F_1 = x_1 + 1 > 0 forces x_1 = 0, and then F_2 = exp(x_2) + 0.1 - x_1 >= 0.1. Over the bounds alone F_2 takes every
// value. Catches a message that gives the range of a smaller box for that of the bounds.
TEST(NoSolution, SaysWhereARangeHolds) {
  ExpressionGraph g;
  const auto x1 = g.variable(0), x2 = g.variable(1);
  const auto F1 = g.binary(Operation::Add, x1, g.constant(1));
  const auto F2 =
      g.binary(Operation::Add, g.unary(Operation::Exp, x2), g.binary(Operation::Subtract, g.constant(0.1), x1));
  const GraphProblem problem(std::move(g), {F1, F2}, Box{Vec{{0, -infinity}}, Vec{{infinity, infinity}}});
  const auto proof = no_solution(problem);
  ASSERT_TRUE(proof);
  EXPECT_EQ(describe(problem, *proof),
            "equation F[2] lies in [0.1, inf] wherever the signs of the other equations leave room for a solution, and "
            "x[2] is free");
}

// log(x - 3) on x <= 2. Catches an empty range that passes for one without a sign.
TEST(NoSolution, SeesARowThatIsDefinedNowhere) {
  ExpressionGraph g;
  const auto row = g.unary(Operation::Log, g.binary(Operation::Subtract, g.variable(0), g.constant(3)));
  const GraphProblem problem(std::move(g), {row}, Box{Vec{{0}}, Vec{{2}}});
  const Result result = solve(problem, Vec::Ones(1), Method{});
  EXPECT_EQ(result.status, Status::Infeasible);
  EXPECT_THAT(result.message, HasSubstr("is defined nowhere within the bounds"));
}

// The judge accepts a natural residual of 1e-6. exp(x) + 1e-9 = 0 has no solution, and x = -20 is good enough; x =
// 0.1, fixed, and x = 0.1000000001 is so as well. Catches "infeasible" of what is solved to the tolerance.
TEST(NoSolution, IsAskedForToTheTolerance) {
  const GraphProblem smoothed = exponential(1e-9, Box::free(1));
  EXPECT_TRUE(no_solution(smoothed));
  EXPECT_FALSE(no_solution(smoothed, 1e-6));
  EXPECT_TRUE(solve(smoothed, Vec::Zero(1), Method{}).solved());
  EXPECT_TRUE(no_solution(exponential(1e-5, Box::free(1)), 1e-6));

  ExpressionGraph g;
  const auto difference = g.binary(Operation::Subtract, g.variable(0), g.constant(0.1000000001));
  Box box{Vec{{0.1, -infinity}}, Vec{{0.1, infinity}}};
  const GraphProblem share(std::move(g), {difference, difference}, box);
  EXPECT_TRUE(no_solution(share));
  EXPECT_FALSE(no_solution(share, 1e-6));
  EXPECT_TRUE(solve(share, Vec{{0.1, 0}}, Method{}).solved());
}

// With a tolerance, F_1 > tol says x_1 <= tol, and no more: F_2 = 1 - 1e7 x_1 is 0 at x_1 = 1e-7. Catches the exact
// conclusion, x_1 = 0, where points near it may be accepted.
TEST(NoSolution, LeavesTheToleranceBesideABound) {
  ExpressionGraph g;
  const auto F1 = g.constant(1);
  const auto F2 =
      g.binary(Operation::Subtract, g.constant(1), g.binary(Operation::Multiply, g.constant(1e7), g.variable(0)));
  const GraphProblem problem(std::move(g), {F1, F2}, Box{Vec{{0, -infinity}}, Vec{{infinity, infinity}}});
  EXPECT_TRUE(no_solution(problem));
  EXPECT_FALSE(no_solution(problem, 1e-6));
  EXPECT_TRUE(no_solution(problem, 1e-8));
}

// atan2(y, -1) = pi at y = 0 and -pi just below. Catches a range that ends on one side of the cut.
TEST(NoSolution, LooksAtBothSidesOfTheCutOfAtan2) {
  ExpressionGraph g;
  const auto row = g.binary(Operation::Subtract, g.binary(Operation::Atan2, g.variable(0), g.constant(-1)),
                            g.constant(3.141592653589793));
  const GraphProblem problem(std::move(g), {row, row}, Box{Vec{{-1, -infinity}}, Vec{{0, infinity}}});
  EXPECT_FALSE(no_solution(problem));
}

// x / infinity is 0 for a function of doubles, and no real number. Catches "defined nowhere" of what every method
// evaluates.
TEST(NoSolution, KnowsNothingOfInfiniteConstants) {
  ExpressionGraph g;
  const auto row = g.binary(Operation::Divide, g.variable(0), g.constant(infinity));
  EXPECT_FALSE(no_solution(GraphProblem(std::move(g), {row}, Box::free(1))));
}

// What nobody knows the ranges of is solved as ever.
TEST(NoSolution, SaysNothingWithoutRanges) {
  const auto problem = make_mcp({.box = Box::free(1),
                                 .pattern = dense_pattern(1),
                                 .F =
                                     [](In x, Out F) {
                                       F[0] = std::exp(x[0]) + 0.1;
                                       return true;
                                     },
                                 .J =
                                     [](In x, SpMat& J) {
                                       J.coeffRef(0, 0) = std::exp(x[0]);
                                       return true;
                                     }});
  EXPECT_FALSE(no_solution(*problem));
}

/// x_1 + x_2 + x_3 = 1, 2 x_1^2 + 3 x_2^2 + 4 x_3^2 = c on [0, 1]^3 and two free multipliers that occur in no equation:
/// the least value is 12/13.
GraphProblem portfolio(double c) {
  ExpressionGraph g;
  const auto square = [&](int i, double by) {
    const auto x = g.variable(i);
    return g.binary(Operation::Multiply, g.constant(by), g.binary(Operation::Multiply, x, x));
  };
  const auto add = [&](auto a, auto b) { return g.binary(Operation::Add, a, b); };
  const auto budget = add(add(add(g.variable(0), g.variable(1)), g.variable(2)), g.constant(-1));
  const auto risk = add(add(add(square(0, 2), square(1, 3)), square(2, 4)), g.constant(-c));
  const std::vector<ExpressionGraph::Node> rows{add(g.variable(3), g.variable(4)), g.variable(3), g.variable(4), budget,
                                                risk};
  Box box = Box::free(5);
  box.lower.head(3).setZero();
  box.upper.head(3).setOnes();
  return {std::move(g), rows, std::move(box)};
}

// No row alone shows that there is none, and no method ends: the two equations meet in no part of the box. Catches a
// proof that is given up at the first part that needs halves.
TEST(NoSolution, InPartsWhereEquationsDoNotMeet) {
  EXPECT_FALSE(no_solution(portfolio(0.9)));
  EXPECT_GT(no_solution_in_parts(portfolio(0.9)), 1);
  EXPECT_GT(no_solution_in_parts(portfolio(4.1)), 0);
  const Result result = solve(portfolio(0.9), Vec::Constant(5, 0.3), path());
  EXPECT_EQ(result.status, Status::Infeasible);
  EXPECT_THAT(result.message, HasSubstr("parts of the box"));
}

// Between 12/13 and 4 there are solutions. Catches a proof of what is false.
TEST(NoSolution, InPartsIsNotClaimedWhereThereIsOne) {
  for (const double c : {0.9231, 1.0, 2.0, 4.0}) EXPECT_EQ(no_solution_in_parts(portfolio(c)), 0) << c;
  EXPECT_EQ(no_solution_in_parts(exponential(0.1, Box::nonnegative(1))), 0);
}

// z = 0 and x - 1 = 0 for -1.7e308 <= x <= 1.7e308, solved by x = 1. Catches a middle that overflows, and the proof of
// what is false that followed: infinity less infinity does not hold 0.
TEST(NoSolution, InPartsOfTheLongestBoxes) {
  for (const double far : {1e300, 1e308, 1.7e308}) {
    ExpressionGraph g;
    const auto z = g.variable(1), F2 = g.binary(Operation::Subtract, g.variable(0), g.constant(1));
    const GraphProblem problem(std::move(g), {z, F2}, Box{Vec{{-far, -infinity}}, Vec{{far, infinity}}});
    EXPECT_EQ(no_solution_in_parts(problem), 0) << far;
    EXPECT_FALSE(no_solution(problem));
  }
}

// 0.9 is 0.02 below the least value: there are points with a residual below 0.05, which the judge would accept for that
// tolerance. Catches a proof that contradicts the judge.
TEST(NoSolution, InPartsIsAboutTheTolerance) {
  EXPECT_GT(no_solution_in_parts(portfolio(0.9), 1e-8), 0);
  EXPECT_EQ(no_solution_in_parts(portfolio(0.9), 0.05), 0);
}

// log(x) with x in [-3, -1] has no value anywhere: there is no residual to give a bound of. Catches a bound that is
// where a search for it ended.
TEST(NoSolution, DefinedNowhereHasNoResidual) {
  ExpressionGraph g;
  const auto row = g.unary(Operation::Log, g.variable(0));
  const GraphProblem problem(std::move(g), {row}, Box{Vec{{-3}}, Vec{{-1}}});
  const Result result = solve(problem, Vec{{-2}}, method_of("auto"));
  EXPECT_EQ(result.status, Status::Infeasible);
  EXPECT_EQ(result.proof.residual_bound, infinity);
  EXPECT_THAT(result.message, testing::AllOf(HasSubstr("defined nowhere within the bounds"),
                                             testing::Not(HasSubstr("has a natural residual below"))));
}

}  // namespace
}  // namespace perp::ncp
