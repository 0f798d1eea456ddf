// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/kept.hpp"

#include <gtest/gtest.h>

#include "ncp/problem/affine.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Random;
using support::vec;
using By = KeptSolver::By;

/// min 1/2 x'Hx + c'x, 0 <= x <= 1, A x = 1: m equations with free multipliers.
lcp::AffineMcp quadratic_program(Index n, Index m, const Vec& c, Random& random) {
  support::Triplets entries;
  for (Index i = 0; i < n; ++i)
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1 + random.uniform(0, 1));
  for (Index k = 0; k < n; ++k) {
    const int j = random.integer(0, static_cast<int>(m) - 1) + static_cast<int>(n);
    const double a = random.uniform(0.5, 1.5);
    entries.emplace_back(static_cast<int>(k), j, -a);
    entries.emplace_back(j, static_cast<int>(k), a);
  }
  lcp::AffineMcp problem{support::from(n + m, entries), Vec(n + m), Box::free(n + m)};
  problem.q << c, Vec::Constant(m, -1);
  problem.box.lower.head(n).setZero();
  problem.box.upper.head(n).setOnes();
  return problem;
}

/// The solutions of a sequence of programs whose costs wander, each judged, beside those from nothing.
TEST(Kept, SolvesASequenceAsIfEachWereTheFirst) {
  Random random(3);
  KeptSolver kept;
  std::array<int, 4> by{};
  const Vec c = random.normals(40);
  const Vec drift = random.normals(40);
  Random fixed(4);
  const lcp::AffineMcp first = quadratic_program(40, 8, c, fixed);
  for (int k = 0; k < 60; ++k) {
    lcp::AffineMcp problem = first;
    problem.q.head(40) += 0.02 * k * drift;
    const auto mcp = make_affine_mcp(problem, "program");
    const Result& result = kept.solve(*mcp, Vec::Zero(48));
    ASSERT_TRUE(result.solved()) << k << ": " << result;
    ASSERT_LE(residual(*mcp, result.x).natural, 1e-8) << k;
    const Result alone = solve(*mcp, Vec::Zero(48), automatic());
    ASSERT_LT((alone.x.head(40) - result.x.head(40)).norm(), 1e-6) << k;
    ++by[static_cast<std::size_t>(kept.by())];
  }
  EXPECT_EQ(by[static_cast<std::size_t>(By::Anew)], 1);
  EXPECT_GT(by[static_cast<std::size_t>(By::Kept)], 20);
  EXPECT_GT(by[static_cast<std::size_t>(By::Exchanges)], 2);
}

/// x_i (1 + x_i^2) - s - i/10 on [0, 1]: a strictly monotone problem with parameter s.
std::unique_ptr<Mcp> shifted_cubic(double s) {
  SpMat identity(10, 10);
  identity.setIdentity();
  return make_mcp({.name = "cubic",
                   .box = {Vec::Zero(10), Vec::Ones(10)},
                   .pattern = identity,
                   .F =
                       [s](In x, Out F) {
                         for (Index i = 0; i < 10; ++i)
                           F[i] = x[i] * (1 + x[i] * x[i]) - s - 0.1 * static_cast<double>(i);
                         return true;
                       },
                   .J =
                       [](In x, SpMat& J) {
                         for (Index i = 0; i < 10; ++i) J.valuePtr()[i] = 1 + 3 * x[i] * x[i];
                         return true;
                       }});
}

// Nonlinear ones: Newton steps, few of them, whichever bounds are met or left on the way. Catches a Jacobian that stays
// that of the last problem.
TEST(Kept, NewtonStepsOnTheLastActiveSet) {
  KeptSolver kept(path());
  for (const double s : {0.3, 0.32, 0.34, 0.9, 1.2, -0.5, -0.5001, 0.3}) {
    const auto mcp = shifted_cubic(s);
    const Result& result = kept.solve(*mcp, Vec::Zero(10));
    ASSERT_TRUE(result.solved()) << s;
    ASSERT_LE(residual(*mcp, result.x).natural, 1e-8) << s;
    EXPECT_LE(result.stats.iterations, 14) << s;
  }
  (void)kept.solve(*shifted_cubic(0.3001), Vec::Zero(10));
  EXPECT_EQ(kept.by(), By::Kept);
}

// Another size, another pattern, other kinds of bounds, and a problem without a solution in between: the solver is as
// good as new.
TEST(Kept, TakesWhatComes) {
  KeptSolver kept;
  Random random(5);
  const auto program = make_affine_mcp(quadratic_program(12, 3, random.normals(12), random), "program");
  EXPECT_TRUE(kept.solve(*program, Vec::Zero(15)).solved());
  EXPECT_TRUE(kept.solve(*shifted_cubic(0.3), Vec::Zero(10)).solved());
  EXPECT_EQ(kept.by(), By::Anew);
  SpMat one(1, 1);
  one.insert(0, 0) = 1;
  const auto scalar = [&one](double q, double lower, double upper) {
    return make_affine_mcp({one, vec({q}), {vec({lower}), vec({upper})}}, "scalar");
  };
  EXPECT_DOUBLE_EQ(kept.solve(*scalar(1, 0, infinity), Vec::Zero(1)).x[0], 0);
  EXPECT_DOUBLE_EQ(kept.solve(*scalar(1, -infinity, infinity), Vec::Zero(1)).x[0], -1);
  EXPECT_DOUBLE_EQ(kept.solve(*scalar(1, 2, 2), Vec::Zero(1)).x[0], 2);
  EXPECT_DOUBLE_EQ(kept.solve(*scalar(-3, 0, 2), Vec::Zero(1)).x[0], 2);
  SpMat zero = one;
  zero.coeffRef(0, 0) = 0;
  const auto none = make_affine_mcp({zero, vec({1}), Box::free(1)}, "none");
  EXPECT_EQ(kept.solve(*none, Vec::Zero(1)).status, Status::Infeasible);
  EXPECT_DOUBLE_EQ(kept.solve(*scalar(-3, 0, infinity), Vec::Zero(1)).x[0], 3);
  EXPECT_EQ(kept.by(), By::Anew);
}

}  // namespace
}  // namespace perp::ncp
