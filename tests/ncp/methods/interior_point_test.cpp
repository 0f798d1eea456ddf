// SPDX-License-Identifier: Apache-2.0
/// InteriorPoint by its behaviour: book examples, boxes of every kind, domains, statuses, the order at the end, the
/// hook.
#include "ncp/methods/interior_point.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::expect_solution;
using support::expect_solved;
using support::nan;
using support::Random;
using support::vec;
using testing::HasSubstr;
using testing::Optional;

// Josephy 1979; Kojima & Shindo 1986, whose first solution is degenerate. From (100, 100, 100, 100) both, though J is
// no P0-matrix on the way. Catches a wrong corrector, and restarts that lose the best point.
TEST(InteriorPoint, KojimaShindoAndJosephy) {
  for (const bool josephy : {false, true}) {
    const auto mcp = make_mcp(support::kojima_shindo(josephy));
    const auto starts = support::kojima_shindo_starts();
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {  // from the last one it is stuck on Kojima & Shindo's
      const Result result = expect_solved(*mcp, starts[k], InteriorPoint{}, "start " + std::to_string(k));
      EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << result.x.transpose();
    }
  }
}

// F is a gradient of a convex function, so the problem is monotone, and the interval of x_1 has a solution set of its
// own: 0 <= x_1 <= 1 with F_1 = 0. Catches steps that vanish where the solution is not unique.
TEST(InteriorPoint, SolutionsThatAreNotIsolated) {
  const auto mcp = make_mcp(support::dense(
      "flat", {vec({0, -infinity}), vec({1, infinity})},
      [](const Vec& x) {
        return vec({0, 2 * x[1] - 1});
      },
      [](const Vec&) {
        support::Dense J = support::Dense::Zero(2, 2);
        J(1, 1) = 2;
        return J;
      }));
  const Result result = expect_solved(*mcp, vec({7, 7}), InteriorPoint{});
  EXPECT_NEAR(result.x[1], 0.5, 1e-8);
}

// log x - 1 = 0 from 1e-3 in (0, inf) declared as free: Newton's first step leads to negative x, where F is NaN.
// Catches a NaN that is taken for a small residual.
TEST(InteriorPoint, NanShortensTheStep) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::log(x) - 1; }, [](double x) { return 1 / x; }));
  expect_solution(*mcp, vec({20}), InteriorPoint{}, vec({std::exp(1.0)}), 1e-7);
  const auto nowhere = make_mcp(support::scalar(
      0, infinity, [](double x) { return x == 1 ? -1 : nan; }, [](double) { return 1; }));
  EXPECT_EQ(solve(*nowhere, vec({1}), InteriorPoint{}).status, Status::EvaluationFailed);
  EXPECT_EQ(solve(*nowhere, vec({2}), InteriorPoint{}).status, Status::EvaluationFailed);
}

// With the active set: quadratic near strictly complementary solutions. Without it: superlinear, for to_boundary
// near 1. Catches a system without the cross terms J_IA d_A, and a tau that falls by a constant factor only.
TEST(InteriorPoint, ConvergesQuadratically) {
  Random random(12);
  int measured = 0, finished = 0;
  for (int k = 0; k < 12; ++k) {
    const auto [functions, solution] = support::planted(20, 0, random);
    std::vector<Iteration> records;
    expect_solved(*make_mcp(functions), solution + 0.3 * random.normals(20), InteriorPoint{}, "", record(records));
    finished += std::any_of(records.begin(), records.end(), [](const Iteration& it) { return it.kind == 'S'; });
    const double order = support::last_order(records, 1e-1);
    if (order == 0) continue;
    ++measured;
    EXPECT_GT(order, 1.5);
  }
  EXPECT_GE(measured, 3);
  EXPECT_GE(finished, 8);  // the others end on the path in as many steps
}

/// e^x_i - x_{i-1} / 4 - b_i in n rows, 0 <= x, which are free at the solution but for each tenth.
Functions cycle_of_exponentials(Index n) {
  Functions f;
  f.box = {Vec::Zero(n), Vec::Constant(n, infinity)};
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    entries.emplace_back(i, (i + n - 1) % n, -0.25);
  }
  f.pattern.resize(n, n);
  f.pattern.setFromTriplets(entries.begin(), entries.end());
  f.F = [n](In x, Out F) {
    for (Index i = 0; i < n; ++i) F[i] = std::exp(x[i]) - x[(i + n - 1) % n] / 4 - (i % 10 == 0 ? 0.5 : 3.0);
    return true;
  };
  f.J = [pattern = f.pattern](In x, SpMat& J) {
    J = pattern;
    for (Index j = 0; j < x.size(); ++j) J.coeffRef(j, j) = std::exp(x[j]);
    return true;
  };
  return f;
}

// Shamanskii 1967: with the factors of the step before, as long as each step gains a digit. Of small problems not, for
// their last step is worth its digits. Catches factorizations for each of the last steps.
TEST(InteriorPoint, LargeProblemsEndByChordSteps) {
  const Index large = 2400;
  const Result result =
      expect_solved(*make_mcp(cycle_of_exponentials(large)), Vec::Constant(large, 2.0), InteriorPoint{});
  EXPECT_GT(result.stats.chord_steps, 0);
  EXPECT_LE(result.stats.factorizations + result.stats.chord_steps, result.stats.iterations + 1);  // one is the start's
  const Index small = 200;
  EXPECT_EQ(expect_solved(*make_mcp(cycle_of_exponentials(small)), Vec::Constant(small, 2.0), InteriorPoint{})
                .stats.chord_steps,
            0);
}

// The records: the first is the start, tau falls to nothing, x is strictly inside until the active set decides.
TEST(InteriorPoint, StaysInsideWhileTauFalls) {
  const auto mcp = make_mcp(support::kojima_shindo(true));
  std::vector<double> taus;
  const Observer inside = [&](const Iteration& it) {
    if (it.kind == 'N') {
      EXPECT_GT(it.x->minCoeff(), 0);
      taus.push_back(it.mu);
    }
    return Next::Continue;
  };
  expect_solved(*mcp, Vec::Zero(4), InteriorPoint{.finish = false}, "", inside);
  ASSERT_GE(taus.size(), 3U);
  EXPECT_LT(taus.back(), 1e-6);
}

// The hook: 0 <= x _|_ x - 1 + delta >= 0 with delta = tau / 10 made zero by the path. Its solution for delta = 0 is 1,
// for the first delta it is not. Catches a hook that is not called, and F that is not evaluated again after it.
TEST(InteriorPoint, AProblemMayFollowTau) {
  double delta = 0.5;
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [&delta](double x) { return x * x * x - 1 + delta; }, [](double x) { return 3 * x * x; }));
  int calls = 0;
  InteriorPoint method{.finish = false};
  method.follow = [&](double tau) {
    ++calls;
    delta = 0.1 * tau;
  };
  const Result result = expect_solved(*mcp, vec({3}), method);
  EXPECT_GE(calls, 3);
  EXPECT_LT(delta, 1e-7);
  EXPECT_NEAR(result.x[0], 1, 1e-7);
}

// F = -1 on x >= 0 and F = (-1, 1) have no solution: told as no progress, with the best point and advice. Catches runs
// to the limit of iterations and false claims.
TEST(InteriorPoint, WithoutASolution) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double) { return -1; }, [](double) { return 0; }));
  const Result result = solve(*mcp, vec({1}), InteriorPoint{});
  EXPECT_EQ(result.status, Status::NoProgress) << result;
  EXPECT_TRUE(result.x.allFinite());
  EXPECT_NE(result.advice, "");
  EXPECT_LT(result.stats.iterations, 400);
}

// Limits of iterations, evaluations and time, and an observer that stops.
TEST(InteriorPoint, Limits) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Vec x0 = Vec::Constant(4, 100);
  const auto status = [&](const Stop& stop, const Observer& observer = {}) {
    return solve(*mcp, x0, InteriorPoint{.stop = stop}, observer).status;
  };
  EXPECT_EQ(status({.max_iterations = 0}), Status::IterationLimit);
  EXPECT_EQ(status({.max_iterations = 2}), Status::IterationLimit);
  EXPECT_EQ(status({.max_F_evals = 3}), Status::IterationLimit);
  EXPECT_EQ(status({.max_time = std::chrono::duration<double>(0)}), Status::TimeLimit);
  EXPECT_EQ(status({}, [](const Iteration& it) { return it.k == 2 ? Next::Stop : Next::Continue; }),
            Status::Interrupted);
  const std::atomic<bool> now{true};
  EXPECT_EQ(status({.interrupt = &now}), Status::Interrupted);
  EXPECT_EQ(status({}), Status::Solved);
}

// A J of zeros everywhere and no bounds: no proximal term makes a Newton step of use.
TEST(InteriorPoint, SingularEverywhere) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double) { return 1; }, [](double) { return 0; }));
  const Result result = solve(*mcp, vec({0}), InteriorPoint{});
  EXPECT_FALSE(result.solved());
  EXPECT_EQ(result.residual.natural, 1);
}

// Fixed variables only, and no variables at all.
TEST(InteriorPoint, NothingToDo) {
  const auto fixed = make_mcp(support::scalar(
      2, 2, [](double) { return 5; }, [](double) { return 0; }));
  EXPECT_EQ(expect_solved(*fixed, vec({0}), InteriorPoint{}).x[0], 2);
  const auto none = make_mcp(support::dense(
      "none", Box::free(0), [](const Vec&) { return Vec(0); }, [](const Vec&) { return support::Dense(0, 0); }));
  expect_solved(*none, Vec(0), InteriorPoint{});
}

// Every option that makes no sense is refused with its name and value.
TEST(InteriorPoint, RefusesOptions) {
  const auto why = [](auto change) {
    InteriorPoint method;
    change(method);
    return invalid(method);
  };
  using I = InteriorPoint;
  EXPECT_EQ(invalid(I{}), std::nullopt);
  EXPECT_THAT(why([](I& m) { m.stop.tol = 0; }), Optional(HasSubstr("tol")));
  EXPECT_THAT(why([](I& m) { m.to_boundary = 1; }), Optional(HasSubstr("to_boundary is 1")));
  EXPECT_THAT(why([](I& m) { m.neighbourhood = nan; }), Optional(HasSubstr("neighbourhood is nan")));
  EXPECT_THAT(why([](I& m) { m.growth = 1; }), Optional(HasSubstr("growth is 1")));
  EXPECT_THAT(why([](I& m) { m.restarts = -2; }), Optional(HasSubstr("restarts is -2")));
  EXPECT_THAT(why([](I& m) { m.patience = 0; }), Optional(HasSubstr("patience is 0")));
}

}  // namespace
}  // namespace perp::ncp
