// SPDX-License-Identifier: Apache-2.0
/// Newton on the min equations (Pang 1990) and NE/SQP (Pang & Gabriel 1993): their directions on examples solved by
/// hand, their behaviour on problems with known solutions, and where they are known to get stuck.
#include "ncp/methods/min_newton.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/methods/least_squares_step.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::expect_solution;
using support::Random;
using support::vec;

constexpr auto newton = MinNewton::Direction::Newton;
constexpr auto convex_qp = MinNewton::Direction::ConvexQp;

std::vector<support::NamedMethod> both() {
  return {{"Newton", MinNewton{.direction = newton}}, {"NE/SQP", MinNewton{.direction = convex_qp}}};
}

struct Recorded {
  Result result;
  std::vector<Iteration> records;
  std::vector<Vec> x;
};
Recorded recorded(const Mcp& mcp, const Vec& x0, const MinNewton& method) {
  Recorded out;
  out.result = solve(mcp, x0, method, [&](const Iteration& it) {
    out.records.push_back(it);
    out.x.push_back(*it.x);
    return Next::Continue;
  });
  return out;
}

Functions affine(const Box& box, const Dense& M, const Vec& q) {
  return support::affine({.M = M.sparseView(), .q = q, .box = box});
}

// x = (2, 1/2), F = (0, -3) < x: all rows are rows of M. Newton's d = (3/2, -3/2) leaves the box at d_2 = -1/2, where
// the least residual is at d_1 = 3/2: r = (1, -1), multiplier (M'r)_2 = 2 >= 0. Catches a Newton step cut off at the
// box in place of the least-squares solution ((0, -1/2) + ..., with a larger residual), and wrong multipliers.
TEST(MinNewton, QpDirectionByHandAtALowerBound) {
  const auto mcp = make_mcp(affine(Box::nonnegative(2), (Dense(2, 2) << 1, 1, 1, -1).finished(), vec({-2.5, -4.5})));
  const Recorded run = recorded(*mcp, vec({2, 0.5}), {.direction = convex_qp});
  ASSERT_GE(run.x.size(), 2u);
  EXPECT_EQ(run.records[1].kind, 'Q');
  EXPECT_DOUBLE_EQ(run.records[1].step, 1);
  EXPECT_NEAR((run.x[1] - vec({3.5, 0})).norm(), 0, 1e-9) << run.x[1].transpose();
  EXPECT_NEAR(run.records[1].merit, 1, 1e-9);  // theta = 1/2 ((min(3.5, 1))^2 + (min(0, -1))^2)
}

// The same with the bound above: reflected, x -> -x, F -> -F.
TEST(MinNewton, QpDirectionByHandAtAnUpperBound) {
  const auto mcp = make_mcp(
      affine({Vec::Constant(2, -infinity), Vec::Zero(2)}, (Dense(2, 2) << 1, 1, 1, -1).finished(), vec({2.5, 4.5})));
  const Recorded run = recorded(*mcp, vec({-2, -0.5}), {.direction = convex_qp});
  ASSERT_GE(run.x.size(), 2u);
  EXPECT_NEAR((run.x[1] - vec({-3.5, 0})).norm(), 0, 1e-9) << run.x[1].transpose();
}

// A feasible Newton point is the QP's solution: one step for a system of linear equations, in both.
TEST(MinNewton, LinearEquationsInOneStep) {
  const auto mcp = make_mcp(affine(Box::free(2), (Dense(2, 2) << 2, 1, 1, 3).finished(), vec({-3, -4})));
  for (const auto& [label, method] : both()) {
    const Result result = expect_solution(*mcp, vec({10, -10}), method, vec({1, 1}), 1e-12, label);
    EXPECT_EQ(result.stats.iterations, 1) << label;
  }
}

// H = [1 1; 2 2], Phi = (-1, -2) at 0: of all d with d_1 + d_2 = 1 the least-norm one is (1/2, 1/2). Catches a run that
// gives up where H is singular, or steps far along its null space.
TEST(MinNewton, SingularHTakesNearlyTheLeastNormStep) {
  const auto mcp = make_mcp(affine(Box::free(2), (Dense(2, 2) << 1, 1, 2, 2).finished(), vec({-1, -2})));
  for (const auto& [label, method] : both()) {
    const Recorded run = recorded(*mcp, Vec::Zero(2), std::get<MinNewton>(method));
    EXPECT_TRUE(run.result.solved()) << label << run.result;
    EXPECT_NEAR((run.result.x - vec({0.5, 0.5})).norm(), 0, 1e-4) << label;
    ASSERT_GE(run.records.size(), 2u);
    EXPECT_EQ(run.records[1].kind, 'L') << label;
    EXPECT_GT(run.records[1].prox, 0) << label;
  }
}

// The optimality conditions of the QP, by projection, on random H, singular ones too, in boxes of every kind; and
// Phi'H d <= -||H d||^2, on which the descent of NE/SQP rests. Catches a wrong sign or a unit lost in the subproblem.
TEST(LeastSquaresStep, MeetsTheOptimalityConditions) {
  Random random(3);
  const Stop stop;
  const Observer observer;
  for (int k = 0; k < 60; ++k) {
    const Index n = 1 + k % 12;
    const double scale = std::pow(10.0, random.uniform(-8, 8));
    auto [functions, solution] = support::planted(n, 0.3, random);
    const Box box = functions.box;
    const auto mcp = make_mcp(std::move(functions));
    perp::ncp::Run run(*mcp, stop, observer);
    Point point;
    ASSERT_TRUE(run.start(3 * random.normals(n), point));
    Linearisation lin;
    linearise(natural_min(), box, point, lin);
    if (k % 3 == 0) {  // of half the rank
      const Dense low = random.normals(n, (n + 1) / 2) * random.normals((n + 1) / 2, n);
      lin.H = low.sparseView();
    }
    lin.at.Phi = scale * random.normals(n);
    lin.gradient = lin.H.transpose() * lin.at.Phi;
    const double nu = k % 3 == 0 ? 1e-6 : 0;
    LeastSquaresSteps steps(run);
    const LeastSquaresStep step = steps.solve(lin, point.x, nu);
    ASSERT_EQ(step.end, LeastSquaresStep::End::Found);
    const Vec y = point.x + step.d;
    EXPECT_LE((y - lcp::project(box, y)).norm(), 1e-14 * (1 + y.norm()));
    const Vec g = lin.H.transpose() * (lin.at.Phi + lin.H * step.d) + nu * step.d;
    const double size = (1 + lin.H.norm()) * (lin.at.Phi.norm() + lin.H.norm() * step.d.norm()) + 1e-8 * y.norm();
    EXPECT_LE((step.d - (lcp::project(box, y - g) - point.x)).norm(), 1e-6 * size) << k;
    const Vec Hd = lin.H * step.d;
    EXPECT_NEAR(step.model, lin.at.Phi.dot(Hd), 1e-9 * lin.at.Phi.norm() * (Hd.norm() + 1e-300));
    EXPECT_LE(step.model, -Hd.squaredNorm() + 1e-6 * size * size);
  }
}

// Where all H at the solution are nonsingular both are Newton's method: order near 2 in the last records. Catches a
// subproblem solved loosely, and a search that does not accept t = 1.
TEST(MinNewton, ConvergesQuadratically) {
  Random random(5);
  int seen = 0;
  for (int k = 0; k < 10; ++k) {
    const auto [functions, solution] = support::planted(20, 0, random);
    const auto mcp = make_mcp(functions);
    const Vec x0 = solution + 2 * random.normals(20);
    for (const auto direction : {newton, convex_qp}) {
      const Recorded run = recorded(*mcp, x0, {.stop = {.tol = 1e-13}, .direction = direction});
      ASSERT_TRUE(run.result.solved()) << run.result;
      if (const double order = support::last_order(run.records); order > 0) {
        EXPECT_GT(order, 1.6);
        ++seen;
      }
      EXPECT_DOUBLE_EQ(run.records.back().step, 1);
    }
  }
  EXPECT_GE(seen, 10);
  const auto hs34 = make_mcp(support::hs34());
  for (const auto direction : {newton, convex_qp}) {
    const Recorded run = recorded(*hs34, vec({0, 1.05, 2.9, 0, 0}), {.stop = {.tol = 1e-13}, .direction = direction});
    EXPECT_GT(support::last_order(run.records), 1.7);
  }
}

// At x = 0 F = -0.01, F' = -2: the only step that reduces F + F' d leaves the box, d = 0 solves the QP, theta > 0
// (Billups 1995): not regular. Catches a run that calls such a point solved, loops at it, or does not say what it is.
TEST(MinNewton, IsStuckAtPointsThatAreNotRegular) {
  const auto mcp = make_mcp(support::billups());
  for (const auto& [label, method] : both()) {
    const Result result = solve(*mcp, vec({0}), method);
    EXPECT_EQ(result.status, Status::StationaryPoint) << label << result;
    EXPECT_NEAR(result.residual.natural, 0.01, 1e-12) << label;
    EXPECT_THAT(result.message, testing::HasSubstr("not regular")) << label;
    EXPECT_FALSE(result.advice.empty()) << label;
  }
}

// By Pang & Gabriel's test, with memory = 1, theta falls. Catches merits compared with an older point's.
TEST(MinNewton, MonotoneSearchNeverRises) {
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const auto direction : {newton, convex_qp})
    for (const Vec& x0 : support::kojima_shindo_starts()) {
      const Recorded run = recorded(*mcp, x0, {.direction = direction, .search = {.memory = 1}});
      for (std::size_t k = 1; k < run.records.size(); ++k)
        EXPECT_LE(run.records[k].merit, run.records[k - 1].merit) << k;
    }
}

// F = log x on x >= 0: from 5 the full steps end where F is not defined. Catches NaNs that get into an iterate.
TEST(MinNewton, BacktracksIntoTheDomain) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double x) { return std::log(x); }, [](double x) { return 1 / x; }));
  for (const auto& [label, method] : both()) {
    expect_solution(*mcp, vec({5}), method, vec({1}), 1e-7, label);
    expect_solution(*mcp, vec({0}), method, vec({1}), 1e-7, label + ", moved off the bound");
  }
}

TEST(MinNewton, ObeysItsLimits) {
  Random random(7);
  const auto [functions, solution] = support::planted(15, 0, random);
  const auto mcp = make_mcp(functions);
  const Vec x0 = 5 * random.normals(15);
  std::atomic<bool> flag = true;
  for (const auto direction : {newton, convex_qp}) {
    const Result two = solve(*mcp, x0, MinNewton{.stop = {.max_iterations = 2}, .direction = direction});
    EXPECT_EQ(two.status, Status::IterationLimit);
    EXPECT_EQ(two.stats.iterations, 2);
    const MinNewton no_time{.stop = {.max_time = std::chrono::duration<double>(0)}, .direction = direction};
    EXPECT_EQ(solve(*mcp, x0, no_time).status, Status::TimeLimit);
    const MinNewton flagged{.stop = {.interrupt = &flag}, .direction = direction};
    EXPECT_EQ(solve(*mcp, x0, flagged).status, Status::Interrupted);
    const Result observed = solve(*mcp, x0, MinNewton{.direction = direction},
                                  [](const Iteration& it) { return it.k == 1 ? Next::Stop : Next::Continue; });
    EXPECT_EQ(observed.status, Status::Interrupted);
    EXPECT_EQ(observed.stats.iterations, 1);
  }
}

TEST(MinNewton, RefusesOptionsThatMakeNoSense) {
  const auto why = [](const MinNewton& method) { return invalid(Method(method)).value_or(""); };
  EXPECT_EQ(why({}), "");
  EXPECT_THAT(why({.search = {.sigma = 2}}), testing::StartsWith("sigma is 2"));
  EXPECT_THAT(why({.search = {.memory = 0}}), testing::HasSubstr("nms_memory_size is 0"));
  EXPECT_THAT(why({.stop = {.tol = -1}}), testing::HasSubstr("convergence_tolerance is -1"));
}

}  // namespace
}  // namespace perp::ncp
