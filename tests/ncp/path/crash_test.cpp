// SPDX-License-Identifier: Apache-2.0
/// Dirkse & Ferris 1997: projected Newton steps before anything is pivoted.
#include <gtest/gtest.h>

#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::expect_solution;
using support::expect_solved;
using support::Random;
using support::vec;

// The obstacle problem by crash alone, each factorization with many changes of the active set: PATH 4.7 takes 3 for
// 16 x 16, and 39 pivots without. Catches a crash that changes one variable a step, or stops too early.
TEST(Crash, SolvesTheObstacleProblemAlone) {
  for (const int N : {4, 16, 32}) {
    const auto mcp = make_mcp(support::obstacle(N));
    const Result result = expect_solved(*mcp, Vec::Zero(N * N), path());
    EXPECT_EQ(result.stats.pivots, 0) << N;
    EXPECT_EQ(result.stats.iterations, 0) << N;
    EXPECT_LE(result.stats.crash_iterations, 6) << N;
    EXPECT_LE(result.stats.J_evals, 20) << N;
  }
}

// A P-problem with a cubic term: crash is Newton's method once the active set is found.
TEST(Crash, NeverLeavesTheBoxAndNeverClimbs) {
  Random random(1);
  for (int k = 0; k < 30; ++k) {
    const auto [functions, solution] = support::planted(10, 0.3, random);
    const auto mcp = make_mcp(functions);
    double merit = infinity;
    expect_solution(*mcp, 10 * random.normals(10), path(), solution, 1e-3, "");
    solve(*mcp, 10 * random.normals(10), path(), [&](const Iteration& it) {
      if (it.kind == 'C') {
        EXPECT_EQ(lcp::project(mcp->box(), *it.x), *it.x);
        EXPECT_LT(it.merit, merit);
      }
      if (it.k == 0) merit = it.merit;
      return Next::Continue;
    });
  }
}

// Each limit ends it. Catches options that are not looked at.
TEST(Crash, EndsAtItsLimits) {
  const auto mcp = make_mcp(support::obstacle(16));
  const auto crash_steps = [&](const Crash& crash) {
    const Result result = expect_solved(*mcp, Vec::Zero(256), path({.crash = crash}));
    return result.stats.crash_iterations;
  };
  const int all = crash_steps({});
  EXPECT_GT(all, 1);
  EXPECT_EQ(crash_steps({.iteration_limit = 1}), 1);
  EXPECT_EQ(crash_steps({.iteration_limit = 0}), 0);
  EXPECT_EQ(crash_steps({.minimum_dimension = 257}), 0);
  EXPECT_EQ(crash_steps({.minimum_dimension = 256}), all);
  EXPECT_EQ(crash_steps({.nbchange_limit = 257}), 1);
  EXPECT_EQ(crash_steps({.on = false}), 0);
}

// J_II is singular at the start: x y with a zero row. Catches a step of infinities, and a crash that ends the run.
TEST(Crash, PassesASingularMatrix) {
  const auto mcp = make_mcp(support::dense(
      "singular", Box::nonnegative(2),
      [](const Vec& x) {
        return vec({x[0] * x[0] + x[1] * x[1] - 2, x[0] + x[1] - 2});
      },
      [](const Vec& x) {
        Dense J(2, 2);
        J << 2 * x[0], 2 * x[1], 1, 1;
        return J;
      }));
  expect_solved(*mcp, vec({0.5, 0.5}), path());
  expect_solved(*mcp, vec({0, 0}), path());
}

/// Steps of the crash on M z + q = 0, as it is given, without a proximal term.
int plain_steps(const Dense& M, const Vec& q) {
  int steps = 0;
  const auto mcp = make_affine_mcp({support::sparse(M), q, Box::free(q.size())}, "linear equations");
  solve(*mcp, Vec::Zero(q.size()), PathSearch{}, [&](const Iteration& it) {
    steps += it.kind == 'C' && it.prox == 0 ? 1 : 0;
    return Next::Continue;
  });
  return steps;
}

// Small pivots come of small units, or of columns that are equal but for the last digit. Catches a crash that takes
// the first for singular, and one that takes a step of 1e15 along the second.
TEST(Crash, TellsOtherUnitsFromASingularMatrix) {
  for (const double unit : {1.0, 1e-13, 1e13}) {
    Dense M(2, 2);
    M << 1, unit, 1, 3 * unit;
    EXPECT_EQ(plain_steps(M, vec({-2, -1})), 1) << unit;
  }
  for (const double unit : {1.0, 1e-13}) {
    Dense M(2, 2);
    M << 1, unit, 1, (1 + 0x1p-50) * unit;
    EXPECT_EQ(plain_steps(M, vec({-2, -1})), 0) << unit;
  }
}

// First-order conditions of min c'x with A log x >= b, 0.1 <= x <= 10: where the multipliers are 0, so is the Hessian,
// and J_II has rank 12 of 26. Munson (2000) keeps a proximal term from there on. Catches a path search that begins
// without one, and follows long paths from singular bases.
TEST(Crash, LeavesAProximalTermWhereJStaysSingular) {
  constexpr Index n = 20;
  constexpr Index m = 6;
  Dense A(m, n);
  for (Index k = 0; k < m; ++k)
    for (Index i = 0; i < n; ++i) A(k, i) = static_cast<double>((i * (k + 2)) % 11);
  const Vec c = Vec::LinSpaced(n, 1, 3);
  const Vec b = Vec::LinSpaced(m, 5, 30);
  Box box = Box::nonnegative(n + m);
  box.lower.head(n).setConstant(0.1);
  box.upper.head(n).setConstant(10);
  const auto mcp = make_mcp(support::dense(
      "logarithms", box,
      [=](const Vec& z) {
        const Vec x = z.head(n);
        Vec F(n + m);
        F.head(n) = c - (A.transpose() * z.tail(m)).cwiseQuotient(x);
        F.tail(m) = A * x.array().log().matrix() - b;
        return F;
      },
      [=](const Vec& z) {
        const Vec x = z.head(n);
        Dense J = Dense::Zero(n + m, n + m);
        J.diagonal().head(n) = (A.transpose() * z.tail(m)).cwiseQuotient(x.cwiseProduct(x));
        J.topRightCorner(n, m) = -(x.cwiseInverse().asDiagonal() * A.transpose());
        J.bottomLeftCorner(m, n) = A * x.cwiseInverse().asDiagonal();
        return J;
      }));
  int proximal = 0;
  Index pivots = 0;  // 129 where the terms came last
  for (const double start : {0.5, 1.0}) {
    Vec z0 = Vec::Zero(n + m);
    z0.head(n).setConstant(start);
    const Result result = expect_solved(*mcp, z0, path());
    proximal += result.stats.proximal_steps;
    pivots += result.stats.pivots;
  }
  EXPECT_LE(pivots, 80);
  EXPECT_GE(proximal, 1);
}

// min x'D x / 2 + c'x, A x = b, 0 <= x <= 1: where more x are at bounds than A has columns to spare, J_II is singular.
// Catches a term so small that the step leads nowhere, and all of the active set is pivoted for: 2615 pivots then, 1143
// now.
TEST(Crash, GoesOnWhereMultipliersMakeTheMatrixSingular) {
  Random random(4);
  Index pivots = 0;
  for (int k = 0; k < 20; ++k) {
    constexpr Index n = 60;
    constexpr Index m = 25;
    Dense A = Dense::Zero(m, n);
    for (Index j = 0; j < n; ++j)
      for (int e = 0; e < 3; ++e) A(random.integer(0, m - 1), j) += random.normals(1)[0];
    Dense J = Dense::Zero(n + m, n + m);
    J.diagonal().head(n) = random.normals(n).cwiseAbs();
    J.topRightCorner(n, m) = -A.transpose();
    J.bottomLeftCorner(m, n) = A;
    Vec q(n + m);
    q << 2 * random.normals(n), -A * Vec::Constant(n, 0.4);
    Box box = Box::free(n + m);
    box.lower.head(n).setZero();
    box.upper.head(n).setOnes();
    const auto mcp = make_affine_mcp({J.sparseView(), q, box}, "program");
    pivots += expect_solved(*mcp, Vec::Zero(n + m), path()).stats.pivots;
  }
  EXPECT_LE(pivots, 1800);
}

// The steps of a crash fall under the run's limits. Catches a crash that goes on after ^C.
TEST(Crash, ObeysTheObserver) {
  const auto mcp = make_mcp(support::obstacle(16));
  const Result result = solve(*mcp, Vec::Zero(256), path(),
                              [](const Iteration& it) { return it.kind == 'C' ? Next::Stop : Next::Continue; });
  EXPECT_EQ(result.status, Status::Interrupted) << result;
  EXPECT_EQ(result.stats.crash_iterations, 1);
}

// F or J undefined where a step of the crash leads: shorter steps, or the path search from where it came to.
TEST(Crash, StaysInTheDomain) {
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    auto [functions, solution] = support::planted(6, 0, random);
    const double radius = 1 + 1.5 * solution.norm();
    const bool in_J = k % 2 == 0;
    functions.F = [F = functions.F, radius, in_J](In x, Out out) { return (in_J || x.norm() < radius) && F(x, out); };
    functions.J = [J = functions.J, radius](In x, SpMat& out) { return x.norm() < radius && J(x, out); };
    const auto mcp = make_mcp(functions);
    Vec x0 = lcp::project(mcp->box(), solution + random.normals(6));
    if (x0.norm() >= radius) x0 = solution;
    expect_solution(*mcp, x0, path(), solution, 1e-6);
  }
}

/// min 1/2 x' D x + c' x, 0 <= x <= 1, A x >= b or = b, with half as many rows as variables, and D > 0 diagonal, or 0
/// unless `curved`: where more rows than variables are off their bounds, J_II is singular.
lcp::AffineMcp program(Index n, bool curved, Random& random) {
  const Index m = n / 2;
  Dense M = Dense::Zero(n + m, n + m);
  Vec q = 2 * random.normals(n + m);
  lcp::Box box = lcp::Box::free(n + m);
  box.lower.head(n).setZero();
  box.upper.head(n).setOnes();
  const Vec d = (curved ? 1 : 0) * random.normals(n).cwiseAbs();
  M.topLeftCorner(n, n) = Dense(d.asDiagonal());
  for (Index i = 0; i < m; ++i) {
    Vec a = Vec::Zero(n);
    for (int k = 0; k < 6; ++k) a[(7 * i + 11 * k * k + i * k) % n] = random.normals(1)[0];
    M.row(n + i).head(n) = a;
    M.col(n + i).head(n) = -a;
    q[n + i] = -a.dot(Vec::Constant(n, 0.5));  // x = 1/2 is feasible
    if (i % 2 == 0) box.lower[n + i] = 0;
  }
  return {support::sparse(M), q, box};
}

// Strictly convex programs: a path from a basis that had to be repaired takes up to 1.5 n pivots, although the crash
// has found nearly all of the active set; problems with proximal terms O(||Phi||) take a few each (Fan & Yuan 2005).
// Catches a crash that gives up while many variables change their places, and such a path.
TEST(Crash, QuadraticProgramsAreLeftFewPivots) {
  Random random(1);
  Index pivots = 0;
  Index rows = 0;
  for (int k = 0; k < 30; ++k) {
    const auto mcp = make_affine_mcp(program(40 + 2 * k, true, random), "program");
    const Result result = expect_solved(*mcp, Vec::Zero(mcp->size()), path());
    EXPECT_LE(result.stats.iterations, 6);
    pivots += result.stats.pivots;
    rows += mcp->size();
  }
  EXPECT_LE(10 * pivots, 3 * rows) << pivots << " pivots, " << rows << " rows";
}

// Linear programs: a step of 1e-4 changes the active set, and long ones follow it. There are 4,347 pivots in all
// without such steps, 3,748 with them. Catches a search that ends before them.
TEST(Crash, TinyStepsHelpLinearPrograms) {
  Random random(1);
  Index pivots = 0;
  for (int k = 0; k < 30; ++k) {
    const auto mcp = make_affine_mcp(program(40 + 2 * k, false, random), "program");
    pivots += expect_solved(*mcp, Vec::Zero(mcp->size()), path()).stats.pivots;
  }
  EXPECT_LE(pivots, 4050);
}

}  // namespace
}  // namespace perp::ncp
