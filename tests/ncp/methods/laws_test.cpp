// SPDX-License-Identifier: Apache-2.0
/// Laws of all methods of Newton's kind on problems with known solutions, in all of its variants. De Luca, Facchinei
/// & Kanzow 1996; Josephy 1979; Robinson 1992; Ralph 1994; Dirkse & Ferris 1995; Chen & Mangasarian 1996; Chen & Xiu
/// 1999.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::expect_solution;
using support::expect_solved;
using support::josephy_variants;
using support::path_variants;
using support::Random;
using support::semismooth_variants;
using support::smoothing_variants;
using support::Variants;
using support::vec;

Variants all_of(const std::vector<Variants>& lists) {
  Variants all;
  for (const Variants& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

Variants every() {
  return all_of({semismooth_variants(),
                 josephy_variants(),
                 path_variants(),
                 smoothing_variants(),
                 smoothing_variants(false),
                 {{"interior", InteriorPoint{}},
                  {"interior, no finish", InteriorPoint{.finish = false}},
                  {"min, Newton", MinNewton{}},
                  {"min, NE/SQP", MinNewton{.direction = MinNewton::Direction::ConvexQp}}}});
}

/// log x = 0 and sqrt x = 1/2, in the box x >= 0: Newton's step from far leads below 0.
std::vector<std::pair<Functions, double>> with_domains() {
  return {{support::scalar(
               0, infinity, [](double x) { return std::log(x); }, [](double x) { return 1 / x; }),
           1},
          {support::scalar(
               0, infinity, [](double x) { return std::sqrt(x) - 0.5; }, [](double x) { return 0.5 / std::sqrt(x); }),
           0.25}};
}

// Catches a method that fails on the smallest classics: singular Jacobians or linearised problems without a solution at
// some starts, a degenerate solution, where the residual tells half the digits only.
TEST(MethodLaws, KojimaShindoAndJosephyFromEightStarts) {
  for (const bool josephy : {false, true}) {
    const auto mcp = make_mcp(support::kojima_shindo(josephy));
    for (const auto& [label, method] : all_of({semismooth_variants(), josephy_variants(), path_variants()}))
      for (const Vec& x0 : support::kojima_shindo_starts()) {
        const Result result = expect_solved(*mcp, x0, method, label);
        EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << label << result.x.transpose();
      }
  }
}

// Every kind of interval, solutions at lower, upper and no bounds, the same with F_i = 0 at most of them. Catches a
// wrong sign for upper bounds, in Phi, Phi_mu or the active set, fixed variables that move, free ones that do not.
TEST(MethodLaws, FindPlantedSolutionsInMixedBoxes) {
  Random random(1);
  for (int k = 0; k < 40; ++k) {
    const double degenerate = k % 3 == 0 ? 0.8 : 0;
    const auto [functions, solution] = support::planted(1 + k % 30, degenerate, random);
    const auto mcp = make_mcp(functions);
    const Vec x0 = 3 * random.normals(1 + k % 30);
    for (const auto& [label, method] : every())
      expect_solution(*mcp, x0, method, solution, degenerate > 0 ? 1e-3 : 1e-6, label);
  }
}

// x_3 = 10 at its upper bound (Hock & Schittkowski 1981, problem 34).
TEST(MethodLaws, ActiveUpperBoundOfHs34) {
  const auto mcp = make_mcp(support::hs34());
  for (const auto& [label, method] : every())
    expect_solution(*mcp, vec({0, 1.05, 2.9, 0, 0}), method, support::hs34_solution(), 1e-6, label);
}

// F undefined below 0, F' infinite at 0, where the bounds are and linearised problems put variables (Harker 1988). From
// 100 the first steps leave the domain, and PATH 4.7 fails.
TEST(MethodLaws, Nash10) {
  const auto mcp = make_mcp(support::nash10());
  for (const auto& [label, method] : all_of({semismooth_variants(),
                                             josephy_variants(),
                                             path_variants(),
                                             smoothing_variants(),
                                             {{"interior", InteriorPoint{}}}}))
    for (const double x0 : {1.0, 10.0, 100.0})
      expect_solution(*mcp, Vec::Constant(10, x0), method, support::nash10_solution(), 1e-6, label);
}

// Catches a step that is given up, or taken, where F is not defined.
TEST(MethodLaws, SolveWhereStepsLeaveTheDomain) {
  for (const auto& [functions, solution] : with_domains())
    for (const auto& [label, method] : every())
      expect_solution(*make_mcp(functions), vec({20}), method, vec({solution}), 1e-6, label);
}

// The same: the step is shortened.
TEST(MethodLaws, ShortenStepsThatLeaveTheDomain) {
  for (const auto& [functions, solution] : with_domains())
    for (const auto& [label, method] : all_of({semismooth_variants(), josephy_variants()})) {
      std::vector<Iteration> records;
      expect_solved(*make_mcp(functions), vec({20}), method, label, record(records));
      ASSERT_GE(records.size(), 2U) << label;
      EXPECT_GT(records[1].backtracks, 0) << label;
      EXPECT_LT(records[1].step, 1) << label;
      EXPECT_GT(records[1].step, 0) << label;
    }
}

// Near R-regular solutions r_{k+1} <= C r_k^2 (De Luca, Facchinei & Kanzow 1996, theorem 4.2 b; Josephy 1979),
// smoothing with the active set near strictly complementary ones (Chen & Mangasarian 1996, theorem 4.2; Chen & Xiu
// 1999): log r_{k+1} / log r_k is near 2. Catches an element of H, a J or a linearisation that is a little wrong, a
// proximal term that stays, an active-set system without J_IA d_A.
TEST(MethodLaws, ConvergeQuadratically) {
  struct Law {
    Variants variants;
    double degenerate, distance, below;
  };
  for (const Law& law : {Law{all_of({semismooth_variants(), josephy_variants()}), 0.5, 0.05, 1e-3},
                         Law{smoothing_variants(), 0, 0.3, 1e-1}})
    for (const auto& [label, method] : law.variants) {
      Random random(2);
      int measured = 0;
      for (int k = 0; k < 12; ++k) {
        const auto [functions, solution] = support::planted(20, k % 2 == 0 ? law.degenerate : 0, random);
        const Vec x0 = solution + law.distance * random.normals(20);
        std::vector<Iteration> records;
        expect_solved(*make_mcp(functions), x0, method, label, record(records));
        const double order = support::last_order(records, law.below);
        if (order == 0) continue;
        ++measured;
        EXPECT_GT(order, 1.5) << label;
      }
      EXPECT_GE(measured, 3) << label;
    }
}

// Catches loops that count on a first variable, and fixed ones whose F has a say.
TEST(MethodLaws, NoVariablesAndOne) {
  const auto none = make_mcp(support::affine({.M = SpMat(0, 0), .q = Vec(0), .box = Box::free(0)}));
  const auto one = make_mcp(support::scalar(
      -1, 2, [](double x) { return x - 5; }, [](double) { return 1; }));
  const auto fixed = make_mcp(support::scalar(
      3, 3, [](double x) { return std::log(x) - 5; }, [](double x) { return 1 / x; }));
  for (const auto& [label, method] : every()) {
    EXPECT_EQ(expect_solved(*none, Vec(0), method, label).stats.iterations, 0) << label;
    expect_solution(*one, vec({-7}), method, vec({2}), 1e-8, label);
    expect_solution(*fixed, vec({1}), method, vec({3}), 1e-8, label);
  }
}

// The iterates of these methods are points of the box. Catches F asked for outside, where models need not be meant.
TEST(MethodLaws, StayInTheBox) {
  Random random(5);
  for (int k = 0; k < 10; ++k) {
    auto [functions, solution] = support::planted(15, 0.3, random);
    functions.F = [F = functions.F, box = functions.box](In x, Out out) {
      EXPECT_EQ(Vec(x), lcp::project(box, x));
      return F(x, out);
    };
    const auto mcp = make_mcp(functions);
    const Vec x0 = 5 * random.normals(15);
    for (const auto& [label, method] : all_of({josephy_variants(), path_variants()}))
      expect_solution(*mcp, x0, method, solution, 1e-3, label);
  }
}

}  // namespace
}  // namespace perp::ncp
