// SPDX-License-Identifier: Apache-2.0
/// PathSearch with its default options on every (problem, start) of the collection, and from random starts of the two
/// problems that a plain Newton method fails on.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "ncp/strategy/solve.hpp"
#include "support/collection.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using collection::Entry;
using collection::Problem;

bool known(const Problem& problem, const Vec& x) {
  for (const collection::KnownSolution& solution : problem.solutions)
    // 1e-4: x is as far as the residual's square root where the solution is degenerate
    if ((x - solution.x).lpNorm<Eigen::Infinity>() <= std::max(solution.tol, 1e-4) * (1 + solution.x.norm()))
      return true;
  return false;
}

// All solved but those that have no solution, and those never. Catches false convergence, and every change that costs a
// problem.
TEST(PathCollection, EveryStartIsSolvedOrHasNoSolution) {
  for (const Entry& entry : collection::entries()) {
    if (!support::quick(entry)) continue;
    const Problem problem = entry.make();
    for (std::size_t k = 0; k < problem.starts.size(); ++k) {
      const std::string what = std::string(entry.name) + " from start " + std::to_string(k + 1);
      const Result result = solve(*problem.mcp, problem.starts[k], path());
      if (!result.solved() && support::beyond_all(entry, k)) continue;
      if (problem.no_solution.empty()) {
        EXPECT_TRUE(result.solved()) << what << ": " << result;
        Vec F(problem.mcp->size());
        ASSERT_TRUE(problem.mcp->eval(result.x, F));
        EXPECT_LE(residual(problem.mcp->box(), result.x, F).natural, 1e-8) << what;
        EXPECT_LE(support::violation(*problem.mcp, result.x), 1e-8) << what;
        EXPECT_TRUE(!problem.solutions_complete || known(problem, result.x)) << what << ": " << result.x.transpose();
      } else {
        EXPECT_FALSE(result.solved()) << what << ": " << result;
        EXPECT_FALSE(result.message.empty()) << what;
        EXPECT_FALSE(result.advice.empty()) << what;
        EXPECT_TRUE(!problem.mcp->is_affine() || result.status == Status::Infeasible) << what << ": " << result;
        EXPECT_LE(result.stats.iterations, 500) << what;
        EXPECT_LE(result.stats.pivots, 5000) << what;
      }
    }
  }
}

/// x_i uniform in [a_i - r_i, b_i + r_i] and the box, a_i and b_i the least and greatest start, r_i = max(1, b_i -
/// a_i).
std::vector<Vec> random_starts(const Problem& problem, int count) {
  Vec low = problem.starts.front();
  Vec high = low;
  for (const Vec& x : problem.starts) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Vec reach = (high - low).cwiseMax(1);
  low = lcp::project(problem.mcp->box(), low - reach);
  high = lcp::project(problem.mcp->box(), high + reach);
  std::mt19937_64 engine(1);
  std::vector<Vec> starts;
  for (int k = 0; k < count; ++k)
    starts.emplace_back(Vec::NullaryExpr(low.size(), [&](Index i) {
      return low[i] + (high[i] - low[i]) * static_cast<double>(engine() >> 11U) * 0x1p-53;
    }));
  return starts;
}

// Plain Fischer-Burmeister Newton fails from 52 of 60 random starts of kehoe and 55 of 60 of colvdual.
TEST(PathCollection, KehoeAndColvdualFromRandomStarts) {
  for (const std::string_view name : {"kehoe", "colvdual"}) {
    const Problem problem = collection::find(name)->make();
    int k = 0;
    for (const Vec& x0 : random_starts(problem, 20))
      support::expect_solved(*problem.mcp, x0, path(), std::string(name) + " " + std::to_string(++k));
  }
}

// Colville 2, dual, from its infeasible start: J_II is singular, and a step of the crash with a proximal term leaves
// 0.9 of the merit where it promises 0.25. Catches a crash that keeps such a step and has the path begin with a term of
// its own (115 iterations, 5500 pivots and 3 restarts, beside 7 to 8 iterations from the start itself).
TEST(PathCollection, ColvdualBeginsWhereTheCrashLedNowhere) {
  const Problem problem = collection::find("colvdual")->make();
  const Result result = support::expect_solved(*problem.mcp, problem.starts[0], path());
  EXPECT_LE(result.stats.iterations, 20);
  EXPECT_LE(result.stats.pivots, 500);
  EXPECT_EQ(result.stats.restarts, 0);
}

// Hock & Schittkowski 23 (1981), and prices in a spatial equilibrium: the first basis is singular, though the crash
// took no step with a proximal term. Catches a path that begins there from artificials: three restarts and 224 pivots,
// and 963 pivots, beside 8 and 333.
TEST(PathCollection, TheFirstPathBeginsInARegularBasis) {
  const Problem small = collection::find("hs23-kkt")->make();
  const Result first = support::expect_solved(*small.mcp, small.starts[3], path());
  EXPECT_EQ(first.stats.restarts, 0);
  EXPECT_LE(first.stats.pivots, 30);
  const Problem larger = collection::find("spatial-price-own-1138")->make();
  EXPECT_LE(support::expect_solved(*larger.mcp, larger.starts[2], path()).stats.pivots, 600);
}

// The dual of Colville's second problem (Colville 1968). The first basis is singular, and paths with small terms lead
// nowhere. Catches rays between the tries of terms, and a term that is soon too small again: 154 pivots for 52.
TEST(PathCollection, ALargerTermComesBeforeRays) {
  const Problem problem = collection::find("colvdual")->make();
  EXPECT_LE(support::expect_solved(*problem.mcp, problem.starts[0], path()).stats.pivots, 100);
}

// Hock & Schittkowski 62 (1981) without a crash. After chord steps the path began in the cell of the Newton point
// before them: from there Newton and chord steps went to and fro between two points.
TEST(PathCollection, CellsAreForgottenAfterAChordStep) {
  const Problem problem = collection::find("hs62-kkt")->make();
  PathSearch method{};
  method.crash.on = false;
  for (const Vec& x0 : problem.starts) support::expect_solved(*problem.mcp, x0, method);
}

// The collection without what tries other methods: what the path search does alone. Catches restarts that hide a path
// search that does not work: most are solved by the first attempt.
TEST(PathCollection, TheFirstAttemptSolvesMost) {
  int starts = 0;
  int solved = 0;
  for (const bool crash : {true, false})
    for (const Entry& entry : collection::entries()) {
      if (entry.size > 200) continue;
      const Problem problem = entry.make();
      if (!problem.no_solution.empty()) continue;
      for (const Vec& x0 : problem.starts) {
        PathSearch method{};
        method.crash.on = crash;
        const Result result = solve(*problem.mcp, x0, method);
        ++starts;
        solved += result.solved();
        EXPECT_EQ(result.solved(), support::violation(*problem.mcp, result.x) <= 1e-8) << entry.name << ": " << result;
      }
    }
  EXPECT_GE(solved, starts * 95 / 100) << solved << " of " << starts;
}

// Without an observer of ways the kinks of an affine problem's paths are not kept, and followed once more where a
// search goes along them. Catches another way than the one that was followed: paths of three pivots mostly end before t
// = 1.
TEST(PathCollection, AnObserverChangesNothing) {
  int backtracks = 0;
  for (const Entry& entry : collection::entries()) {
    if (entry.size > 200) continue;
    const Problem problem = entry.make();
    if (!problem.mcp->is_affine()) continue;
    PathSearch method{.crash = {.on = false}};
    method.lemke.max_pivots = 3;
    for (const Vec& x0 : problem.starts) {
      const Result alone = solve(*problem.mcp, x0, method);
      const Result seen = solve(*problem.mcp, x0, method, of_ways([](const Iteration&) { return Next::Continue; }));
      EXPECT_EQ(alone.x, seen.x) << entry.name;
      EXPECT_EQ(alone.stats.iterations, seen.stats.iterations) << entry.name;
      EXPECT_EQ(alone.stats.pivots, seen.stats.pivots) << entry.name;
      EXPECT_EQ(alone.stats.backtracks, seen.stats.backtracks) << entry.name;
      backtracks += alone.stats.backtracks;
    }
  }
  EXPECT_GT(backtracks, 0);
}

}  // namespace
}  // namespace perp::ncp
