// SPDX-License-Identifier: Apache-2.0
/// Smoothing by its behaviour: both schedules, the three smoothings, mu and the active set in the records.
#include "ncp/methods/smoothing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "collection/collection.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/collection.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::expect_solution;
using support::expect_solved;
using support::Random;
using support::vec;
using testing::HasSubstr;

bool has_kind(const std::vector<Iteration>& records, char kind) {
  return std::any_of(records.begin(), records.end(), [kind](const Iteration& it) { return it.kind == kind; });
}

// Josephy 1979; Kojima & Shindo 1986, whose first solution is degenerate. The smoothing of Chen & Mangasarian from all
// starts; the other variants from those where J is no P0-matrix on the way may be stuck, so from the first.
TEST(Smoothing, KojimaShindoAndJosephy) {
  for (const bool josephy : {false, true}) {
    const auto mcp = make_mcp(support::kojima_shindo(josephy));
    for (const Vec& x0 : support::kojima_shindo_starts()) {
      const Result result = expect_solved(*mcp, x0, Smoothing{}, "smooth");
      EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << result.x.transpose();
    }
    for (const auto& [label, method] : support::smoothing_variants())
      expect_solved(*mcp, support::kojima_shindo_starts()[0], method, label);
  }
}

// The predictor alone (no active set): superlinear with mu proportional to ||Phi_0||, by Jacobian consistency. Catches
// a predictor that is never accepted, and mu that falls by a constant factor only.
TEST(Smoothing, PredictorsConvergeFastWithoutTheActiveSet) {
  Random random(3);
  int measured = 0;
  for (int k = 0; k < 12; ++k) {
    const auto [functions, solution] = support::planted(20, 0, random);
    std::vector<Iteration> records;
    const Smoothing method{.function = chks(), .schedule = SmoothingSchedule::PredictorCorrector, .finish = false};
    expect_solved(*make_mcp(functions), solution + 0.3 * random.normals(20), method, "", record(records));
    EXPECT_TRUE(has_kind(records, 'H'));
    EXPECT_FALSE(has_kind(records, 'S'));
    const double order = support::last_order(records, 1e-1);
    if (order == 0) continue;
    ++measured;
    EXPECT_GT(order, 1.3);
  }
  EXPECT_GE(measured, 3);
}

// The records: mu is at most min(r, sqrt(r)), r the residual of the iterate itself (above 1e-4 tol, where it ends), and
// never rises but at U; the last step is one of the active set, whose residual does not depend on mu. Catches a
// schedule that is not theirs.
TEST(Smoothing, MuFollowsTheResidual) {
  Random random(4);
  int finished = 0;
  for (int k = 0; k < 10; ++k) {
    const auto [functions, solution] = support::planted(30, 0, random);
    const auto mcp = make_mcp(functions);
    constexpr double tol = 1e-11;
    std::vector<Iteration> records;
    std::vector<double> residuals;
    expect_solved(*mcp, 5 * random.normals(30), Smoothing{.stop = {.tol = tol}}, "", [&](const Iteration& it) {
      records.push_back(it);
      residuals.push_back(residual(*mcp, *it.x).natural);
      return Next::Continue;
    });
    for (std::size_t i = 1; i < records.size(); ++i) {
      if (records[i].kind == 'U') continue;
      const double r = residuals[i];
      EXPECT_LE(records[i].mu, records[i - 1].mu);
      EXPECT_LE(records[i].mu, std::max(std::min(r, std::sqrt(r)) * (1 + 1e-12), 1e-4 * tol));
      EXPECT_GT(records[i].mu, 0);
    }
    finished += records.back().kind == 'S';
  }
  EXPECT_GE(finished, 8);
}

// F is defined at the start alone.
TEST(Smoothing, SaysWhereNothingIsDefined) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double x) { return x == 2 ? 1.0 : NAN; }, [](double) { return 1.0; }));
  for (const auto& [label, method] : support::smoothing_variants()) {
    const Result result = solve(*mcp, vec({2}), method);
    EXPECT_EQ(result.status, Status::EvaluationFailed) << label << ": " << result;
  }
}

// H is singular all along: two equal free rows. Levenberg-Marquardt steps go on where Newton's cannot.
TEST(Smoothing, TakesLevenbergMarquardtStepsWhereHIsSingular) {
  const SpMat M = support::matrix({{1, 1}, {1, 1}});
  const auto mcp = make_mcp(support::affine({.M = M, .q = vec({-2, -2}), .box = Box::free(2)}));
  for (const auto& [label, method] : support::smoothing_variants()) {
    std::vector<Iteration> records;
    const Result result = expect_solved(*mcp, vec({10, -30}), method, label, record(records));
    EXPECT_NEAR(result.x.sum(), 2, 1e-8) << label;
    ASSERT_GE(records.size(), 2U);
    EXPECT_EQ(records[1].kind, 'L') << label;
    EXPECT_GT(records[1].prox, 0) << label;
  }
}

// F = -1 on x >= 0 and F = x^2 + 1 on R have no solution. Catches a loop, a false "solved", and a message without the
// merit function and the raises of mu.
TEST(Smoothing, SaysThatItIsStuck) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x + 1; }, [](double x) { return 2 * x; }));
  for (const auto& [label, method] : support::smoothing_variants()) {
    const Result result = solve(*mcp, vec({0.3}), method);
    EXPECT_TRUE(result.status == Status::StationaryPoint || result.status == Status::NoProgress) << label << result;
    EXPECT_THAT(result.message, HasSubstr("mu was raised 6 times")) << label;
    EXPECT_FALSE(result.advice.empty());
    EXPECT_LT(result.stats.iterations, 400) << label;
  }
}

// Powell's badly scaled equations from start 3, and Hock & Schittkowski 62 from every start: their local minima of the
// merit function are the units'. Catches a retry that does not happen, that starts elsewhere, that scales nothing, or
// whose answer and records are in the units of the scaled problem.
TEST(Smoothing, RunsAgainOnTheScaledProblem) {
  for (const auto& [name, start] : {std::pair("powell-badly-scaled", 2), std::pair("hs62-kkt", 0)}) {
    const collection::Problem problem = collection::find(name)->make();
    const Vec x0 = problem.starts[static_cast<std::size_t>(start)];
    const Result without = solve(*problem.mcp, x0, Smoothing{});
    EXPECT_FALSE(without.solved()) << name;
    std::vector<Vec> begun;
    double last = infinity;
    const Result result = expect_solved(*problem.mcp, x0, method_of("smooth"), name, [&](const Iteration& it) {
      if (!it.attempt.empty()) begun.push_back(*it.x);
      last = it.residual;
      return Next::Continue;
    });
    EXPECT_GT(result.stats.iterations, without.stats.iterations) << name;
    ASSERT_EQ(static_cast<int>(begun.size()), result.stats.restarts) << name;
    EXPECT_LE((begun.front() - x0).lpNorm<Eigen::Infinity>(), 1e-12 * x0.lpNorm<Eigen::Infinity>()) << name;
    EXPECT_DOUBLE_EQ(last, result.residual.natural) << name;
    EXPECT_THAT(result.message, HasSubstr("after a restart: on(rescaled, smooth)")) << name;
  }
  const collection::Problem hard = collection::find("trigonometric")->make();
  Method method = method_of("smooth");
  stop(method).max_iterations = 2000;
  const Result failed = solve(*hard.mcp, hard.starts[1], method);
  EXPECT_THAT(failed.message, HasSubstr("not led to a solution either")) << failed;
}

// Billups 1995: a local minimum near 0 of the merit functions for small mu. A raised mu moves it: SMOOTH's way out is
// no proximal escape. Catches raises that do not happen; without them it stays.
TEST(Smoothing, RaisesMuWhereItIsStuck) {
  const auto mcp = make_mcp(support::billups());
  std::vector<Iteration> records;
  (void)solve(*mcp, vec({0}), Smoothing{}, record(records));
  EXPECT_TRUE(has_kind(records, 'U'));
  records.clear();
  const Result result = solve(*mcp, vec({0}), Smoothing{.restarts = 0}, record(records));
  EXPECT_FALSE(result.solved());
  EXPECT_FALSE(has_kind(records, 'U'));
}

// Statuses of limits, by one change each.
TEST(Smoothing, KeepsLimits) {
  const auto mcp = make_mcp(support::hs34());
  const Vec x0 = vec({0, 1.05, 2.9, 0, 0});
  for (const auto& [label, base] : support::smoothing_variants()) {
    auto method = std::get<Smoothing>(base);
    method.stop.max_iterations = 1;
    EXPECT_EQ(solve(*mcp, x0, method).status, Status::IterationLimit) << label;
    method.stop.max_iterations = 500;
    method.stop.max_time = std::chrono::duration<double>(0);
    EXPECT_EQ(solve(*mcp, x0, method).status, Status::TimeLimit) << label;
    const std::atomic<bool> stop = true;
    method.stop.max_time = std::chrono::duration<double>(60);
    method.stop.interrupt = &stop;
    EXPECT_EQ(solve(*mcp, x0, method).status, Status::Interrupted) << label;
  }
}

// Bad options are refused with name and value.
TEST(Smoothing, RefusesOptionsWithoutSense) {
  const auto why = [](auto change) {
    Smoothing method;
    change(method);
    return invalid(Method(method)).value_or("");
  };
  EXPECT_EQ(why([](Smoothing&) {}), "");
  EXPECT_THAT(why([](Smoothing& m) { m.patience = 0; }), HasSubstr("patience is 0"));
  EXPECT_THAT(why([](Smoothing& m) { m.function.at = nullptr; }), HasSubstr("function"));
  EXPECT_THAT(why([](Smoothing& m) { m.stop.tol = -1; }), HasSubstr("convergence_tolerance is -1"));
}

// 3600 unknowns; one dense matrix of them would take 100 MB. Semismooth Newton comes to the same point.
TEST(Smoothing, ObstacleProblemStaysSparseAndAgreesWithSemismooth) {
  const double before = support::peak_megabytes();
  const auto mcp = make_mcp(support::obstacle(60));
  const Result smooth = expect_solved(*mcp, Vec::Zero(3600), Smoothing{.stop = {.tol = 1e-10}});
  const Result semismooth = expect_solved(*mcp, Vec::Zero(3600), SemismoothNewton{.stop = {.tol = 1e-10}});
  EXPECT_LT((smooth.x - semismooth.x).lpNorm<Eigen::Infinity>(), 1e-8);
  EXPECT_LT(smooth.stats.iterations, 40);
  EXPECT_LT(support::peak_megabytes() - before, 90);
}

// The standard starts of the collection up to n = 100: at least 92 %, the share that is asked of SMOOTH, and 86 % of
// optimality conditions, equations from far starts and random NCPs; whatever it calls solved is. Catches a weaker
// schedule.
TEST(Smoothing, SolvesTheCollection) {
  struct Share {
    int solvable = 0;
    int solved = 0;
    std::string failed{};
  };
  Share most, apart;
  for (const auto& entry : collection::entries()) {
    const collection::Problem problem = entry.make();
    if (problem.mcp->size() > 100 || !problem.no_solution.empty()) continue;
    Share& share = support::set_apart(entry) ? apart : most;
    for (const Vec& x0 : problem.starts) {
      const Result result = solve(*problem.mcp, x0, Smoothing{});
      ++share.solvable;
      share.solved += result.solved();
      if (result.solved())
        EXPECT_LE(support::violation(*problem.mcp, result.x), 1e-8) << entry.name;
      else
        share.failed.append(" ").append(entry.name);
    }
  }
  EXPECT_GE(most.solvable, 90);
  EXPECT_GE(most.solved, 0.92 * most.solvable) << most.failed;
  EXPECT_GE(apart.solved, 0.86 * apart.solvable) << apart.failed;
}

}  // namespace
}  // namespace perp::ncp
