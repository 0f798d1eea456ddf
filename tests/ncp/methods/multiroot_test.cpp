// SPDX-License-Identifier: Apache-2.0
/// GSL's solvers as a baseline: what they solve, how they fail, and that GSL's error handler is left alone.
#include <gmock/gmock.h>
#include <gsl/gsl_errno.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "collection/collection.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::expect_solution;
using support::vec;
using testing::HasSubstr;

std::vector<Multiroot> solvers() {
  std::vector<Multiroot> all;
  for (const auto solver :
       {MultirootSolver::Hybridsj, MultirootSolver::Hybridj, MultirootSolver::Newton, MultirootSolver::Gnewton})
    all.push_back({.solver = solver});
  return all;
}

std::atomic<int> handler_calls{0};

/// Counts calls of GSL's error handler, whose default ends the process.
class HandlerGuard {
 public:
  HandlerGuard() : before_(gsl_set_error_handler([](const char*, const char*, int, int) { ++handler_calls; })) {
    handler_calls = 0;
  }
  ~HandlerGuard() {
    EXPECT_EQ(handler_calls, 0) << "GSL's error handler was called";
    gsl_set_error_handler(before_);
  }
  HandlerGuard(const HandlerGuard&) = delete;
  HandlerGuard& operator=(const HandlerGuard&) = delete;

 private:
  gsl_error_handler_t* before_;
};

// Rosenbrock's system (GSL's own example): x_1 = 1, x_2 = x_1^2. Catches a transposed Jacobian.
TEST(Multiroot, SolvesRosenbrocksSystem) {
  const HandlerGuard guard;
  const auto mcp = make_mcp(support::dense(
      "rosenbrock", Box::free(2),
      [](const Vec& x) {
        return vec({1 - x[0], 10 * (x[1] - x[0] * x[0])});
      },
      [](const Vec& x) {
        Dense J(2, 2);
        J << -1, 0, -20 * x[0], 10;
        return J;
      }));
  for (const Multiroot& method : solvers())
    expect_solution(*mcp, vec({-10, -5}), method, vec({1, 1}), 1e-8, std::string(name(method)));
}

// With bounds: smoothed Fischer-Burmeister; every kind of interval. F is a P-function. Catches bounds that are not
// smoothed, or mu_end too large for the tolerance.
TEST(Multiroot, SolvesBoundedProblemsBySmoothing) {
  const HandlerGuard guard;
  support::Random random(11);
  for (int k = 0; k < 10; ++k) {
    const auto [functions, solution] = support::planted(3 + k, k % 2 == 0 ? 0.5 : 0, random);
    const auto mcp = make_mcp(functions);
    expect_solution(*mcp, Vec::Zero(3 + k), Multiroot{}, solution, 1e-4, "hybridsj");
  }
}

// A good part of the small problems of the collection, and never a wrong verdict: the judge is not GSL.
TEST(Multiroot, SolvesPartOfTheCollectionAndNeverClaimsMore) {
  const HandlerGuard guard;
  int solved = 0;
  int runs = 0;
  for (const collection::Entry& entry : collection::entries()) {
    if (entry.size > 40) continue;
    const collection::Problem problem = entry.make();
    for (const Multiroot& method : solvers()) {
      Multiroot limited = method;
      limited.stop.max_iterations = 200;
      const Result result = solve(*problem.mcp, problem.starts.front(), limited);
      ++runs;
      if (result.solved()) {
        ++solved;
        EXPECT_LE(support::violation(*problem.mcp, result.x), 1e-8) << entry.name;
      } else {
        EXPECT_FALSE(result.message.empty()) << entry.name;
        EXPECT_FALSE(result.advice.empty()) << entry.name;
      }
    }
  }
  EXPECT_GE(solved, runs / 3);
  EXPECT_LT(solved, runs);
}

// log x from 20: Newton's first step leads below 0. GSL does not shorten it.
TEST(Multiroot, UndefinedFunctionsAreSaidToBe) {
  const HandlerGuard guard;
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::log(x); }, [](double x) { return 1 / x; }));
  const Result result = solve(*mcp, vec({20}), Multiroot{.solver = MultirootSolver::Newton});
  EXPECT_EQ(result.status, Status::EvaluationFailed) << result;
  EXPECT_THAT(result.message, HasSubstr("gsl-newton"));
  EXPECT_EQ(result.x[0], 20);
}

// Parallel rows. GSL's linear solver would call the error handler, which ends the process.
TEST(Multiroot, SingularJacobiansDoNotEndTheProcess) {
  const HandlerGuard guard;
  const auto mcp = make_mcp(support::dense(
      "singular", Box::free(2),
      [](const Vec& x) {
        return vec({x[0] + x[1] - 1, 2 * x[0] + 2 * x[1] - 3});
      },
      [](const Vec&) {
        Dense J(2, 2);
        J << 1, 1, 2, 2;
        return J;
      }));
  for (const Multiroot& method : solvers()) {
    const Result result = solve(*mcp, vec({0, 0}), method);
    EXPECT_FALSE(result.solved());
    EXPECT_THAT(result.message, HasSubstr(std::string(name(Method(method)))));
    if (method.solver == MultirootSolver::Newton || method.solver == MultirootSolver::Gnewton) {
      EXPECT_EQ(result.status, Status::LinearAlgebraFailed) << result;
      EXPECT_THAT(result.message, HasSubstr("singular"));
    }
  }
}

// GSL allocates nothing of size 0: it would call the handler.
TEST(Multiroot, SolvesTheEmptyProblem) {
  const HandlerGuard guard;
  const auto mcp = make_mcp(support::dense(
      "empty", Box::free(0), [](const Vec& x) { return x; }, [](const Vec&) { return Dense(0, 0); }));
  for (const Multiroot& method : solvers()) EXPECT_TRUE(solve(*mcp, Vec(0), method).solved());
}

TEST(Multiroot, RefusesLargeProblems) {
  const auto mcp = make_mcp(support::obstacle(23));
  const Result result = solve(*mcp, Vec::Zero(529), Multiroot{});
  EXPECT_EQ(result.status, Status::NotApplicable);
  EXPECT_THAT(result.message, HasSubstr("529 variables"));
  EXPECT_EQ(result.x.size(), 529);
}

TEST(Multiroot, KeepsToItsLimitsAndShowsItsIterations) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::vector<Iteration> records;
  const Result result = solve(*mcp, Vec::Ones(4), Multiroot{.stop = {.max_iterations = 3}}, record(records));
  EXPECT_EQ(result.status, Status::IterationLimit);
  EXPECT_EQ(result.stats.iterations, 3);
  ASSERT_EQ(records.size(), 4U);
  EXPECT_EQ(records[1].mu, 1);
  EXPECT_GT(result.stats.J_evals, 0);
  const auto interrupted = [](const Iteration& it) { return it.k == 2 ? Next::Stop : Next::Continue; };
  EXPECT_EQ(solve(*mcp, Vec::Ones(4), Multiroot{}, interrupted).status, Status::Interrupted);
}

// What the problem throws comes out of solve(), through GSL's frames.
TEST(Multiroot, ExceptionsOfTheProblemPass) {
  int calls = 0;
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity,
      [&calls](double x) {
        if (++calls > 3) throw std::runtime_error("the model's own");
        return x * x * x - 2;
      },
      [](double x) { return 3 * x * x; }));
  EXPECT_THROW(solve(*mcp, vec({5}), Multiroot{}), std::runtime_error);
}

// Two threads, each with its own problem: nothing global is written.
TEST(Multiroot, TwoThreads) {
  const auto work = [] {
    const auto mcp = make_mcp(support::kojima_shindo(true));
    for (int k = 0; k < 20; ++k) EXPECT_TRUE(solve(*mcp, vec({1.25, 0.1, 0.1, 0.5}), Multiroot{}).solved());
  };
  std::thread other(work);
  work();
  other.join();
}

TEST(Multiroot, RefusesBadOptionsByName) {
  const auto why = [](const Multiroot& m) { return invalid(Method(m)).value_or(""); };
  EXPECT_THAT(why({.stop = {.tol = -1}}), HasSubstr("convergence_tolerance is -1"));
  EXPECT_THAT(why({.stop = {.max_iterations = -1}}), HasSubstr("major_iteration_limit is -1"));
  EXPECT_FALSE(invalid(Method(Multiroot{})).has_value());
  EXPECT_EQ(name(Method(Multiroot{})), "gsl-hybridsj");
}

}  // namespace
}  // namespace perp::ncp
