// SPDX-License-Identifier: Apache-2.0
/// Every Status of ncp/run/result.hpp, by a problem made for it; LinearAlgebraFailed is not given by any method today.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::methods;
using support::methods_without_escape;
using support::nan;
using support::vec;
using testing::AllOf;
using testing::AnyOf;
using testing::Eq;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

Functions market(Functions functions) {
  functions.variable_names = {"price[1]", "price[2]", "price[3]", "price[4]"};
  functions.equation_names = {"wheat", "rye", "oats", "barley"};
  return functions;
}

std::string statement(const Result& result) {
  std::ostringstream out;
  out << result;
  return out.str();
}

TEST(Status, HasAName) {
  EXPECT_EQ(to_string(Status::Solved), "Solved");
  EXPECT_EQ(to_string(Status::StationaryPoint), "StationaryPoint");
  EXPECT_EQ(to_string(Status::NoProgress), "NoProgress");
  EXPECT_EQ(to_string(Status::IterationLimit), "IterationLimit");
  EXPECT_EQ(to_string(Status::TimeLimit), "TimeLimit");
  EXPECT_EQ(to_string(Status::Interrupted), "Interrupted");
  EXPECT_EQ(to_string(Status::EvaluationFailed), "EvaluationFailed");
  EXPECT_EQ(to_string(Status::LinearAlgebraFailed), "LinearAlgebraFailed");
  EXPECT_EQ(to_string(Status::SubproblemFailed), "SubproblemFailed");
}

TEST(Status, Solved) {
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const auto& [label, method] : methods()) {
    const Result result = solve(*mcp, Vec::Ones(4), method);
    EXPECT_EQ(result.status, Status::Solved) << label;
    EXPECT_LE(support::violation(*mcp, result.x), 1e-8) << label;
    EXPECT_THAT(result.message, HasSubstr("solution found")) << label;
    EXPECT_EQ(result.advice, "") << label;
  }
}

// Billups 1995: near 0 every merit function has a local minimum that is no solution. Without escapes the methods end
// there and say where, with the escapes of Billups & Ferris 1997 they solve it. Catches a false convergence, and runs
// of 500 iterations of nothing.
TEST(Status, StuckAtALocalMinimum) {
  Functions functions = support::billups();
  functions.variable_names = {"price"};
  functions.equation_names = {"excess"};
  const auto mcp = make_mcp(std::move(functions));
  for (const auto& [label, method] : methods_without_escape()) {
    const Result result = solve(*mcp, vec({0}), method);
    EXPECT_THAT(result.status, AnyOf(Eq(Status::StationaryPoint), Eq(Status::NoProgress))) << label << ": " << result;
    EXPECT_NEAR(result.residual.natural, 0.01, 1e-6) << label;
    EXPECT_LT(result.stats.iterations, 150) << label;
    EXPECT_THAT(result.message, AllOf(HasSubstr("excess"), HasSubstr("price"), HasSubstr("0.01"))) << label;
    EXPECT_NE(result.advice, "") << label;
  }
  for (const auto& [label, method] : methods()) {
    const Result result = solve(*mcp, vec({0}), method);
    EXPECT_TRUE(result.solved()) << label << ": " << result;
    EXPECT_NEAR(result.x[0], 1 + std::sqrt(1.01), 1e-7) << label;
    EXPECT_THAT(result.message, HasSubstr("escape")) << label;
  }
}

// x^2 + 1 = 0 has no real solution, and grad 1/2 F^2 = F F' is 0 at 0, where Newton's first step from 1 leads.
TEST(Status, StationaryPoint) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x + 1; }, [](double x) { return 2 * x; }));
  const Result result = solve(*mcp, vec({1}), SemismoothNewton{});
  EXPECT_EQ(result.status, Status::StationaryPoint) << result;
  EXPECT_NEAR(result.x[0], 0, 1e-6);
  EXPECT_THAT(result.message, HasSubstr("stationary point"));
}

// F = -1 on x >= 0 has no solution; x runs away while the merit function falls to its infimum. Catches runs to the
// iteration limit, and an x that overflows.
TEST(Status, NoProgressWithoutASolution) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double) { return -1; }, [](double) { return 0; }));
  for (const auto& [label, method] : methods_without_escape()) {
    const Result result = solve(*mcp, vec({1}), method);
    EXPECT_EQ(result.status, label == "path" ? Status::Unbounded : Status::NoProgress) << label << ": " << result;
    EXPECT_TRUE(result.x.allFinite()) << label;
    EXPECT_EQ(result.residual.natural, 1) << label;
  }
  for (const auto& [label, method] : methods())  // escapes end as well
    EXPECT_FALSE(solve(*mcp, vec({1}), method).solved()) << label;
}

TEST(Status, IterationLimit) {
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const int limit : {0, 1, 2})
    for (const auto& [label, method] : methods({.max_iterations = limit})) {
      const Result result = solve(*mcp, Vec::Constant(4, 100), method);
      EXPECT_EQ(result.status, Status::IterationLimit) << label << ": " << result;
      EXPECT_EQ(result.stats.iterations, limit) << label;
      EXPECT_THAT(result.message, HasSubstr("limit of " + std::to_string(limit) + " iteration")) << label;
    }
  // The limit is for the run and its escapes together.
  const auto billups = make_mcp(support::billups());
  for (const auto& [label, method] : methods({.max_iterations = 120})) {
    const Result result = solve(*billups, vec({0}), method);
    EXPECT_EQ(result.status, Status::IterationLimit) << label << ": " << result;
    EXPECT_LE(result.stats.iterations, 120) << label;
    EXPECT_THAT(result.message, HasSubstr("limit of 120 iterations")) << label;
  }
}

// The start is projected onto the box, and the answer of a run without iterations.
TEST(Status, IterationLimitZeroAnswersTheProjectedStart) {
  Functions functions = support::kojima_shindo();
  functions.box = {vec({0, -infinity, 2, 3}), vec({infinity, 1, 2, 4})};
  const auto mcp = make_mcp(functions);
  for (const auto& [label, method] : methods({.max_iterations = 0}))
    EXPECT_EQ(solve(*mcp, vec({-1, 5, 7, 3.5}), method).x, vec({0, 1, 2, 3.5})) << label;
}

TEST(Status, TimeLimit) {
  Functions slow = support::kojima_shindo();
  slow.F = [F = slow.F](In x, Out out) {
    std::this_thread::sleep_for(5ms);
    return F(x, out);
  };
  const auto mcp = make_mcp(slow);
  for (const double limit : {0.0, 0.02})
    for (const auto& [label, method] : methods({.max_time = std::chrono::duration<double>(limit)})) {
      const Result result = solve(*mcp, Vec::Constant(4, 100), method);
      EXPECT_EQ(result.status, Status::TimeLimit) << label << ": " << result;
      EXPECT_GE(result.stats.time.count(), limit) << label;
      EXPECT_LT(result.stats.F_evals, 50) << label;
      EXPECT_THAT(result.message, HasSubstr("time limit")) << label;
    }
}

TEST(Status, InterruptedByAnObserverKeepsTheBestPoint) {
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const auto& [label, method] : methods())
    for (int last = 0; last < 4; ++last) {
      double best = infinity;
      const Result result = solve(*mcp, Vec::Constant(4, 100), method, [&](const Iteration& it) {
        best = std::min(best, it.residual);
        return it.k == last ? Next::Stop : Next::Continue;
      });
      EXPECT_EQ(result.status, Status::Interrupted) << label << ": " << result;
      EXPECT_EQ(result.stats.iterations, last) << label;
      EXPECT_EQ(result.residual.natural, best) << label;
      EXPECT_LE(support::violation(*mcp, result.x), best * (1 + 1e-15)) << label;
      EXPECT_THAT(result.message, HasSubstr("interrupted after " + std::to_string(last))) << label;
    }
}

// A stop asked for where the solution is reached, too late to matter.
TEST(Status, InterruptedAtASolutionIsSolved) {
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const auto& [label, method] : methods())
    EXPECT_TRUE(solve(*mcp, vec({1, 0, 3, 0}), method, [](const Iteration&) { return Next::Stop; }).solved()) << label;
}

TEST(Status, InterruptedByAFlag) {
  const std::atomic<bool> flag = true;
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const auto& [label, method] : methods({.interrupt = &flag})) {
    const Result result = solve(*mcp, Vec::Ones(4), method);
    EXPECT_EQ(result.status, Status::Interrupted) << label << ": " << result;
    EXPECT_EQ(result.stats.iterations, 0) << label;
  }
  const auto billups = make_mcp(support::billups());  // during an escape
  for (const auto& [label, method] : methods()) {
    const Result result = solve(*billups, vec({0}), method,
                                [](const Iteration& it) { return it.kind == 'E' ? Next::Stop : Next::Continue; });
    EXPECT_EQ(result.status, Status::Interrupted) << label << ": " << result;
  }
}

/// The obstacle problem with 10^4 unknowns, far from its solution: one subproblem of some thousand pivots. `entered` is
/// set at its beginning.
Functions long_subproblem(std::atomic<bool>& entered) {
  Functions functions = support::obstacle(100);
  functions.J = [&entered, J = std::move(functions.J)](In x, SpMat& out) {
    entered = true;
    entered.notify_all();
    return J(x, out);
  };
  return functions;
}

// F is evaluated once, at the start: the run ended within its first subproblem. Catches a flag that is looked at
// between iterations only, so that ^C waits for minutes.
TEST(Status, InterruptedInTheMiddleOfASubproblem) {
  std::atomic<bool> entered = false;
  std::atomic<bool> flag = false;
  const auto mcp = make_mcp(long_subproblem(entered));
  const std::jthread other([&] {
    entered.wait(false);
    std::this_thread::sleep_for(100ms);
    flag = true;
  });
  const Result result =
      solve(*mcp, Vec::Zero(10000), NewtonJosephy{.stop = {.interrupt = &flag}, .subproblem = Subproblem::Lemke});
  EXPECT_EQ(result.status, Status::Interrupted) << result;
  EXPECT_EQ(result.stats.F_evals, 1);
  EXPECT_EQ(result.x, lcp::project(mcp->box(), Vec::Zero(10000)));
}

TEST(Status, TimeLimitInTheMiddleOfASubproblem) {
  std::atomic<bool> entered = false;
  const auto mcp = make_mcp(long_subproblem(entered));
  const Result result =
      solve(*mcp, Vec::Zero(10000), NewtonJosephy{.stop = {.max_time = 150ms}, .subproblem = Subproblem::Lemke});
  EXPECT_EQ(result.status, Status::TimeLimit) << result;
  EXPECT_EQ(result.stats.F_evals, 1);
}

// Catches "not a number" without where, and a start that is answered with other than itself.
TEST(Status, EvaluationFailedAtTheStartNamesTheRow) {
  Functions functions = market(support::kojima_shindo());
  functions.F = [F = functions.F](In x, Out out) {
    F(x, out);
    out[2] = x[2] == 0 ? -infinity : nan;
    return true;
  };
  const auto mcp = make_mcp(functions);
  for (const auto& [label, method] : methods({.check_derivatives = true})) {
    const Result result = solve(*mcp, vec({1, 1, -5, 1}), method);
    EXPECT_EQ(result.status, Status::EvaluationFailed) << label;
    EXPECT_THAT(result.message, AllOf(HasSubstr("oats"), HasSubstr("price[3] = 0"), HasSubstr("is infinite"))) << label;
    EXPECT_EQ(result.x, vec({1, 1, 0, 1})) << label;
    EXPECT_EQ(result.residual.natural, infinity) << label;
  }
  functions.F = [](In, Out out) {
    out[2] = nan;
    return false;
  };
  EXPECT_THAT(solve(*make_mcp(functions), Vec::Ones(4), NewtonJosephy{}).message,
              AllOf(HasSubstr("row oats is NaN"), HasSubstr("price[3] = 1")));
  functions.F = [](In, Out) { return false; };
  EXPECT_THAT(solve(*make_mcp(functions), Vec::Ones(4), NewtonJosephy{}).message,
              HasSubstr("F is not defined at the start"));
}

TEST(Status, EvaluationFailedWhereTheJacobianIsNotDefined) {
  Functions functions = market(support::kojima_shindo());
  functions.J = [J = functions.J](In x, SpMat& out) {
    J(x, out);
    out.coeffRef(1, 3) = 0.5 / std::sqrt(x[3]);
    return true;
  };
  const auto mcp = make_mcp(functions);
  const Result result = solve(*mcp, Vec::Zero(4), path());
  ASSERT_FALSE(result.notes.empty()) << result;
  EXPECT_THAT(result.notes.front(), AllOf(HasSubstr("rye"), HasSubstr("price[4] = 0"), HasSubstr("to price[4] = 1")));
  EXPECT_NE(result.status, Status::EvaluationFailed) << result;
  // At no point at all: there is nowhere to move the start to.
  functions.J = [J = functions.J](In x, SpMat& out) {
    J(x, out);
    out.coeffRef(1, 3) = infinity;
    return true;
  };
  for (const auto& [label, method] : methods({.check_derivatives = true})) {
    const Result failed = solve(*make_mcp(functions), Vec::Zero(4), method);
    EXPECT_EQ(failed.status, Status::EvaluationFailed) << label;
    EXPECT_THAT(failed.message, AllOf(HasSubstr("Jacobian"), HasSubstr("rye"), HasSubstr("price[4]"), HasSubstr("inf")))
        << label;
  }
}

// Logarithms given as functions, at 0: nothing but an infinity tells where they are defined. By hand, x = (1, 2, 1).
// Catches that only models with expressions are moved off their bounds.
TEST(Status, AStartOnABoundOutsideTheDomainIsMoved) {
  Functions functions{.name = "logs", .box = Box::nonnegative(3), .pattern = dense_pattern(3), .F = {}};
  functions.F = [](In x, Out F) {
    F << std::log(x[0]), std::log(x[1]) - std::log(2), x[2] - 1;
    return true;
  };
  functions.J = [](In x, SpMat& J) {
    std::fill(J.valuePtr(), J.valuePtr() + 9, 0.0);
    J.coeffRef(0, 0) = 1 / x[0];
    J.coeffRef(1, 1) = 1 / x[1];
    J.coeffRef(2, 2) = 1;
    return true;
  };
  for (const auto& [label, method] : methods()) {
    const Result result = solve(*make_mcp(functions), Vec::Zero(3), method);
    ASSERT_TRUE(result.solved()) << label << ": " << result;
    EXPECT_LT((result.x - vec({1, 2, 1})).lpNorm<Eigen::Infinity>(), 1e-5) << label;
  }
}

TEST(Status, EvaluationFailedAtEveryTrialPoint) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double x) { return x == 1 ? 1 : nan; }, [](double) { return 1; }));
  for (const auto& [label, method] : methods()) {
    const Result result = solve(*mcp, vec({1}), method);
    EXPECT_EQ(result.status, Status::EvaluationFailed) << label << ": " << result;
    EXPECT_THAT(result.message, AllOf(HasSubstr("not defined at any trial point"), HasSubstr("x[1]"))) << label;
    EXPECT_EQ(result.x, vec({1})) << label;
  }
}

// At the local minimum of billups some trial points fall into a gap of the domain, the others do not descend. Catches
// EvaluationFailed for that, which blames the problem's domain.
TEST(Status, SomeTrialPointsOutsideTheDomainAreNotAllOfThem) {
  for (const double gap : {1e-8, 1e-6, 1e-4, 1e-2}) {
    const auto mcp = make_mcp(support::scalar(
        0, infinity, [gap](double x) { return x > gap && x < 2 * gap ? nan : (x - 1) * (x - 1) - 1.01; },
        [](double x) { return 2 * (x - 1); }));
    for (const auto& [label, method] : methods_without_escape())
      EXPECT_NE(solve(*mcp, vec({0}), method).status, Status::EvaluationFailed) << label << ", " << gap;
  }
}

// billups with a domain that ends just outside the box, where the local minimum of the merit function draws the
// iterates. Catches that no escape is tried from there.
TEST(Status, EscapesFromTheBorderOfTheDomain) {
  for (const double end : {-1e-9, -1e-3, -0.01}) {
    const auto mcp = make_mcp(support::scalar(
        0, infinity, [end](double x) { return x < end ? nan : (x - 1) * (x - 1) - 1.01; },
        [](double x) { return 2 * (x - 1); }));
    for (const auto& [label, method] : methods()) {
      const Result result = solve(*mcp, vec({0}), method);
      EXPECT_TRUE(result.solved()) << label << ", " << end << ": " << result;
    }
  }
}

// No pivots, and no descent at billups' local minimum.
TEST(Status, SubproblemFailed) {
  const auto mcp = make_mcp(support::billups());
  const Result result = solve(*mcp, vec({0}), NewtonJosephy{.lemke = {.max_pivots = 0}});
  EXPECT_EQ(result.status, Status::SubproblemFailed) << result;
  EXPECT_THAT(result.message, AllOf(HasSubstr("linearised problem"), HasSubstr("pivot limit"), HasSubstr("x[1]")));
}

// Problems without a solution, of each of the kinds a person writes by mistake. Catches Solved for any of them, and
// messages without the row to look at.
TEST(Status, InfeasibleProblemsAreNotSolved) {
  const auto affine = [](std::initializer_list<std::initializer_list<double>> M, std::initializer_list<double> q,
                         Box box) {
    return support::affine({support::matrix(M), vec(q), std::move(box)});
  };
  std::vector<Functions> problems;
  problems.push_back(affine({{0, 0}, {0, 1}}, {-1, 1}, Box::nonnegative(2)));
  problems.push_back(affine({{1, 1}, {1, 1}}, {1, 2}, Box::free(2)));            // x + y = -1 = -2
  problems.push_back(affine({{-1, 0}, {0, 1}}, {-1, -1}, Box::nonnegative(2)));  // F_1 < 0 in all of the box
  problems.push_back(support::scalar(
      -infinity, infinity, [](double x) { return std::exp(x) + 1; }, [](double x) { return std::exp(x); }));
  for (const Functions& functions : problems)
    for (const auto& [label, method] : methods()) {
      const auto mcp = make_mcp(functions);
      const Result result = solve(*mcp, Vec::Ones(mcp->size()), method);
      EXPECT_FALSE(result.solved()) << label << ": " << result;
      EXPECT_THAT(statement(result), AllOf(HasSubstr("F["), Not(HasSubstr("nan")))) << label;
    }
}

}  // namespace
}  // namespace perp::ncp
