// SPDX-License-Identifier: Apache-2.0
/// ncp::automatic(): what it chooses, what it says, and its one budget for all attempts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collection/collection.hpp"
#include "collection/sized.hpp"
#include "ncp/graph_problem.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/run/run.hpp"
#include "ncp/strategy/conditions.hpp"
#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/collection.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using ::testing::HasSubstr;

// Catches a choice that is not said, and false convergence of any member of the family behind it.
TEST(Auto, SolvesTheCollectionAndSaysHow) {
  for (const collection::Entry& entry : collection::entries()) {
    if (!support::quick(entry)) continue;
    const collection::Problem problem = entry.make();
    for (std::size_t k = 0; k < problem.starts.size(); ++k) {
      const std::string what = std::string(entry.name) + " from start " + std::to_string(k + 1);
      const Result result = solve(*problem.mcp, problem.starts[k], automatic());
      if (!result.solved() && support::beyond_all(entry, k)) continue;
      EXPECT_EQ(result.solved(), problem.no_solution.empty()) << what << ": " << result;
      EXPECT_TRUE(!result.solved() || support::violation(*problem.mcp, result.x) <= 1e-8) << what;
      EXPECT_THAT(result.message, testing::AnyOf(HasSubstr("auto had nothing"), HasSubstr("auto chose"),
                                                 HasSubstr("proven to have no solution: equation F[1]")))
          << what;
      EXPECT_TRUE(result.solved() || !problem.mcp->is_affine() || result.status == Status::Infeasible) << what;
    }
  }
}

TEST(Auto, ChoosesByClassAndBasis) {
  const auto affine = collection::find("cottle2")->make();
  EXPECT_THAT(solve(*affine.mcp, Vec::Zero(2), automatic()).message,
              HasSubstr("auto chose the linear methods (the problem is affine)"));
  const auto quasi_definite = collection::make(*collection::find_family("spatial-price-own"), "500");
  EXPECT_THAT(solve(*quasi_definite.mcp, quasi_definite.starts[0], automatic()).message,
              testing::AllOf(HasSubstr("auto chose interior points"), HasSubstr("L S L'")));
  const auto indefinite = collection::find("tinloi42")->make();
  EXPECT_THAT(solve(*indefinite.mcp, indefinite.starts[0], automatic()).message,
              HasSubstr("auto chose the linear methods (the problem is affine)"));
  const auto nonlinear = make_mcp(support::kojima_shindo());
  EXPECT_THAT(solve(*nonlinear, Vec::Zero(4), automatic()).message, HasSubstr("auto chose path"));
  const auto symmetric = collection::make(*collection::find_family("bratu-own"), "50x50");
  EXPECT_THAT(solve(*symmetric.mcp, symmetric.starts[0], automatic()).message,
              HasSubstr("auto chose josephy (the problem is nonlinear, n > 2000, the Jacobian is symmetric)"));
  std::vector<lcp::Cell> basis(2, lcp::Cell::Inside);
  EXPECT_THAT(solve(*affine.mcp, Vec::Zero(2), automatic(), {}, basis).message, HasSubstr("auto chose path"));
  basis.push_back(lcp::Cell::Inside);
  EXPECT_THROW(solve(*affine.mcp, Vec::Zero(2), automatic(), {}, basis), std::invalid_argument);
}

/// a x + x^3 - 1 at x >= 0: F' >= a.
GraphProblem cubic(double a) {
  ExpressionGraph g;
  const auto x = g.variable(0);
  const auto row = g.sum(std::vector{g.binary(Operation::Multiply, g.constant(a), x),
                                     g.binary(Operation::Power, x, g.constant(3)), g.constant(-1)});
  return {std::move(g), {row}, Box::nonnegative(1)};
}

// Proven classes decide about an attempt, and tell of a solution that was not reached. Catches a class that is claimed
// without a proof, and one that nobody uses.
TEST(Auto, UsesProvenClasses) {
  for (const double a : {1.0, -1.0}) {
    const GraphProblem problem = cubic(a);
    const Stop stop;
    ncp::Run run(problem, stop, {});
    Point start;
    ASSERT_TRUE(run.start(Vec::Zero(1), start));
    EXPECT_EQ(Facts(run, start).hold({Condition::UniformP}), a > 0);
    const Result cut = solve(problem, vec({100}), automatic({.max_iterations = 1}));
    ASSERT_FALSE(cut.solved());
    EXPECT_EQ(cut.message.find("exactly one solution") != std::string::npos, a > 0) << cut.message;
  }
}

// Where the path is too long for few pivots, interior points take over, as on traffic equilibria. Catches a first try
// that is not cut off, or whose limit ends the whole run.
TEST(Auto, InteriorPointsWhereThePathIsLong) {
  const collection::Problem problem = collection::find("traffic-own-1148")->make();
  Method method = automatic();
  auto& entries = std::get<First>(method).entries;
  entries = {entries[3], entries[4]};
  for (Entry& entry : entries) entry.when.clear();  // the problem is not large
  entries[0].pivots = 20;
  const Result result = support::expect_solved(*problem.mcp, problem.starts[2], method, "traffic");
  EXPECT_THAT(result.message, HasSubstr("then interior points"));
}

// A row without a solution is named, where a ray would tell a person nothing; the best point is told once.
TEST(Auto, TellsOfAnAffineProblemWithoutSolutionInItsOwnNames) {
  const collection::Problem problem = collection::find("infeasible-row-own")->make();
  const Result result = solve(*problem.mcp, problem.starts[0], automatic());
  EXPECT_EQ(result.status, Status::Infeasible);
  EXPECT_THAT(result.message, HasSubstr("equation F[1] is at most"));
  const std::size_t told = result.message.find("the best point");
  ASSERT_NE(told, std::string::npos);
  EXPECT_EQ(result.message.find("the best point", told + 1), std::string::npos) << result.message;
}

// x^2 + 1 = 0 has no solution: every method gets its turn, within the limits together. Catches attempts that each take
// the whole budget, and records whose counters begin anew.
TEST(Auto, OneBudgetForAllAttempts) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x + 1; }, [](double x) { return 2 * x; }));
  for (const int limit : {1, 7, 50, 1000}) {
    std::vector<Iteration> records;
    const Result result = solve(*mcp, vec({1}), automatic({.max_iterations = limit}), record(records));
    EXPECT_FALSE(result.solved());
    EXPECT_LE(result.stats.iterations, limit);
    EXPECT_FALSE(result.advice.empty());
    for (std::size_t i = 1; i < records.size(); ++i) {
      EXPECT_GE(records[i].k, records[i - 1].k) << limit;
      EXPECT_GE(records[i].F_evals, records[i - 1].F_evals) << limit;
    }
  }
  const auto murty = collection::find("murty-exp")->make();  // pivots are no iterations of auto's
  const Result affine = solve(*murty.mcp, murty.starts[0], automatic({.max_iterations = 3}));
  EXPECT_TRUE(affine.solved()) << affine;
  EXPECT_LE(affine.stats.iterations, 3);
  const Result few = solve(*mcp, vec({1}), automatic({.max_F_evals = 40}));
  EXPECT_FALSE(few.solved());
  EXPECT_LT(few.stats.F_evals, 40 + 60);  // a search is not interrupted
  EXPECT_LT(few.stats.F_evals, solve(*mcp, vec({1}), automatic()).stats.F_evals);
}

// F that answers otherwise each time: an attempt may believe it has a solution that the judge does not find. Catches a
// verdict without words.
TEST(Auto, WhatIsNotConfirmedIsNotSolved) {
  int calls = 0;
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [&calls](double x) { return ++calls % 4 == 0 ? 1e-12 : x - 1 + 1e-3; },
      [](double) { return 1; }));
  const Result result = solve(*mcp, vec({5}), automatic());
  EXPECT_TRUE(result.solved() || !result.message.starts_with(";")) << result;
  EXPECT_TRUE(result.solved() || result.message.find("natural residual") > 5) << result;
}

// F(x) - J x overflows at (700, 1e100) where F and J do not. Catches an exception out of a solve, which would cost auto
// its other methods.
TEST(Auto, OverflowOfALinearisedProblemIsAStatus) {
  const auto mcp = make_mcp(support::dense(
      "overflow", {Vec::Constant(2, -infinity), Vec::Constant(2, infinity)},
      [](const Vec& x) {
        return vec({std::exp(x[0]) + x[1] - 2, x[1] * x[1] * x[1] - x[0]});
      },
      [](const Vec& x) {
        support::Dense J(2, 2);
        J << std::exp(x[0]), 1, -1, 3 * x[1] * x[1];
        return J;
      }));
  for (const Preset& preset : presets()) {
    Result result;
    EXPECT_NO_THROW(result = solve(*mcp, vec({700, 1e100}), preset.method)) << preset.name;
    EXPECT_FALSE(result.message.empty()) << preset.name;
  }
}

// Psi overflows far away; its gradient, infinite, is not zero.
TEST(Auto, OverflowOfAMeritIsNoStationaryPoint) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double x) { return x - 1; }, [](double) { return 1; }));
  for (const CFunction& c : cfunctions()) {
    const Result result = solve(*mcp, vec({1e160}), SemismoothNewton{.cfunction = c});
    EXPECT_NE(result.status, Status::StationaryPoint) << c.name << ": " << result;
  }
}

TEST(Auto, StopsWhenAsked) {
  const auto mcp = make_mcp(support::billups());
  for (int last = 0; last < 12; ++last) {
    int seen = 0;
    const Result result = solve(*mcp, vec({0}), automatic(),
                                [&](const Iteration&) { return seen++ == last ? Next::Stop : Next::Continue; });
    EXPECT_TRUE(result.status == Status::Interrupted || result.solved()) << result;
    EXPECT_LE(seen, last + 2) << "records after the stop";
  }
}

// Rounding leaves 1e-16 of the data: a residual of 1e-8 cannot be had where q is 1e12. That is said, in one attempt.
TEST(Auto, ToleranceOfBadlyScaledAffineProblems) {
  lcp::AffineMcp problem{
      .M = SpMat(3, 3), .q = vec({-1e12, 3e11, -7e11}), .box = {Vec::Zero(3), Vec::Constant(3, infinity)}};
  problem.M.insert(0, 0) = 3.3;
  problem.M.insert(0, 1) = 0.7;
  problem.M.insert(1, 1) = 1.1;
  problem.M.insert(2, 2) = 2.7;
  problem.M.insert(2, 0) = 0.1;
  problem.M.makeCompressed();
  const Result result = solve(*make_affine_mcp(problem, "large"), Vec::Zero(3), automatic());
  EXPECT_EQ(result.status, Status::SolvedToRounding) << result;
  EXPECT_EQ(result.stats.restarts, 0);
  EXPECT_LE(result.residual.natural, 1e-3);
}

}  // namespace
}  // namespace perp::ncp
