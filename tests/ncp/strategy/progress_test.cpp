// SPDX-License-Identifier: Apache-2.0
/// Ends without a solution: what they are called, what they advise, and how long they take.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "ncp/run/run.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// m1: x1 x2 >= 1,  x2: 1 >= m2,  x1: 1 >= m1 x2,  m2: x1 + x2 >= 1. With x2 > 0 the first and the third say x1 = m1 =
/// 1 / x2, then m2 = 1 and x1 + x2 = 1, where x1 x2 <= 1/4: no solution; x1 and m1 go to infinity as x2 goes to 0.
/// With x2 >= 1/2 the second row may be positive, and (2, 1/2, 2, 0) is the solution.
Functions hyperbola(double least_x2, std::chrono::microseconds pause = {}) {
  Functions f;
  f.name = "hyperbola";
  f.variable_names = {"m1", "x2", "x1", "m2"};
  f.box = Box::nonnegative(4);
  f.box.lower[1] = least_x2;
  f.F = [pause](In x, Out F) {
    if (pause.count() > 0) std::this_thread::sleep_for(pause);
    F << x[2] * x[1] - 1, 1 - x[3], 1 - x[0] * x[1], x[2] + x[1] - 1;
    return true;
  };
  return f;
}

// Catches a count of iterations that ends the search of a small problem in milliseconds, and the advice to raise it.
TEST(Progress, RunningOffIsSaidWithTheVariables) {
  const auto mcp = make_mcp(hyperbola(0));
  for (const Method& method : {Method(automatic()), Method(path())})
    for (const Vec& start : {vec({0, 1, 1, 0}), vec({1, 1, 1, 1}), vec({0, 0, 0, 0}), vec({3, 0.1, 5, 0})}) {
      const Result result = solve(*mcp, start, method);
      if (result.solved()) {  // so far out that the tolerance excuses the rest
        ASSERT_FALSE(result.notes.empty()) << result << ": x = " << result.x.transpose();
        EXPECT_THAT(result.notes.front(), AllOf(HasSubstr("run off to infinity"), HasSubstr("x1 =")));
        continue;
      }
      EXPECT_NE(result.status, Status::IterationLimit) << result;
      EXPECT_THAT(result.advice, Not(HasSubstr("raise"))) << result;
      EXPECT_THAT(result.message, AnyOf(HasSubstr("x1 ="), HasSubstr("m1 ="), HasSubstr("stationary"))) << result;
    }
  const auto solvable = make_mcp(hyperbola(0.5));
  const Result result = solve(*solvable, vec({0, 1, 1, 0}), automatic());
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_LE((result.x - vec({2, 0.5, 2, 0})).lpNorm<Eigen::Infinity>(), 1e-7);
}

// x^3 = 0: each Newton step leaves two thirds, so the residual falls to the limit; of x^2 + 1 = 0 it stays at 1 or
// more. Catches advice that does not look.
TEST(Progress, OnlyAFallingResidualAsksForMore) {
  const auto cube = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x * x; }, [](double x) { return 3 * x * x; }));
  const auto none = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x + 1; }, [](double x) { return 2 * x; }));
  for (const char* name : {"path", "semismooth", "josephy", "lmmcp", "auto"}) {
    Method method = method_of(name);
    stop(method).max_iterations = 5;
    stop(method).tol = 1e-14;
    const Result falls = solve(*cube, vec({1}), method);
    EXPECT_TRUE(falls.solved() || falls.advice.find("raise the limit") != std::string::npos) << name << falls.advice;
    stop(method).max_iterations = 60;
    const Result stays = solve(*none, vec({3}), method);
    EXPECT_FALSE(stays.solved()) << name;
    EXPECT_THAT(stays.advice, Not(HasSubstr("raise"))) << name << ": " << stays;
  }
}

// The time without progress ends the search, attempts that are left or not; a limit of iterations that is asked for
// still counts. Catches a stall that nobody looks at between attempts.
TEST(Progress, ARunWithoutProgressGivesUp) {
  const auto slow = make_mcp(hyperbola(0, std::chrono::microseconds(200)));
  const auto begin = std::chrono::steady_clock::now();
  const Result result = solve(*slow, vec({0, 1, 1, 0}), automatic({.max_stall = Seconds(0.05)}));
  const Seconds time = std::chrono::steady_clock::now() - begin;
  EXPECT_FALSE(result.solved());
  EXPECT_TRUE(stuck(result.status)) << result;
  EXPECT_THAT(result.message, HasSubstr("no progress in")) << result;
  EXPECT_LT(time.count(), 30);
  const Result few = solve(*slow, vec({0, 1, 1, 0}), automatic({.max_iterations = 7}));
  EXPECT_LE(few.stats.iterations, 7);
}

}  // namespace
}  // namespace perp::ncp
