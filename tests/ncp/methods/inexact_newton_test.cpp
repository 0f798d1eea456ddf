// SPDX-License-Identifier: Apache-2.0
/// Large problems: inexact semismooth Newton (Dembo, Eisenstat & Steihaug 1982; Eisenstat & Walker 1996; Facchinei &
/// Kanzow 1997) beside the direct one, and Newton-Josephy by quadratic programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "collection/collection.hpp"
#include "collection/scalable/generators.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using ::testing::HasSubstr;

SemismoothNewton inexact() { return SemismoothNewton{.linear = LinearSolver::Krylov}; }
SemismoothNewton direct() { return SemismoothNewton{.linear = LinearSolver::Direct}; }

template <class Method>
Method to(double tol, Method method) {
  method.stop.tol = tol;
  return method;
}

// Both stop at residuals of 1e-13 and so agree far better than 1e-8. Catches: a solution that is another's, a Krylov
// residual that is not the Newton system's.
TEST(InexactNewton, AgreesWithTheDirectMethodOnEveryGridProblem) {
  for (const auto make : {collection::obstacle, collection::bratu_own, collection::journal_bearing, collection::torsion,
                          collection::american_put_own}) {
    const collection::Problem problem = make(40, 40);
    const Result one = solve(*problem.mcp, problem.starts[0], to(1e-13, inexact()));
    const Result other = solve(*problem.mcp, problem.starts[0], to(1e-13, direct()));
    ASSERT_TRUE(one.solved()) << problem.mcp->name() << one;
    ASSERT_TRUE(other.solved()) << problem.mcp->name() << other;
    EXPECT_LT((one.x - other.x).lpNorm<Eigen::Infinity>(), 1e-8) << problem.mcp->name();
    EXPECT_EQ(one.stats.factorizations, 0) << problem.mcp->name();
    EXPECT_GT(one.stats.krylov_iterations, 0) << problem.mcp->name();
    EXPECT_EQ(other.stats.krylov_iterations, 0) << problem.mcp->name();
  }
}

// r_{k+1} <= C r_k^2 from the first small residual on, with alpha = 2 and no chord steps: Bratu's problem, whose
// solution is strictly complementary. The tolerance is out of reach of the forcing terms' floor. Catches: forcing terms
// that are not passed on, or capped.
TEST(InexactNewton, ConvergesQuadratically) {
  const collection::Problem problem = collection::bratu_own(25, 25);
  SemismoothNewton method = to(1e-13, inexact());
  method.forcing.chord_steps = 0;
  std::vector<Iteration> records;
  ASSERT_TRUE(solve(*problem.mcp, problem.starts[0], method, record(records)).solved());
  int pairs = 0;
  for (std::size_t k = 1; k + 1 < records.size(); ++k) {
    const double r = records[k].residual;
    if (r > 1e-4 || r < 1e-9) continue;
    ++pairs;
    EXPECT_GT(std::log(records[k + 1].residual) / std::log(r), 1.3) << k;
    EXPECT_EQ(records[k + 1].step, 1);
    EXPECT_EQ(records[k + 1].linear, 'K');
  }
  EXPECT_GE(pairs, 1);
}

// Chord steps: fewer Newton steps for the same answer, each counted. Catches: steps that are not used, or believed
// without a look at the merit.
TEST(InexactNewton, ChordStepsSpareNewtonSteps) {
  const collection::Problem problem = collection::bratu_own(40, 40);
  SemismoothNewton with = to(1e-10, inexact());
  with.cfunction = natural_min();
  SemismoothNewton without = with;
  without.forcing.chord_steps = 0;
  const Result fast = solve(*problem.mcp, problem.starts[0], with);
  const Result plain = solve(*problem.mcp, problem.starts[0], without);
  ASSERT_TRUE(fast.solved()) << fast;
  ASSERT_TRUE(plain.solved()) << plain;
  EXPECT_LT(fast.stats.iterations, plain.stats.iterations);
  EXPECT_GT(fast.stats.chord_steps, 0);
  EXPECT_EQ(plain.stats.chord_steps, 0);
  EXPECT_LT((fast.x - plain.x).lpNorm<Eigen::Infinity>(), 1e-7);
}

// x^3 = 2 in the unit 1e12, where x - F is x as soon as F is below 1e-4. Chord steps go on all the same until F meets
// the tolerance, and the Jacobian is evaluated where they end. Catches: a residual that loses F beside a large x.
TEST(InexactNewton, ChordStepsSeeSmallResidualsBesideLargeVariables) {
  constexpr double unit = 1e12;
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::pow(x / unit, 3) - 2; },
      [](double x) { return 3 / unit * std::pow(x / unit, 2); }));
  SemismoothNewton method = to(1e-12, inexact());
  method.descent_rho = 1e-40;  // the gradient's unit is 1e-12, the direction's 1e12
  method.forcing.chord_steps = 20;
  const Result result = solve(*mcp, support::vec({1.5 * unit}), method);
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_EQ(result.stats.iterations, 1);
  EXPECT_NEAR(result.x[0] / unit, std::cbrt(2), 1e-12);
}

/// The first-order conditions of  min 1/2 v'Qv - 3 sum v_j sin j + 1/4 sum v^4,  v_j + v_{j+1} >= 0.3 for every fourth
/// j,  Q = the five-point Laplacian plus 1/10 on an N x N grid: J has no diagonal in the multipliers' rows.
Functions saddle_point(int N) {
  const Functions grid = support::obstacle(N);
  const Index n = static_cast<Index>(N) * N;
  const Index m = n / 4;
  support::Triplets entries;
  for (int j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(grid.pattern, j); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), j, it.value() + (it.row() == j ? 0.1 : 0));
  for (int k = 0; k < m; ++k)
    for (const int j : {4 * k, 4 * k + 1}) {
      entries.emplace_back(static_cast<int>(n) + k, j, 1);
      entries.emplace_back(j, static_cast<int>(n) + k, -1);
    }
  const SpMat M = support::from(n + m, entries);
  Box box = Box::free(n + m);
  box.lower.tail(m).setZero();
  return {.name = "saddle point",
          .box = box,
          .pattern = M,
          .F =
              [M, n, m](In x, Out F) {
                F = M * x;
                for (Index j = 0; j < n; ++j) F[j] += x[j] * x[j] * x[j] - 3 * std::sin(static_cast<double>(j));
                F.tail(m).array() -= 0.3;
                return true;
              },
          .J =
              [M, n](In x, SpMat& J) {
                J = M;
                for (Index i = 0; i < n; ++i) J.coeffRef(i, i) += 3 * x[i] * x[i];
                return true;
              }};
}

// Multipliers at zero and above, n + m = 2000. Catches: Newton systems of which the multipliers' rows are lost, so that
// LU has to take over.
TEST(InexactNewton, SaddlePointsNeedNoLu) {
  const auto mcp = make_mcp(saddle_point(40));
  const Result one = solve(*mcp, Vec::Ones(2000), to(1e-10, inexact()));
  const Result other = solve(*mcp, Vec::Ones(2000), to(1e-10, direct()));
  ASSERT_TRUE(one.solved()) << one;
  ASSERT_TRUE(other.solved()) << other;
  EXPECT_EQ(one.stats.factorizations, 0) << one;
  EXPECT_LT((one.x - other.x).lpNorm<Eigen::Infinity>(), 1e-7);
  const auto active = (other.x.tail(400).array() > 1e-6).count();
  EXPECT_GT(active, 50);
  EXPECT_LT(active, 350);
}

// 40 000 unknowns, not symmetric, in 0.05 s: the run ends with the linear solve it is in, by no factorization and
// without a verdict on the problem. Catches: Krylov solves and fallbacks that do not look at the clock.
TEST(InexactNewton, EndsAtItsTimeLimitInsideALinearSolve) {
  Functions functions = support::obstacle(200, 100);
  for (Index j = 0; j + 1 < functions.pattern.cols(); ++j) functions.pattern.coeffRef(j + 1, j) -= 0.9;
  functions.pattern.makeCompressed();
  const SpMat M = functions.pattern;
  functions.box = Box::nonnegative(M.rows());
  functions.F = [M](In x, Out F) {
    F = M * x - Vec::Ones(x.size());
    return true;
  };
  functions.J = [M](In, SpMat& J) {
    J = M;
    return true;
  };
  const auto mcp = make_mcp(functions);
  SemismoothNewton method = to(1e-13, inexact());
  method.stop.max_iterations = 1;
  const Result once = solve(*mcp, Vec::Ones(M.rows()), method);
  method.stop.max_iterations = 500;
  method.stop.max_time = std::chrono::duration<double>(0.05);
  const Result cut = solve(*mcp, Vec::Ones(M.rows()), method);
  EXPECT_EQ(cut.status, Status::TimeLimit) << cut;
  EXPECT_EQ(cut.stats.factorizations, 0);
  EXPECT_LT(cut.stats.time.count(), 2 * once.stats.time.count() + 0.3);
}

// The whole collection, whose Newton systems are anything but elliptic: what BiCGSTAB cannot solve LU must, and the
// answer says so. Catches: a fallback that is not there, or silent.
TEST(InexactNewton, FallsBackToLuAndSaysSo) {
  int remarks = 0;
  for (const char* name : {"kojshin", "josephy", "nash10", "hs34-kkt", "hs76-kkt", "walras-own", "murty", "fathi",
                           "hydroc06", "methan08", "geiger-kanzow"}) {
    const collection::Entry* entry = collection::find(name);
    ASSERT_NE(entry, nullptr) << name;
    const collection::Problem problem = entry->make();
    SemismoothNewton method = inexact();
    method.forcing.max_iterations = 5;
    for (const Vec& x0 : problem.starts) {
      const Result by_lu = solve(*problem.mcp, x0, direct());
      std::vector<Iteration> records;
      const Result result = solve(*problem.mcp, x0, method, record(records));
      EXPECT_TRUE(result.solved() || !by_lu.solved()) << name << ": " << result;
      const bool fell = std::any_of(records.begin(), records.end(), [](const auto& it) { return it.linear == 'D'; });
      if (fell) {
        EXPECT_THAT(result.message, HasSubstr("LU took over")) << name;
        EXPECT_GT(result.stats.factorizations, 0) << name;
        ++remarks;
      }
    }
  }
  EXPECT_GT(remarks, 0);
}

TEST(InexactNewton, RefusesForcingTermsThatAreNone) {
  const auto why = [](auto change) {
    SemismoothNewton method;
    change(method.forcing);
    return invalid(method).value_or("");
  };
  EXPECT_THAT(why([](Forcing& f) { f.chord_steps = -1; }), HasSubstr("chord_steps is -1"));
}

// Newton-Josephy by quadratic programs finds what pivoting finds, on symmetric problems; where J is not symmetric it
// pivots. Catches: a program of another problem, a refusal in place of a fallback.
TEST(JosephyByQp, AgreesWithPivoting) {
  for (const auto make :
       {collection::obstacle, collection::bratu_own, collection::torsion, collection::american_put_own}) {
    const collection::Problem problem = make(15, 20);
    const Result one =
        solve(*problem.mcp, problem.starts[0], NewtonJosephy{.stop = {.tol = 1e-12}, .subproblem = Subproblem::Qp});
    const Result other =
        solve(*problem.mcp, problem.starts[0], NewtonJosephy{.stop = {.tol = 1e-12}, .subproblem = Subproblem::Lemke});
    ASSERT_TRUE(one.solved()) << one;
    ASSERT_TRUE(other.solved()) << other;
    EXPECT_LT((one.x - other.x).lpNorm<Eigen::Infinity>(), 1e-9) << problem.mcp->name();
  }
}

// Auto takes the program for large problems only, and the records say which it was.
TEST(JosephyByQp, IsTakenForLargeSymmetricProblems) {
  for (const Index n : {30, 50}) {
    const collection::Problem problem = collection::bratu_own(n, n);
    std::vector<Iteration> records;
    ASSERT_TRUE(solve(*problem.mcp, problem.starts[0], NewtonJosephy{}, record(records)).solved());
    ASSERT_GE(records.size(), 2u);
    EXPECT_EQ(records[1].linear, n == 50 ? 'Q' : ' ');
  }
}

}  // namespace
}  // namespace perp::ncp
