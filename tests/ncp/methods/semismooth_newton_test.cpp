// SPDX-License-Identifier: Apache-2.0
/// De Luca, Facchinei & Kanzow 1996: the method by its behaviour on problems with known solutions.
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

/// With both C-functions and the linear algebra of each library.
std::vector<support::NamedMethod> semismooth_variants() {
  return {{"Fischer-Burmeister", SemismoothNewton{}},
          {"min, escapes", escaping(SemismoothNewton{.cfunction = natural_min()})},
          {"Fischer-Burmeister, KLU", SemismoothNewton{.lu = lcp::LuBackend::Klu}},
          {"monotone search, escapes", escaping(SemismoothNewton{.search = {.memory = 1}})}};
}

// Catches a method that fails on the smallest classics: singular Jacobians at some starts, a degenerate solution.
TEST(SemismoothNewton, KojimaShindoAndJosephyFromEightStarts) {
  for (const bool josephy : {false, true}) {
    const auto mcp = make_mcp(support::kojima_shindo(josephy));
    for (const auto& [label, method] : semismooth_variants())
      for (const Vec& x0 : support::kojima_shindo_starts()) {
        const Result result = expect_solved(*mcp, x0, method, label);
        // At the degenerate solution the residual tells half the digits only.
        EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << label << result.x.transpose();
      }
  }
}

// Every kind of interval, solutions at lower, upper and no bounds, the same with F_i = 0 at most of them. Catches a
// wrong sign for upper bounds, fixed variables that move, free ones that do not.
TEST(SemismoothNewton, FindsPlantedSolutionsInMixedBoxes) {
  Random random(1);
  for (int k = 0; k < 30; ++k) {
    const double degenerate = k % 3 == 0 ? 0.8 : 0;
    const auto [functions, solution] = support::planted(1 + k, degenerate, random);
    const auto mcp = make_mcp(functions);
    for (const auto& [label, method] : semismooth_variants())
      expect_solution(*mcp, 3 * random.normals(1 + k), method, solution, degenerate > 0 ? 1e-3 : 1e-6, label);
  }
}

// x_3 = 10 at its upper bound (Hock & Schittkowski 1981, problem 34).
TEST(SemismoothNewton, ActiveUpperBoundOfHs34) {
  const auto mcp = make_mcp(support::hs34());
  for (const auto& [label, method] : semismooth_variants())
    expect_solution(*mcp, vec({0, 1.05, 2.9, 0, 0}), method, support::hs34_solution(), 1e-6, label);
}

// min's own merit is not differentiable: full Newton steps are taken where they halve ||Phi|| (De Luca, Facchinei &
// Kanzow 2000), others are searched on the Fischer-Burmeister merit. atan(x) = 0: from 0.5 Newton's steps shrink |F| at
// least fivefold each, one evaluation a step; from 1.3 the first goes to -1.16, which is no half, but descends;
// from 1.5 Newton's method diverges. Catches: full steps that do not halve taken for good, or none taken without a
// search.
TEST(SemismoothNewton, MinTakesFullStepsThatHalvePhi) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::atan(x); }, [](double x) { return 1 / (1 + x * x); }));
  const auto first_step = [&mcp](double x0, Result& result) {
    Iteration first;
    result = solve(*mcp, vec({x0}), SemismoothNewton{.cfunction = natural_min()}, [&first](const Iteration& it) {
      if (it.k == 1) first = it;
      return Next::Continue;
    });
    EXPECT_TRUE(result.solved()) << result;
    return first;
  };
  Result result;
  const Iteration halving = first_step(0.5, result);
  EXPECT_EQ(halving.F_evals, 2);
  EXPECT_NEAR(halving.merit, 0.5 * std::pow(std::atan(0.5 - std::atan(0.5) * 1.25), 2), 1e-15);
  EXPECT_EQ(result.stats.F_evals, 1 + result.stats.iterations + 1);  // the last one is the judge's
  const Iteration descending = first_step(1.3, result);
  EXPECT_EQ(descending.step, 1);
  EXPECT_EQ(descending.F_evals, 3);  // tried, and then searched
  EXPECT_LT(first_step(1.5, result).step, 1);
}

// F undefined below 0, F' infinite at 0, where the bounds are (Harker 1988). From 100 the first steps leave the domain.
TEST(SemismoothNewton, Nash10) {
  const auto mcp = make_mcp(support::nash10());
  for (const auto& [label, method] : semismooth_variants())
    for (const double x0 : {1.0, 10.0, 100.0})
      expect_solution(*mcp, Vec::Constant(10, x0), method, support::nash10_solution(), 1e-6, label);
}

/// log x = 0 and sqrt x = 1/2, in the box x >= 0: Newton's step from far leads below 0.
std::vector<Functions> with_domains() {
  return {support::scalar(
              0, infinity, [](double x) { return std::log(x); }, [](double x) { return 1 / x; }),
          support::scalar(
              0, infinity, [](double x) { return std::sqrt(x) - 0.5; }, [](double x) { return 0.5 / std::sqrt(x); })};
}

// Catches a step that is given up, or taken, where F is not defined: it is shortened.
TEST(SemismoothNewton, ShortensStepsThatLeaveTheDomain) {
  for (const Functions& functions : with_domains()) {
    const auto mcp = make_mcp(functions);
    for (const auto& [label, method] : semismooth_variants()) {
      std::vector<Iteration> records;
      expect_solved(*mcp, vec({20}), method, label, record(records));
      ASSERT_GE(records.size(), 2U) << label;
      EXPECT_GT(records[1].backtracks, 0) << label;
      EXPECT_LT(records[1].step, 1) << label;
      EXPECT_GT(records[1].step, 0) << label;
    }
  }
}

// Near R-regular solutions r_{k+1} <= C r_k^2 (their theorem 4.2 b), also without strict complementarity if regular:
// log r_{k+1} / log r_k is near 2. Catches an element of H or a J that is a little wrong, which leaves linear
// convergence.
TEST(SemismoothNewton, ConvergesQuadratically) {
  Random random(2);
  for (const auto& [label, method] : semismooth_variants()) {
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

TEST(SemismoothNewton, NoVariablesAndOne) {
  const auto none = make_mcp(support::affine({.M = SpMat(0, 0), .q = Vec(0), .box = Box::free(0)}));
  const auto one = make_mcp(support::scalar(
      -1, 2, [](double x) { return x - 5; }, [](double) { return 1; }));
  for (const auto& [label, method] : semismooth_variants()) {
    EXPECT_EQ(expect_solved(*none, Vec(0), method, label).stats.iterations, 0);
    expect_solution(*one, vec({-7}), method, vec({2}), 1e-8, label);
  }
}

// 10^4 unknowns; one dense matrix of them would take 800 MB.
TEST(SemismoothNewton, ObstacleProblemStaysSparse) {
  const double before = support::peak_megabytes();
  const auto mcp = make_mcp(support::obstacle(100));
  const Result result = expect_solved(*mcp, Vec::Zero(10000), SemismoothNewton{});
  EXPECT_LT(result.stats.iterations, 30);
  EXPECT_LT(support::peak_megabytes() - before, 250);
}

// H is singular all along: two equal rows, then a row of zeros. Levenberg-Marquardt steps go on where Newton's cannot.
TEST(SemismoothNewton, TakesLevenbergMarquardtStepsWhereHIsSingular) {
  const SpMat M = support::matrix({{1, 1}, {1, 1}});
  const auto mcp = make_mcp(support::affine({.M = M, .q = vec({-2, -2}), .box = Box::free(2)}));
  for (const auto& [label, method] : semismooth_variants()) {
    std::vector<Iteration> records;
    const Result result = expect_solved(*mcp, vec({10, -30}), method, label, record(records));
    EXPECT_NEAR(result.x.sum(), 2, 1e-8) << label;
    ASSERT_GE(records.size(), 2U);
    EXPECT_EQ(records[1].kind, 'L') << label;
    EXPECT_GT(records[1].prox, 0) << label;
  }
}

}  // namespace
}  // namespace perp::ncp
