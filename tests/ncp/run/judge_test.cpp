// SPDX-License-Identifier: Apache-2.0
/// What a solve says of its point: Solved, SolvedToRounding, the moves to bounds, the notes and the relative tolerance.
#include "ncp/run/judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ncp/methods/semismooth_newton.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/run/run.hpp"
#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Scalar = std::function<double(double)>;

/// l <= x <= u _|_ F(x) in one variable.
std::unique_ptr<Mcp> scalar(const Scalar& F, const Scalar& J, double l, double u) {
  return make_mcp({.name = "scalar",
                   .box = {.lower = Vec::Constant(1, l), .upper = Vec::Constant(1, u)},
                   .pattern = dense_pattern(1),
                   .F =
                       [F](In x, Out f) {
                         f[0] = F(x[0]);
                         return true;
                       },
                   .J =
                       [J](In x, SpMat& j) {
                         j.coeffRef(0, 0) = J(x[0]);
                         return true;
                       }});
}

Result at(const Mcp& mcp, double x, const Stop& stop = {}) {
  return solve(mcp, Vec::Constant(1, x), NewtonJosephy{.stop = stop});
}

// F = 1e12^2 x^2 - 9 has its root at 3e-12; at 3.8e-9 F is 1.4e7, but x is within 1e-8 of its bound, where F = -9: the
// letter of the natural residual calls it solved. Catches a report that keeps silent.
TEST(Notes, AnEquationExcusedByABoundItCannotMoveTo) {
  const auto mcp = scalar([](double x) { return 1e24 * x * x - 9; }, [](double x) { return 2e24 * x; }, 0, infinity);
  const Result result = at(*mcp, 3.8e-9);
  EXPECT_EQ(result.status, Status::Solved);
  EXPECT_THAT(result.notes,
              ElementsAre(HasSubstr("excused because variable x[1] is within the tolerance of its lower")));
}

// exp(x) = 0 has no solution; at -18.8 exp(x) = 6.8e-9 is below the tolerance. With a relative tolerance the run goes
// on.
TEST(Notes, AnEquationThatIsSmallAsAWhole) {
  const auto mcp =
      scalar([](double x) { return std::exp(x); }, [](double x) { return std::exp(x); }, -infinity, infinity);
  const Result result = at(*mcp, -18.8);
  EXPECT_EQ(result.status, Status::Solved);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("equation F[1] is 6.84")));
  EXPECT_NEAR(result.relative, 1 / (18.8 + 19.8), 1e-12);
  const Result balanced = at(*mcp, -18.8, {.tol_relative = 1e-6, .max_iterations = 50});
  EXPECT_FALSE(balanced.solved() && std::exp(balanced.x[0]) > 0);
}

// 1e-12 (x^2 - 9): any x of moderate size passes; the run goes on to x = 3, unless its iterations are at their end.
TEST(Notes, AnEquationInTinyUnits) {
  const auto mcp =
      scalar([](double x) { return 1e-12 * (x * x - 9); }, [](double x) { return 2e-12 * x; }, -infinity, infinity);
  EXPECT_THAT(at(*mcp, 1, {.max_iterations = 0}).notes,
              ElementsAre(HasSubstr("below the tolerance, but its terms are of size")));
  EXPECT_NEAR(at(*mcp, 1).x[0], 3, 1e-7);
  const Result balanced = at(*mcp, 1, {.tol_relative = 1e-9});
  EXPECT_TRUE(balanced.solved()) << balanced.message;
  EXPECT_NEAR(balanced.x[0], 3, 1e-7);
  EXPECT_THAT(balanced.notes, IsEmpty());
}

// The same from x = 0 = l: F = -9e-12 has the wrong sign there, so that the bound excuses nothing. Catches a rule that
// asks where x is and not what F is.
TEST(Notes, AnEquationInTinyUnitsAtABoundThatExcusesNothing) {
  const auto mcp =
      scalar([](double x) { return 1e-12 * (x * x - 9); }, [](double x) { return 2e-12 * x; }, 0, infinity);
  const Result gone_on = at(*mcp, 0);
  EXPECT_TRUE(!gone_on.notes.empty() || std::abs(gone_on.x[0] - 3) < 1e-7);
  const Result balanced = at(*mcp, 0, {.tol_relative = 1e-9, .max_iterations = 50});
  EXPECT_TRUE(!balanced.solved() || std::abs(balanced.x[0] - 3) < 1e-7);
}

// x + y = 0.1 + 0.2, whose rounding is no news at x = y = 0.15: catches notes on what is solved as far as can be.
TEST(Notes, RoundingIsNoNews) {
  const auto mcp =
      scalar([](double x) { return x - 0.1 + 0.1 + 1e-17; }, [](double) { return 1.0; }, -infinity, infinity);
  EXPECT_THAT(at(*mcp, 0).notes, IsEmpty());
}

// l = 0, u = 1e-9, F = -5: x = 0 passes because u is near, and the point moves there, where it is a solution exactly.
TEST(Notes, BoundsNearerThanTheTolerance) {
  const auto mcp = scalar([](double) { return -5.0; }, [](double) { return 0.0; }, 0, 1e-9);
  const Result result = at(*mcp, 0);
  EXPECT_EQ(result.status, Status::Solved);
  EXPECT_EQ(result.x[0], 1e-9);
  EXPECT_EQ(result.residual.natural, 0);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("the bounds of variable x[1] are 1e-09 apart")));
}

// F = x + 1 from 3e-9: solved, and at the bound exactly. Catches points that hover above their bounds.
TEST(Judge, MovesToTheBounds) {
  const auto mcp = scalar([](double x) { return x + 1; }, [](double) { return 1.0; }, 0, infinity);
  const Result result = at(*mcp, 3e-9);
  EXPECT_EQ(result.x[0], 0);
  EXPECT_EQ(result.residual.natural, 0);
  EXPECT_THAT(result.notes, IsEmpty());
}

// x_0 may move to 0, x_1 may not (F_1 falls to -9 there): each for itself. Catches all or nothing.
TEST(Judge, MovesWhatCanMove) {
  const auto mcp = make_mcp({.name = "two",
                             .box = Box::nonnegative(2),
                             .pattern = dense_pattern(2),
                             .F =
                                 [](In x, Out F) {
                                   F << x[0] + 1, 1e24 * x[1] * x[1] - 9;
                                   return true;
                                 },
                             .J =
                                 [](In x, SpMat& J) {
                                   J.coeffRef(0, 0) = 1;
                                   J.coeffRef(1, 1) = 2e24 * x[1];
                                   return true;
                                 }});
  const Result result = solve(*mcp, Eigen::Vector2d(2e-9, 3.8e-9), NewtonJosephy{});
  EXPECT_EQ(result.x[0], 0);
  EXPECT_EQ(result.x[1], 3.8e-9);
}

std::unique_ptr<Mcp> affine(const Eigen::MatrixXd& M, Vec q, Box box) {
  return make_affine_mcp({.M = M.sparseView(), .q = std::move(q), .box = std::move(box)}, "affine");
}

// x_1 = 1e17 + 1 is no double: no method may say Solved, and auto and path say what is the matter in one attempt.
TEST(Judge, SolvedToRoundingByEveryMethod) {
  Eigen::MatrixXd M(2, 2);
  M << 1, 0, 1, 1;
  const auto mcp = affine(M, Eigen::Vector2d(1, -1e17), Box::free(2));
  for (const Preset& preset : presets()) {
    Method method = preset.method;
    stop(method).max_iterations = 100;
    const Result result = solve(*mcp, Vec::Zero(2), method);
    EXPECT_FALSE(result.solved()) << preset.name << ": " << result.message;
    if (preset.name != "auto" && preset.name != "path") continue;
    EXPECT_EQ(result.status, Status::SolvedToRounding) << preset.name << ": " << result.message;
    EXPECT_EQ(result.stats.restarts, 0) << preset.name;
    EXPECT_LE(result.relative, 1e-17);
  }
}

// Plain sums call x = (1, 1) a solution of 1e17 x_0 + x_1 - 1e17 = 0: F = 1. Catches a judge of affine problems that
// trusts the sums of the method.
TEST(Judge, AffineSumsWithoutRounding) {
  Eigen::MatrixXd M(2, 2);
  M << 1e17, 1, 0, 1;
  const auto mcp = affine(M, Eigen::Vector2d(-1e17, -1), Box::free(2));
  EXPECT_EQ(residual(*mcp, Vec::Ones(2)).natural, 1);
  const Result result = solve(*mcp, Vec::Ones(2), NewtonJosephy{});
  EXPECT_FALSE(result.solved());
}

// A nonlinear equation at the end of its digits: x^2 = 2e20 has no double with |F| <= 1e-8.
TEST(Judge, NonlinearEquationsAreSolvedToRoundingToo) {
  const auto mcp = scalar([](double x) { return x * x - 2e20; }, [](double x) { return 2 * x; }, -infinity, infinity);
  for (const char* name : {"path", "semismooth", "josephy", "auto"}) {
    const Result result = solve(*mcp, Vec::Constant(1, 1e10), find_preset(name)->method);
    EXPECT_EQ(result.status, Status::SolvedToRounding) << name << ": " << result.message;
    EXPECT_NEAR(result.x[0], std::sqrt(2e20), 1e-4) << name;
  }
}

// As the restarts of path do: semismooth (on the min function, whose steps halve ||Phi||) with its own default
// tolerance of 1e-8 within a run that asks for 1e-30. Newton's steps on x^3 take x to 2/3 x. Catches the J that was
// left out, and kept stale, from 1e-8 on: x falls more slowly then.
TEST(Judge, TheToleranceIsTheRunsOwn) {
  const auto mcp = scalar([](double x) { return x * x * x; }, [](double x) { return 3 * x * x; }, -infinity, infinity);
  const Stop stop{.tol = 1e-30, .max_iterations = 200};
  double last = 0;
  const Observer watch = [&last](const Iteration& it) {
    const double x = (*it.x)[0];
    if (it.k > 0 && last > 1e-4) {  // F from 1 to 1e-12; a regularised J shortens the steps at last
      EXPECT_NEAR(x / last, 2.0 / 3, 1e-3) << it.k;
    }
    last = x;
    return Next::Continue;
  };
  ncp::Run run(*mcp, stop, watch);
  Point point;
  ASSERT_TRUE(run.start(Vec::Ones(1), point));
  iterate(run, SemismoothNewton{.cfunction = natural_min()}, std::move(point));
  EXPECT_EQ(run.status(), Status::Solved);
}

}  // namespace
}  // namespace perp::ncp
