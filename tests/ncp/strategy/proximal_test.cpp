// SPDX-License-Identifier: Apache-2.0
/// Proximal escapes (Billups 1995; Billups & Ferris 1997): QPCOMP, PROXI and SEMICOMP solve what their bases do not.
#include "ncp/strategy/proximal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;

std::vector<support::NamedMethod> systems(const Escape& escape, const Stop& stop = {}) {
  return {{"NE/SQP", escaping(MinNewton{.stop = stop, .direction = MinNewton::Direction::ConvexQp}, escape)},
          {"min-Newton", escaping(MinNewton{.stop = stop, .direction = MinNewton::Direction::Newton}, escape)},
          {"semismooth", escaping(SemismoothNewton{.stop = stop}, escape)}};
}

const double billups_solution = 1 + std::sqrt(1.01);

// The reason they exist: Billups' problem from 0, by all three and by none of their bases.
TEST(ProximalEscape, BillupsFromZeroByTheThreeSystemsAndNoneOfTheirBases) {
  const auto mcp = make_mcp(support::billups());
  for (const auto& [label, method] : systems({.rounds = 0})) {
    const Result result = solve(*mcp, vec({0}), method);
    EXPECT_FALSE(result.solved()) << label << result;
    EXPECT_THAT(result.status, testing::AnyOf(Status::StationaryPoint, Status::NoProgress)) << label;
  }
  for (const auto& [label, method] : systems(Escape{})) {
    const Result result = support::expect_solution(*mcp, vec({0}), method, vec({billups_solution}), 1e-7, label);
    EXPECT_THAT(result.message, testing::HasSubstr("proximal escape")) << label;
  }
}

// As the papers have it: the base goes on only from centres with a smaller residual of the problem itself, and lambda
// stays. The centres must climb over the hill of the merit function at x = 1.
TEST(ProximalEscape, CentresAloneLeadOut) {
  const auto mcp = make_mcp(support::billups());
  for (const auto& [label, method] : systems({.rounds = 200, .trial_iterations = 0}))
    support::expect_solution(*mcp, vec({0}), method, vec({billups_solution}), 1e-7, label);
}

// At lambda = 1e-6 ||J|| the perturbed problem has the same local minimum: lambda must grow until it is solved.
TEST(ProximalEscape, LambdaGrowsUntilThePerturbedProblemIsSolved) {
  const auto mcp = make_mcp(support::billups());
  for (const auto& [label, method] : systems({.lambda = 1e-2}))
    support::expect_solution(*mcp, vec({0}), method, vec({billups_solution}), 1e-7, label);
}

// Kojima & Shindo's from 0 holds NE/SQP at a point with residual 3/2. Catches escapes that work in one dimension only.
TEST(ProximalEscape, KojimaShindo) {
  for (const bool josephy : {false, true}) {
    const auto mcp = make_mcp(support::kojima_shindo(josephy));
    EXPECT_EQ(solve(*mcp, Vec::Zero(4), MinNewton{.direction = MinNewton::Direction::ConvexQp}).status,
              Status::StationaryPoint);
    for (const auto& [label, method] : systems(Escape{}))
      for (const Vec& x0 : support::kojima_shindo_starts()) {
        const Result result = support::expect_solved(*mcp, x0, method, label);
        EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << label << result.x.transpose();
      }
  }
}

// What a reader sees: the base's records, then one E a move with its lambda and the residual there, counted on; the
// first says what begins.
TEST(ProximalEscape, RecordsTellTheMoves) {
  const auto mcp = make_mcp(support::billups());
  for (const auto& [label, method] : systems({.lambda = 2})) {
    std::vector<Iteration> records;
    const Result result = solve(*mcp, vec({0}), method, record(records));
    std::vector<double> lambda;
    int k = -1;
    for (const Iteration& it : records) {
      EXPECT_GE(it.k, k) << label;
      k = it.k;
      EXPECT_EQ(it.attempt, it.kind == 'E' && lambda.empty() ? "proximal escape" : "") << label;
      if (it.kind == 'E') lambda.push_back(it.prox);
    }
    ASSERT_FALSE(lambda.empty()) << label;
    EXPECT_NEAR(lambda[0], 2 * 2, 0.1) << label;  // J = 2 (x - 1) at x near 0
    EXPECT_LE(records.back().k, result.stats.iterations) << label;
    EXPECT_LE(records.back().residual, 1e-8) << label;
    std::ostringstream table;
    solve(*mcp, vec({0}), method, print_table(table, *mcp));
    EXPECT_THAT(table.str(), testing::HasSubstr("proximal escape")) << label;
  }
}

// (x - 1)^2 + 1 = 0 has no real solution. The rounds must end, and not in a point called a solution.
TEST(ProximalEscape, EndsWhereThereIsNoSolution) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return (x - 1) * (x - 1) + 1; }, [](double x) { return 2 * (x - 1); }));
  for (const auto& [label, method] : systems(Escape{})) {
    const Result result = solve(*mcp, vec({3}), method);
    EXPECT_FALSE(result.solved()) << label;
    EXPECT_GE(result.residual.natural, 1 - 1e-9) << label;  // min F = 1
    EXPECT_FALSE(result.advice.empty()) << label;
  }
}

// Limits hold over the base, the perturbed problems and the trials together.
TEST(ProximalEscape, LimitsAndInterruptsInsideEscapes) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return (x - 1) * (x - 1) + 1; }, [](double x) { return 2 * (x - 1); }));
  for (const auto& [label, method] : systems({.rounds = 1000}, {.max_iterations = 100})) {
    const Result result = solve(*mcp, vec({3}), method);
    EXPECT_FALSE(result.solved()) << label;
    EXPECT_LE(result.stats.iterations, 100) << label;
  }
  const auto billups = make_mcp(support::billups());
  for (const auto& [label, method] : systems(Escape{})) {  // evaluations too, and the verdict says so
    Method limited = method;
    stop(limited).max_F_evals = 50;
    const Result result = solve(*billups, vec({0}), limited);
    EXPECT_TRUE(result.solved() || result.status == Status::IterationLimit) << label << result;
    EXPECT_LT(result.stats.F_evals, 50 + 100) << label;
  }
  for (const auto& [label, method] : systems(Escape{})) {
    const Result observed = solve(*billups, vec({0}), method,
                                  [](const Iteration& it) { return it.kind == 'E' ? Next::Stop : Next::Continue; });
    EXPECT_EQ(observed.status, Status::Interrupted) << label << observed;
    EXPECT_FALSE(observed.solved()) << label;
  }
  // By the flag, set at the first escape: the run after it has to see it.
  for (const auto& [label, method] : systems(Escape{})) {
    std::atomic<bool> flag = false;
    Method flagged = method;
    stop(flagged).interrupt = &flag;
    const Result result = solve(*billups, vec({0}), flagged, [&flag](const Iteration& it) {
      if (it.kind == 'E') flag = true;
      return Next::Continue;
    });
    EXPECT_EQ(result.status, Status::Interrupted) << label << result;
  }
}

// (F + lambda (x - c)) / lambda and its Jacobian, with lambda <= 1 undivided; also where the pattern lacks diagonal
// entries; names are the base's.
TEST(ProximalMcp, AddsItsTermToEveryRow) {
  support::Dense M(2, 2);
  M << 0, -1, 1, 0;
  const auto base = make_mcp(support::affine({.M = M.sparseView(), .q = vec({1, 2}), .box = Box::nonnegative(2)}));
  const ProximalMcp mcp(*base, 3, vec({1, -1}));
  EXPECT_EQ(mcp.jacobian_pattern().nonZeros(), 4);
  Vec F(2);
  ASSERT_TRUE(mcp.eval(vec({2, 5}), F));
  EXPECT_LT((3 * F - vec({1 - 5 + 3 * 1, 2 + 2 + 3 * 6})).norm(), 1e-14);
  ASSERT_TRUE(ProximalMcp(*base, 0.5, vec({1, -1})).eval(vec({2, 5}), F));
  EXPECT_EQ(F, vec({1 - 5 + 0.5 * 1, 2 + 2 + 0.5 * 6}));
  EXPECT_EQ(describe(mcp, check_jacobian(mcp, vec({2, 5}))), "");
  EXPECT_EQ(mcp.variable_name(1), base->variable_name(1));
}

}  // namespace
}  // namespace perp::ncp
