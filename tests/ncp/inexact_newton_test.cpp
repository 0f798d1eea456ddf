/// Large problems: inexact semismooth Newton (Dembo, Eisenstat & Steihaug 1982; Eisenstat & Walker 1996; Facchinei &
/// Kanzow 1997) beside the direct one, and Newton-Josephy by quadratic programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ncp/collection/generators.hpp"
#include "ncp/solve.hpp"
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

// The whole collection, whose Newton systems are anything but elliptic: what BiCGSTAB cannot solve LU must, and the
// answer says so. Catches: a fallback that is not there, or silent.
TEST(InexactNewton, FallsBackToLuAndSaysSo) {
  int remarks = 0;
  for (const char* name : {"kojshin", "josephy", "nash10", "hs34-kkt", "hs76-kkt", "walras-own", "murty", "fathi",
                           "hydroc06", "methan08", "geiger-kanzow"}) {
    const collection::Entry* entry = collection::find(name);
    if (entry == nullptr) continue;
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
  EXPECT_THAT(why([](Forcing& f) { f.eta_max = 1; }), HasSubstr("eta_max is 1"));
  EXPECT_THAT(why([](Forcing& f) { f.gamma = 0; }), HasSubstr("gamma is 0"));
  EXPECT_THAT(why([](Forcing& f) { f.alpha = 1; }), HasSubstr("alpha is 1"));
  EXPECT_THAT(why([](Forcing& f) { f.max_iterations = 0; }), HasSubstr("max_iterations is 0"));
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
