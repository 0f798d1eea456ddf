// SPDX-License-Identifier: Apache-2.0
/// Josephy 1979; Robinson 1992: the method by its behaviour on problems with known solutions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::expect_solution;
using support::expect_solved;
using support::Random;
using support::vec;

std::vector<support::NamedMethod> josephy_variants() {
  return {{"regular start", NewtonJosephy{}},
          {"ray start", NewtonJosephy{.lemke = {.start = lcp::LemkeStart::Ray}}},
          {"KLU", NewtonJosephy{.lemke = {.basis = {.lu = lcp::LuBackend::Klu}}}},
          {"monotone search, escapes", escaping(NewtonJosephy{.search = {.memory = 1}})}};
}

// Catches a method that fails on the smallest classics: subproblems without a solution at some starts, a degenerate
// solution.
TEST(NewtonJosephy, KojimaShindoAndJosephyFromEightStarts) {
  for (const bool josephy : {false, true}) {
    const auto mcp = make_mcp(support::kojima_shindo(josephy));
    for (const auto& [label, method] : josephy_variants())
      for (const Vec& x0 : support::kojima_shindo_starts()) {
        const Result result = expect_solved(*mcp, x0, method, label);
        EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << label << result.x.transpose();
      }
  }
}

// As in tests/ncp/methods/semismooth_newton_test.cpp.
TEST(NewtonJosephy, FindsPlantedSolutionsInMixedBoxes) {
  Random random(1);
  for (int k = 0; k < 30; ++k) {
    const double degenerate = k % 3 == 0 ? 0.8 : 0;
    const auto [functions, solution] = support::planted(1 + k, degenerate, random);
    const auto mcp = make_mcp(functions);
    for (const auto& [label, method] : josephy_variants())
      expect_solution(*mcp, 3 * random.normals(1 + k), method, solution, degenerate > 0 ? 1e-3 : 1e-6, label);
  }
}

// x_3 = 10 at its upper bound (Hock & Schittkowski 1981, problem 34).
TEST(NewtonJosephy, ActiveUpperBoundOfHs34) {
  const auto mcp = make_mcp(support::hs34());
  for (const auto& [label, method] : josephy_variants())
    expect_solution(*mcp, vec({0, 1.05, 2.9, 0, 0}), method, support::hs34_solution(), 1e-6, label);
}

// F' infinite at the bounds, where subproblems put variables (Harker 1988).
TEST(NewtonJosephy, Nash10) {
  const auto mcp = make_mcp(support::nash10());
  for (const auto& [label, method] : josephy_variants())
    for (const double x0 : {1.0, 10.0, 100.0})
      expect_solution(*mcp, Vec::Constant(10, x0), method, support::nash10_solution(), 1e-6, label);
}

// The linearised problem's solution from x = 20 is the bound 0, where log and the derivative of sqrt are not defined.
TEST(NewtonJosephy, ShortensStepsThatLeaveTheDomain) {
  const auto logarithm = make_mcp(support::scalar(
      0, infinity, [](double x) { return std::log(x); }, [](double x) { return 1 / x; }));
  const auto root = make_mcp(support::scalar(
      0, infinity, [](double x) { return std::sqrt(x) - 0.5; }, [](double x) { return 0.5 / std::sqrt(x); }));
  for (const auto& [label, method] : josephy_variants())
    for (const Mcp* mcp : {logarithm.get(), root.get()}) {
      std::vector<Iteration> records;
      expect_solved(*mcp, vec({20}), method, label, record(records));
      ASSERT_GE(records.size(), 2U) << label;
      EXPECT_GT(records[1].backtracks, 0) << label;
      EXPECT_LT(records[1].step, 1) << label;
      EXPECT_GT(records[1].step, 0) << label;
    }
}

// The linearisation of an affine problem is the problem. Catches a q that is not F - J x, or a step that is damped.
TEST(NewtonJosephy, SolvesAffineProblemsInOneStep) {
  Random random(2);
  for (int k = 0; k < 30; ++k) {
    const Index n = 2 + k;
    const auto mcp =
        make_mcp(support::affine({.M = k % 2 == 0 ? support::p_matrix(n, 2, random) : support::h_plus(n, 3, random),
                                  .q = 5 * random.normals(n),
                                  .box = support::mixed_box(n, random)}));
    for (const auto& [label, method] : josephy_variants()) {
      const Result result = expect_solved(*mcp, random.normals(n), method, label);
      EXPECT_LE(result.stats.iterations, 1) << label << ", n = " << n;
    }
  }
}

// Quadratic near strongly regular solutions (Josephy 1979). Catches a linearisation that is a little wrong, or a
// proximal term that stays.
TEST(NewtonJosephy, ConvergesQuadratically) {
  Random random(3);
  for (const auto& [label, method] : josephy_variants()) {
    int measured = 0;
    for (int k = 0; k < 10; ++k) {
      const auto [functions, solution] = support::planted(20, k % 2 == 0 ? 0.5 : 0, random);
      std::vector<Iteration> records;
      expect_solved(*make_mcp(functions), solution + 0.05 * random.normals(20), method, label, record(records));
      const double order = support::last_order(records);
      if (order == 0) continue;
      ++measured;
      EXPECT_GT(order, 1.5) << label;
    }
    EXPECT_GE(measured, 3) << label;
  }
}

TEST(NewtonJosephy, NoVariablesAndOne) {
  const auto none = make_mcp(support::affine({.M = SpMat(0, 0), .q = Vec(0), .box = Box::free(0)}));
  const auto one = make_mcp(support::scalar(
      -1, 2, [](double x) { return x - 5; }, [](double) { return 1; }));
  for (const auto& [label, method] : josephy_variants()) {
    EXPECT_EQ(expect_solved(*none, Vec(0), method, label).stats.iterations, 0);
    expect_solution(*one, vec({-7}), method, vec({2}), 0, label);
  }
}

// 10^4 unknowns from the solution of the double load; one dense matrix of them would take 800 MB.
TEST(NewtonJosephy, ObstacleProblemStaysSparse) {
  const double before = support::peak_megabytes();
  const Result near = solve(*make_mcp(support::obstacle(100, 2)), Vec::Zero(10000), SemismoothNewton{});
  const Result result = expect_solved(*make_mcp(support::obstacle(100)), near.x, NewtonJosephy{});
  EXPECT_EQ(result.stats.iterations, 1);
  EXPECT_GT(result.stats.pivots, 1);
  EXPECT_LT(support::peak_megabytes() - before, 250);
}

// Equal solutions by other ways: the two methods share nothing but F and the line search.
TEST(NewtonJosephy, AgreesWithSemismoothNewtonOnTheObstacleProblem) {
  const auto mcp = make_mcp(support::obstacle(20));
  const Result a = expect_solved(*mcp, Vec::Zero(400), NewtonJosephy{.stop = {.tol = 1e-12}});
  const Result b = expect_solved(*mcp, Vec::Zero(400), SemismoothNewton{.stop = {.tol = 1e-12}});
  EXPECT_LE((a.x - b.x).lpNorm<Eigen::Infinity>(), 1e-9);
}

// The iterates of this method never leave the box. Catches F asked for outside, where models need not be meant.
TEST(NewtonJosephy, StaysInTheBox) {
  Random random(4);
  for (int k = 0; k < 10; ++k) {
    auto [functions, solution] = support::planted(15, 0.3, random);
    functions.F = [F = functions.F, box = functions.box](In x, Out out) {
      EXPECT_EQ(Vec(x), lcp::project(box, x));
      return F(x, out);
    };
    expect_solution(*make_mcp(functions), 5 * random.normals(15), NewtonJosephy{}, solution, 1e-3);
  }
}

}  // namespace
}  // namespace perp::ncp
