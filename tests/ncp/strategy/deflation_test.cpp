// SPDX-License-Identifier: Apache-2.0
/// Several solutions by deflation: problems of which all solutions are known.
#include "ncp/strategy/deflation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>

#include "collection/collection.hpp"
#include "lcp/solve/enumeration.hpp"
#include "ncp/strategy/deflated_newton.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::Random;
using support::vec;
using testing::HasSubstr;
using testing::SizeIs;

/// Solved by a judge that is not the library's, and pairwise apart.
void expect_distinct_solutions(const Mcp& mcp, const AllSolutions& all, double apart = 1e-4) {
  for (std::size_t i = 0; i < all.found.size(); ++i) {
    const Result& r = all.found[i].result;
    EXPECT_TRUE(r.solved()) << r;
    EXPECT_LE(support::violation(mcp, r.x), 1e-8);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT((r.x - all.found[j].result.x).lpNorm<Eigen::Infinity>(), apart) << i << " and " << j;
  }
}

bool has(const AllSolutions& all, const Vec& x, double tol = 1e-6) {
  return std::any_of(all.found.begin(), all.found.end(),
                     [&](const FoundSolution& f) { return (f.result.x - x).lpNorm<Eigen::Infinity>() <= tol; });
}

/// 0 <= x _|_ A y - e, 0 <= y _|_ B'x - e with A = c - payoffs of the row player, B likewise (Lemke & Howson 1964): its
/// solutions other than 0 are the equilibria, not normalised.
lcp::AffineMcp bimatrix(const Dense& row_payoffs, const Dense& column_payoffs, double c) {
  const Index m = row_payoffs.rows(), n = row_payoffs.cols();
  Dense M = Dense::Zero(m + n, m + n);
  M.topRightCorner(m, n) = (c - row_payoffs.array()).matrix();
  M.bottomLeftCorner(n, m) = (c - column_payoffs.array()).matrix().transpose();
  return lcp::standard_lcp(M.sparseView(), -Vec::Ones(m + n));
}

// log M and its gradient by differences, and tau: (M Phi)' (tau d) = -M Phi with dense matrices. Catches a wrong sign
// or power in m, with which deflation would go on as plain Newton's method.
TEST(Deflation, RankOneRuleSolvesTheDeflatedSystem) {
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    const Index n = 1 + k % 6;
    std::vector<DeflationOperator::Root> roots(static_cast<std::size_t>(1 + k % 3));
    for (auto& root : roots) root = {.r = random.normals(n), .D = random.uniform(0.1, 10)};
    const DeflationOperator M(roots, 1 + k % 2, 0.5);
    const Vec x = random.normals(n);
    double product = 1;
    for (const auto& [r, D] : roots) product *= std::pow(D / (x - r).norm(), 1 + k % 2) + 0.5;
    EXPECT_NEAR(M.log_value(x), std::log(product), 1e-12);
    const Vec m = M.log_gradient(x);
    for (Index j = 0; j < n; ++j) {
      const double h = 1e-6;
      const Vec e = h * Vec::Unit(n, j);
      EXPECT_NEAR(m[j], (M.log_value(x + e) - M.log_value(x - e)) / (2 * h), 1e-6 * (1 + std::abs(m[j])));
    }
    const Dense H = Dense::NullaryExpr(n, n, [&] { return random.normals(1)[0]; });
    const Vec Phi = random.normals(n);
    const Vec d = -H.partialPivLu().solve(Phi);
    const Dense G = product * (H + Phi * m.transpose());
    const Vec step = deflated_length(m.dot(d)) * d;
    EXPECT_LE((G * step + product * Phi).norm(), 1e-9 * (1 + G.norm() * step.norm()));
  }
}

// Kojima & Shindo 1986: (1, 0, 3, 0) and the degenerate (sqrt6/2, 0, 0, 1/2), from each of the collection's eight
// starts, and never a third. Catches degenerate duplicates, which are known to half the digits only.
TEST(Deflation, BothSolutionsOfKojimaShindoFromEveryStart) {
  const collection::Problem problem = collection::find("kojshin")->make();
  for (const Vec& x0 : problem.starts) {
    const AllSolutions all = solve_all(*problem.mcp, x0);
    EXPECT_THAT(all.found, SizeIs(2)) << x0.transpose();
    EXPECT_TRUE(has(all, vec({1, 0, 3, 0})) && has(all, vec({std::sqrt(6) / 2, 0, 0, 0.5}), 1e-5));
    expect_distinct_solutions(*problem.mcp, all);
    EXPECT_THAT(all.message, HasSubstr("no try finds another"));
  }
}

// Kehoe 1985: three equilibria, from both starts.
TEST(Deflation, ThreeEquilibriaOfKehoe) {
  const collection::Problem problem = collection::find("kehoe")->make();
  for (const Vec& x0 : problem.starts) {
    const AllSolutions all = solve_all(*problem.mcp, x0, path());
    EXPECT_THAT(all.found, SizeIs(3));
    expect_distinct_solutions(*problem.mcp, all);
    for (const auto& known : problem.solutions) EXPECT_TRUE(has(all, known.x, 1e-4)) << known.label;
    for (const FoundSolution& f : all.found) EXPECT_EQ(f.singular, "");
    EXPECT_EQ(all.found[0].how, "path");
    EXPECT_THAT(all.found[1].how, HasSubstr("sigma"));
  }
}

// Three firms' worth of solutions of a scalar equation with bounds: (x - 1)(x - 2)(x - 3) on [0, inf), and F(0) < 0
// rules out 0; with the sign changed 0 is a solution too. Catches solutions at a bound, where F does not vanish, that
// are not deflated.
TEST(Deflation, RootsOfACubicAndASolutionAtTheBound) {
  for (const double sign : {1.0, -1.0}) {
    const auto mcp = make_mcp(support::scalar(
        0, infinity, [=](double x) { return sign * (x - 1) * (x - 2) * (x - 3); },
        [=](double x) { return sign * ((x - 2) * (x - 3) + (x - 1) * (x - 3) + (x - 1) * (x - 2)); }));
    for (const double x0 : {0.5, 1.0, 10.0}) {
      const AllSolutions all = solve_all(*mcp, vec({x0}));
      EXPECT_THAT(all.found, SizeIs(sign > 0 ? 3 : 4)) << x0;
      for (const double root : {1.0, 2.0, 3.0}) EXPECT_TRUE(has(all, vec({root}))) << root;
      EXPECT_EQ(has(all, vec({0})), sign < 0);
    }
  }
}

// Battle of the sexes, chicken, a coordination game of three strategies (Osborne & Rubinstein 1994, section 2.3): 3, 3
// and 7 equilibria by enumeration of the cells, and matching pennies with one. Every solution by deflation is one of
// them. The starts 0 and 1 share the games' symmetries, the pure equilibria do not: catches a search that is caught in
// the symmetric subspace.
TEST(Deflation, EquilibriaOfTextbookGames) {
  struct Game {
    const char* name;
    Dense row, column;
    std::size_t equilibria;
    bool all;
  };
  const Dense three = (Dense(3, 3) << 3, 0, 0, 0, 2, 0, 0, 0, 1).finished();
  const std::vector<Game> games{
      {"battle of the sexes", (Dense(2, 2) << 2, 0, 0, 1).finished(), (Dense(2, 2) << 1, 0, 0, 2).finished(), 3, true},
      {"chicken", (Dense(2, 2) << 0, 7, 2, 6).finished(), (Dense(2, 2) << 0, 2, 7, 6).finished(), 3, true},
      {"matching pennies", (Dense(2, 2) << 1, -1, -1, 1).finished(), (Dense(2, 2) << -1, 1, 1, -1).finished(), 1, true},
      {"coordination", three, three, 7, false}};
  for (const Game& game : games) {
    const lcp::AffineMcp problem = bimatrix(game.row, game.column, 8);
    const lcp::Solutions cells = lcp::enumerate(problem);
    ASSERT_TRUE(cells.complete);
    EXPECT_EQ(cells.found.size(), game.equilibria) << game.name;
    const auto mcp = make_mcp(support::affine(problem));
    for (const double x0 : {0.0, 1.0}) {
      const AllSolutions all = solve_all(*mcp, Vec::Constant(problem.size(), x0));
      expect_distinct_solutions(*mcp, all);
      if (game.all)
        EXPECT_EQ(all.found.size(), game.equilibria) << game.name << " from " << x0;
      else
        EXPECT_GE(all.found.size(), 3U) << game.name << " from " << x0;
      for (const FoundSolution& f : all.found)
        EXPECT_TRUE(std::any_of(cells.found.begin(), cells.found.end(),
                                [&](const lcp::Solution& s) { return (s.z - f.result.x).norm() < 1e-5; }))
            << game.name << ": " << f.result.x.transpose();
    }
  }
}

// The games of the collection have several equilibria.
TEST(Deflation, SeveralEquilibriaOfTheCollectionsGames) {
  for (const char* name : {"bimatrix-own", "random-bimatrix-own"}) {
    const collection::Problem problem = collection::find(name)->make();
    for (const Vec& x0 : problem.starts) {
      const AllSolutions all = solve_all(*problem.mcp, x0, path(), {.solutions = 2});
      EXPECT_THAT(all.found, SizeIs(2)) << name;
      expect_distinct_solutions(*problem.mcp, all);
      EXPECT_THAT(all.message, HasSubstr("as many"));
    }
  }
}

// A strongly monotone problem has one solution, whatever is tried. Catches points near a root sold as others.
TEST(Deflation, FindsNothingWhereTheSolutionIsUnique) {
  Random random(4);
  for (int k = 0; k < 5; ++k) {
    const auto [functions, solution] = support::planted(4 + k, 0.3, random);
    const auto mcp = make_mcp(functions);
    const AllSolutions all = solve_all(*mcp, Vec::Ones(4 + k));
    EXPECT_THAT(all.found, SizeIs(1));
    EXPECT_GT(all.attempts, 10);
  }
}

// Mathiesen's ray of solutions: points of it, and each but its end says that J is singular there.
TEST(Deflation, ContinuaAreSaidToBeSingular) {
  const collection::Problem problem = collection::find("mathiesen")->make();
  const AllSolutions all = solve_all(*problem.mcp, problem.starts.front(), SemismoothNewton{}, {.solutions = 3});
  ASSERT_GE(all.found.size(), 2U);
  expect_distinct_solutions(*problem.mcp, all);
  int singular = 0;
  for (const FoundSolution& f : all.found) singular += f.singular.empty() ? 0 : 1;
  EXPECT_GE(singular, 1);
}

// From a start that is the first solution itself, where M is infinite.
TEST(Deflation, StartsAtASolution) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const AllSolutions all = solve_all(*mcp, vec({1, 0, 3, 0}));
  EXPECT_THAT(all.found, SizeIs(2));
}

TEST(Deflation, KeepsToItsLimits) {
  const collection::Problem problem = collection::find("kehoe")->make();
  const Vec& x0 = problem.starts.front();
  EXPECT_THAT(solve_all(*problem.mcp, x0, path(), {.solutions = 1}).found, SizeIs(1));
  const AllSolutions none = solve_all(*problem.mcp, x0, path(), {.max_attempts = 0});
  EXPECT_THAT(none.found, SizeIs(1));
  EXPECT_EQ(none.attempts, 0);
  EXPECT_THAT(none.message, HasSubstr("limit of attempts"));
  // An observer that stops in the first attempt ends the whole.
  bool deflating = false;
  const AllSolutions stopped = solve_all(*problem.mcp, x0, path(), {}, [&](const Iteration& it) {
    deflating = deflating || it.attempt.find("deflation") != std::string::npos;
    return deflating ? Next::Stop : Next::Continue;
  });
  EXPECT_EQ(stopped.attempts, 1);
  EXPECT_THAT(stopped.message, HasSubstr("interrupt"));
  EXPECT_TRUE(stopped.first.solved());
}

// The flag, raised in an attempt: in the first of many, and in the only one there is, after which nothing else asks.
TEST(Deflation, TheFlagEndsTheWhole) {
  const auto mcp = make_mcp(support::kojima_shindo());
  for (const std::vector<DeflationTry>& tries : {Deflation::default_tries(), std::vector<DeflationTry>(1)}) {
    std::atomic<bool> flag{false};
    const AllSolutions all = solve_all(*mcp, Vec::Ones(4), SemismoothNewton{.stop = {.interrupt = &flag}},
                                       {.tries = tries}, [&](const Iteration& it) {
                                         if (it.attempt.find("deflation") != std::string::npos) flag = true;
                                         return Next::Continue;
                                       });
    EXPECT_EQ(all.attempts, 1);
    EXPECT_EQ(all.message, "interrupted");
    EXPECT_THAT(all.found, SizeIs(1));
  }
}

// The time is that of the whole: an F that waits 1 ms has 50 of them, also where no attempt alone lasts so long.
TEST(Deflation, KeepsToItsTime) {
  using Clock = std::chrono::steady_clock;
  const std::chrono::duration<double> limit(0.05);
  const auto mcp = make_mcp(support::scalar(
      0, infinity,
      [](double x) {
        for (const auto end = Clock::now() + std::chrono::milliseconds(1); Clock::now() < end;) {
        }
        return x + 1;
      },
      [](double) { return 1; }));
  const auto begin = Clock::now();
  const AllSolutions all = solve_all(*mcp, vec({3}), SemismoothNewton{.stop = {.max_time = limit}});
  const std::chrono::duration<double> taken = Clock::now() - begin;
  EXPECT_THAT(all.found, SizeIs(1));
  EXPECT_THAT(all.message, HasSubstr("time limit of 0.05 s"));
  EXPECT_LT(all.attempts, static_cast<int>(Deflation::default_tries().size()));
  EXPECT_GE(all.stats.time, limit);
  EXPECT_LT(taken.count(), 20 * limit.count());
}

/// Counts what is evaluated.
struct Calls {
  int F = 0, J = 0;
};
Functions counting(Functions f, Calls& calls) {
  f.F = [F = f.F, &calls](In x, Out out) { return ++calls.F, F(x, out); };
  f.J = [J = f.J, &calls](In x, SpMat& out) { return ++calls.J, J(x, out); };
  return f;
}

// Every evaluation is counted once: in attempts, polishing and snapping, also where the tolerance of polishing is out
// of reach.
TEST(Deflation, CountsEveryEvaluation) {
  Random random(6);
  const auto check = [](const Functions& functions, In x0, const char* what) {
    Calls calls;
    const auto mcp = make_mcp(counting(functions, calls));
    const AllSolutions all = solve_all(*mcp, x0, SemismoothNewton{});
    EXPECT_GE(all.found.size(), 1U) << what;
    EXPECT_GT(all.attempts, 10) << what;
    EXPECT_EQ(all.stats.F_evals, calls.F) << what;
    EXPECT_EQ(all.stats.J_evals + 1, calls.J) << what << ": all but the one for Result::relative";
  };
  check(support::kojima_shindo(), Vec::Ones(4), "kojima-shindo");
  check(support::planted(6, 0.3, random).functions, Vec::Ones(6), "planted");
  // A residual of 1e-10 stays: F(x) = x + 1e-10 sign(x), which polishing cannot bring to 1e-12.
  check(support::scalar(
            -infinity, infinity, [](double x) { return x + (x < 0 ? -1e-10 : 1e-10); }, [](double) { return 1; }),
        vec({3}), "jump");
}

// max_F_evals is that of the whole. Each run within looks at it after an iteration, and a few evaluations follow.
// Catches a limit that every attempt has anew.
TEST(Deflation, SharesTheLimitOfEvaluations) {
  const auto functions = support::kojima_shindo();
  for (const int limit : {30, 100, 300}) {
    Calls calls;
    const auto mcp = make_mcp(counting(functions, calls));
    const AllSolutions all = solve_all(*mcp, Vec::Ones(4), SemismoothNewton{.stop = {.max_F_evals = limit}});
    ASSERT_TRUE(all.first.solved());
    EXPECT_GE(calls.F, limit);
    EXPECT_LE(calls.F, limit + 60);
    EXPECT_EQ(all.stats.F_evals, calls.F);
    EXPECT_THAT(all.message, HasSubstr("limit of " + std::to_string(limit) + " evaluations"));
  }
}

// F = x - 5e-14 on x >= 0 to a tolerance of 1e-15: 0 is within rounding of the solution, and no solution. Catches a
// verdict that the rounding to a bound breaks.
TEST(Deflation, RoundingToABoundKeepsTheVerdict) {
  for (const double tol : {1e-15, 1e-14, 1e-8}) {
    const auto mcp = make_mcp(support::scalar(
        0, infinity, [](double x) { return x - 5e-14; }, [](double) { return 1; }));
    const AllSolutions all = solve_all(*mcp, vec({1}), SemismoothNewton{.stop = {.tol = tol}}, {.solutions = 1});
    ASSERT_THAT(all.found, SizeIs(1)) << tol;
    EXPECT_LE(all.found[0].result.residual.natural, tol);
    EXPECT_EQ(all.found[0].result.x[0] == 0, tol > 1e-13);
  }
}

// 0 is the start, the solution and a bound: no attempt starts there, nor within `distinct` of it. Catches moves that
// are projected back onto the bound.
TEST(Deflation, NoAttemptStartsAtASolutionAtTheBound) {
  for (const double upper : {infinity, 0.05}) {
    const auto mcp = make_mcp(support::scalar(
        0, upper, [](double x) { return 1 + x; }, [](double) { return 1; }));
    int starts = 0;
    const AllSolutions all = solve_all(*mcp, vec({0}), SemismoothNewton{}, {}, [&](const Iteration& it) {
      if (it.attempt.find("deflation") != std::string::npos) {
        ++starts;
        EXPECT_GT(it.x->minCoeff(), 1e-4) << it.attempt;
        EXPECT_LT(it.x->maxCoeff(), upper) << it.attempt;
      }
      return Next::Continue;
    });
    EXPECT_EQ(starts, all.attempts);
    EXPECT_EQ(starts, static_cast<int>(Deflation::default_tries().size()));
  }
}

// The name that the caller gave, or the method's own.
TEST(Deflation, TheFirstSolutionIsToldByItsLabel) {
  const auto mcp = make_mcp(support::kojima_shindo());
  EXPECT_EQ(solve_all(*mcp, Vec::Ones(4), SemismoothNewton{}, {.solutions = 1}, {}, "semicomp").found[0].how,
            "semicomp");
  EXPECT_EQ(solve_all(*mcp, Vec::Ones(4), MinNewton{}, {.solutions = 1}).found[0].how, "newton-min");
}

// Records count on over the attempts, each of which is named once.
TEST(Deflation, RecordsCountOn) {
  const auto mcp = make_mcp(support::kojima_shindo());
  std::vector<Iteration> records;
  const AllSolutions all = solve_all(*mcp, Vec::Ones(4), NewtonJosephy{}, {}, record(records));
  int named = 0;
  for (std::size_t i = 1; i < records.size(); ++i) {
    EXPECT_GE(records[i].k, records[i - 1].k);
    EXPECT_GE(records[i].F_evals, records[i - 1].F_evals);
    named += records[i].attempt.rfind("deflation", 0) == 0 ? 1 : 0;
  }
  EXPECT_EQ(named, all.attempts);
  EXPECT_GE(all.stats.F_evals, records.back().F_evals);
}

// Where the first solve fails nothing is deflated, and the failure is told.
TEST(Deflation, NothingToDeflateWithoutAFirstSolution) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double) { return -1; }, [](double) { return 0; }));
  const AllSolutions all = solve_all(*mcp, vec({1}));
  EXPECT_TRUE(all.found.empty());
  EXPECT_FALSE(all.first.solved());
  EXPECT_THAT(all.message, HasSubstr("nothing to deflate"));
}

TEST(Deflation, RefusesBadOptionsByName) {
  const auto why = [](Deflation d) { return invalid(d).value_or(""); };
  EXPECT_THAT(why({.solutions = 0}), HasSubstr("solutions is 0"));
  EXPECT_THAT(why({.max_attempts = -1}), HasSubstr("max_attempts is -1"));
  EXPECT_THAT(why({.max_iterations = -1}), HasSubstr("max_iterations"));
  EXPECT_THAT(why({.distinct = 0}), HasSubstr("distinct is 0"));
  EXPECT_THAT(why({.tries = {{.p = 0}}}), HasSubstr("p is 0"));
  EXPECT_THAT(why({.tries = {{.sigma = -1}}}), HasSubstr("sigma is -1"));
  EXPECT_FALSE(invalid(Deflation{}).has_value());
  const auto mcp = make_mcp(support::kojima_shindo());
  EXPECT_THROW(solve_all(*mcp, Vec::Ones(4), path(), {.solutions = 0}), std::invalid_argument);
  EXPECT_THROW(solve_all(*mcp, Vec::Ones(3)), std::invalid_argument);
}

}  // namespace
}  // namespace perp::ncp
