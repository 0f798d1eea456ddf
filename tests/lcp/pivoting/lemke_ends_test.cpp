// SPDX-License-Identifier: Apache-2.0
// How a run of Lemke's method can end, what it refuses, and that it is a function of its input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "lcp/pivoting/lemke_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::nan;
using support::Random;
using support::sparse;
using support::vec;
using testing::HasSubstr;

/// Needs many pivots: Murty's upper triangular matrix from the interior.
AffineMcp long_problem() { return standard_lcp(support::murty(30), Vec::Constant(30, -1)); }

// F_1 = -z_2 - 1 < 0 everywhere.
TEST(LemkeEnds, RayWithoutASolution) {
  const PivotResult result = lemke_ray(standard_lcp(matrix({{0, -1}, {1, 0}}), vec({-1, -1})));
  EXPECT_EQ(result.end, PivotEnd::Ray);
  EXPECT_FALSE(result.solved());
  EXPECT_EQ(result.ray.size(), 2);
  EXPECT_GT(result.residual, 0.1);
}

// F_1 = -2 (z_1 + z_2) - 2 < 0 everywhere; from outside both bounds the path goes round the origin through all four
// cells.
TEST(LemkeEnds, LoopAroundTheOrigin) {
  LemkeOptions options;
  options.keep_path = true;
  const PivotResult result =
      lemke(standard_lcp(matrix({{-2, -2}, {-2, -2}}), vec({-2, 1})), vec({-0.75, -0.5}), options);
  EXPECT_EQ(result.end, PivotEnd::Loop);
  EXPECT_EQ(result.pivots, 4);
}

// The cell of the start has the matrix 0, or nearly dependent columns; and in the ray start that of the free unknowns
// an empty column. Artificials stand in for what is missing; F_2 = -1 and z_1 = 1, z_1 = -1 have no solution all the
// same.
TEST(LemkeEnds, RankDeficientStartCell) {
  const PivotResult result = lemke(standard_lcp(matrix({{0, 0}, {0, 0}}), vec({1, -1})), vec({1, 1}));
  EXPECT_NE(result.end, PivotEnd::Solved);
  EXPECT_NE(result.end, PivotEnd::SingularBasis);
  EXPECT_EQ(result.repaired, 2);
  AffineMcp free = standard_lcp(matrix({{0, 1}, {0, 1}}), vec({1, -1}));
  free.box = Box::free(2);
  EXPECT_EQ(lemke_ray(free).end, PivotEnd::Ray);
  EXPECT_EQ(lemke_ray(free).repaired, 1);
  free.q = vec({1, 1});  // z_2 = -1, z_1 anything
  expect_solved(free, lemke_ray(free));
  const AffineMcp nearly = standard_lcp(matrix({{1, 1}, {1, 1 + 1e-15}}), vec({-1, -2}));
  EXPECT_EQ(lemke(nearly, vec({1, 1})).repaired, 1);
  expect_solved(nearly, lemke(nearly, vec({1, 1})));  // (0, 2)
}

// z_2 = 1 from a cell whose matrix is singular. Without repair no path begins there, and from a regular cell it does.
// Catches an option that is not asked, or is asked of every start.
TEST(LemkeEnds, BeginsNowhereWithoutRepair) {
  const AffineMcp problem = standard_lcp(matrix({{0, 0}, {0, 1}}), vec({1, -1}));
  LemkeOptions options;
  EXPECT_TRUE(lemke(problem, vec({1, 1}), options).solved());
  options.repair = false;
  const PivotResult result = lemke(problem, vec({1, 1}), options);
  EXPECT_EQ(result.end, PivotEnd::SingularBasis);
  EXPECT_EQ(result.pivots, 0);
  EXPECT_EQ(result.repaired, 0);
  EXPECT_TRUE(lemke(problem, vec({-1, 1}), options).solved());
}

// A start that happens to be a solution is one, whatever its cell.
TEST(LemkeEnds, SolvedFromASingularCellIfTheStartIsASolution) {
  LemkeOptions options;
  options.perturbation = 0;
  const PivotResult result = lemke(standard_lcp(SpMat(2, 2), vec({0, 0})), vec({1, 1}), options);
  EXPECT_EQ(result.end, PivotEnd::Solved);
  EXPECT_EQ(result.z, vec({1, 1}));
}

TEST(LemkeEnds, PivotLimit) {
  for (const int limit : {0, 1, 7}) {
    LemkeOptions options;
    options.max_pivots = limit;
    const PivotResult result = lemke(long_problem(), Vec::Ones(30), options);
    EXPECT_EQ(result.end, PivotEnd::PivotLimit);
    EXPECT_EQ(result.pivots, limit);
    EXPECT_EQ(result.x.size(), 30);
    EXPECT_LT(result.t, 1);
  }
}

// A path through the cells of an indefinite matrix goes back for longer and longer. One that may go back for so long
// is the same path; one that may not ends there, with the best point before. Catches a count that is off, or begins
// anew at every pivot.
TEST(LemkeEnds, PatienceEndsAPathThatTurnsBack) {
  Random random(17);
  const Index n = 20;
  const Dense M = Dense::NullaryExpr(n, n, [&] { return random.normal(); });
  const AffineMcp problem{sparse(M), random.normals(n), {Vec::Zero(n), Vec::Ones(n)}};
  LemkeOptions options;
  options.keep_path = true;
  const PivotResult whole = lemke(problem, Vec::Constant(n, 0.5), options);
  expect_solved(problem, whole);
  double largest = -1;
  int back = 0;
  int longest = 0;
  for (const Breakpoint& kink : whole.path) {
    back = kink.t > largest ? 0 : back + 1;
    longest = std::max(longest, back);
    largest = std::max(largest, kink.t);
  }
  ASSERT_GT(longest, 10);
  options.patience = longest;
  EXPECT_EQ(lemke(problem, Vec::Constant(n, 0.5), options).pivots, whole.pivots);
  options.patience = longest - 1;
  const PivotResult cut = lemke(problem, Vec::Constant(n, 0.5), options);
  EXPECT_EQ(cut.end, PivotEnd::Loop);
  EXPECT_LT(cut.pivots, whole.pivots);
  EXPECT_GT(cut.best_t, cut.t);
}

TEST(LemkeEnds, TimeLimit) {
  LemkeOptions options;
  options.deadline = std::chrono::steady_clock::now();
  PivotResult result = lemke(long_problem(), Vec::Ones(30), options);
  EXPECT_EQ(result.end, PivotEnd::TimeLimit);
  EXPECT_EQ(result.pivots, 0);
  // In the middle: the poll at a pivot waits until the time is over.
  options.deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
  int polls = 0;
  options.interrupted = [&] {
    if (++polls == 4) std::this_thread::sleep_until(options.deadline);
    return false;
  };
  result = lemke(long_problem(), Vec::Ones(30), options);
  EXPECT_EQ(result.end, PivotEnd::TimeLimit);
  EXPECT_LE(result.pivots, 3);
}

TEST(LemkeEnds, Interrupted) {
  for (const int after : {1, 2, 6}) {
    LemkeOptions options;
    int polls = 0;
    options.interrupted = [&] { return ++polls == after; };
    const PivotResult result = lemke(long_problem(), Vec::Ones(30), options);
    EXPECT_EQ(result.end, PivotEnd::Interrupted);
    EXPECT_EQ(result.pivots, after - 1);
    EXPECT_EQ(polls, after) << "polled at every pivot, and not after yes";
  }
}

// t = 1 is reached, but nobody can be that accurate: with this residual_tol rounding is too much.
TEST(LemkeEnds, Inaccurate) {
  Random random(1);
  LemkeOptions options = from_ray();
  options.residual_tol = 1e-300;
  const PivotResult result =
      lemke(standard_lcp(support::h_plus(50, 3, random), random.normals(50)), Vec::Zero(50), options);
  EXPECT_EQ(result.end, PivotEnd::Inaccurate);
  EXPECT_EQ(result.t, 1);
  EXPECT_FALSE(result.solved());
  EXPECT_GT(result.residual, 0);
  EXPECT_LT(result.residual, 1e-12);
}

TEST(LemkeEnds, HaveNames) {
  EXPECT_EQ(to_string(PivotEnd::Solved), "solved");
  EXPECT_EQ(to_string(PivotEnd::Ray), "ray");
  EXPECT_EQ(to_string(PivotEnd::Loop), "loop");
  EXPECT_EQ(to_string(PivotEnd::SingularBasis), "singular basis");
  EXPECT_EQ(to_string(PivotEnd::PivotLimit), "pivot limit");
  EXPECT_EQ(to_string(PivotEnd::TimeLimit), "time limit");
  EXPECT_EQ(to_string(PivotEnd::Interrupted), "interrupted");
  EXPECT_EQ(to_string(PivotEnd::Inaccurate), "inaccurate");
}

/// The message of the exception that lemke throws.
std::string refusal(const AffineMcp& p, const Vec& start, const LemkeOptions& options = {}) {
  try {
    (void)lemke(p, start, options);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

// What, where and the value, before anything is computed.
TEST(LemkeRefuses, MalformedInput) {
  const AffineMcp good = standard_lcp(matrix({{2, 1}, {1, 2}}), vec({-5, -6}));
  const Vec zero = Vec::Zero(2);
  EXPECT_EQ(refusal(good, zero), "accepted");
  AffineMcp bad = good;
  bad.q[1] = nan;
  EXPECT_THAT(refusal(bad, zero), HasSubstr("q of index 1 is nan"));
  bad = good;
  bad.M.coeffRef(1, 0) = -infinity;
  EXPECT_THAT(refusal(bad, zero), HasSubstr("row 1, column 0 is -inf"));
  bad = good;
  bad.box.upper[0] = -3;
  EXPECT_THAT(refusal(bad, zero), HasSubstr("index 0 is [0, -3]"));
  bad = good;
  bad.M = SpMat(2, 3);
  EXPECT_THAT(refusal(bad, zero), HasSubstr("M is 2 x 3"));
  EXPECT_THAT(refusal(good, vec({1, nan})), HasSubstr("start of index 1 is nan"));
  EXPECT_THAT(refusal(good, vec({-infinity, 1})), HasSubstr("start of index 0 is -inf"));
  EXPECT_THAT(refusal(good, vec({1, 2, 3})), HasSubstr("start has 3 entries, the problem 2"));
}

TEST(LemkeRefuses, OptionsThatMeanNothing) {
  const AffineMcp good = standard_lcp(matrix({{2, 1}, {1, 2}}), vec({-5, -6}));
  const Vec zero = Vec::Zero(2);
  for (const double value : {-1.0, nan, infinity}) {
    const auto with = [&](double LemkeOptions::*option) {
      LemkeOptions options;
      options.*option = value;
      return refusal(good, zero, options);
    };
    EXPECT_THAT(with(&LemkeOptions::residual_tol), HasSubstr("residual_tol is"));
    EXPECT_THAT(with(&LemkeOptions::pivot_tol), HasSubstr("pivot_tolerance is"));
    EXPECT_THAT(with(&LemkeOptions::feasibility_tol), HasSubstr("feasibility_tol is"));
    EXPECT_THAT(with(&LemkeOptions::perturbation), HasSubstr("perturbation is"));
  }
}

bool same(const PivotResult& a, const PivotResult& b) {
  bool paths = a.path.size() == b.path.size();
  for (std::size_t i = 0; paths && i < a.path.size(); ++i)
    paths = a.path[i].t == b.path[i].t && a.path[i].x == b.path[i].x;
  return paths && a.end == b.end && a.x == b.x && a.z == b.z && a.ray == b.ray && a.t == b.t && a.best_t == b.best_t &&
         a.best_x == b.best_x && a.residual == b.residual && a.pivots == b.pivots &&
         a.refactorizations == b.refactorizations;
}

PivotResult run(int k) {
  Random random(static_cast<unsigned>(k));
  const AffineMcp p{k % 2 ? support::h_plus(60, 2, random) : sparse(random.normals(15, 15)),
                    random.normals(k % 2 ? 60 : 15), support::mixed_box(k % 2 ? 60 : 15, random)};
  LemkeOptions options;
  options.start = k % 4 < 2 ? LemkeStart::Ray : LemkeStart::Regular;
  options.keep_path = true;
  return lemke(p, random.normals(p.size()), options);
}

// The same input gives the same result to the last bit, one after the other and in threads at the same time. Catches
// state kept between runs, and a random engine that is shared.
TEST(LemkeResult, IsAFunctionOfItsInput) {
  constexpr int runs = 24;
  std::vector<PivotResult> first;
  for (int k = 0; k < runs; ++k) first.push_back(run(k));
  for (int k = runs - 1; k >= 0; --k) EXPECT_TRUE(same(run(k), first[static_cast<std::size_t>(k)])) << k;
  std::vector<int> differ(4, 0);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < differ.size(); ++t)
      threads.emplace_back([&, t] {
        for (int repeat = 0; repeat < 5; ++repeat)
          for (int k = 0; k < runs; ++k) differ[t] += !same(run(k), first[static_cast<std::size_t>(k)]);
      });
  }
  EXPECT_THAT(differ, testing::Each(0));
}

// Another seed is another path, but a P-matrix has one solution.
TEST(LemkeResult, SeedChangesThePathOnly) {
  Random random(7);
  const AffineMcp p = standard_lcp(support::h_plus(40, 3, random), random.normals(40));
  LemkeOptions options = from_ray();
  options.keep_path = true;
  const PivotResult a = lemke(p, Vec::Zero(40), options);
  options.seed = 2;
  const PivotResult b = lemke(p, Vec::Zero(40), options);
  expect_solved(p, a);
  expect_solved(p, b);
  EXPECT_NE(a.path.front().x, b.path.front().x);
  EXPECT_LT((a.z - b.z).norm(), 1e-10);
}

// The library of the factorizations is a matter of speed only; so is the length of the eta file.
TEST(LemkeResult, DoesNotDependOnTheFactorization) {
  Random random(8);
  const AffineMcp p{support::h_plus(80, 3, random), random.normals(80), support::mixed_box(80, random)};
  const PivotResult reference = lemke_ray(p);
  expect_solved(p, reference);
  for (const LuBackend lu : {LuBackend::General, LuBackend::Klu, LuBackend::Eigen})
    for (const int every : {1, 7, 1000}) {
      LemkeOptions options = from_ray();
      options.basis.lu = lu;
      options.basis.refactor_every = every;
      const PivotResult result = lemke(p, Vec::Zero(80), options);
      expect_solved(p, result);
      EXPECT_EQ(result.pivots, reference.pivots);
      EXPECT_LT((result.z - reference.z).norm(), 1e-10);
    }
}

// Where all pivots are doubtful a step of refinement confirms nearly all of them. Catches factorizations at every
// pivot: these problems took 314 of them, and now 26 in all.
TEST(LemkeResult, DoubtfulPivotsTakeNoFactorizationWhereTheirColumnIsAccurate) {
  Random random(3);
  LemkeOptions options = from_ray();
  options.doubtful_pivot = 1;
  for (int k = 0; k < 20; ++k) {
    const Index n = 30;
    const Dense D = random.normals(n, n);
    const AffineMcp problem{sparse(D * D.transpose()), random.normals(n), {Vec::Zero(n), Vec::Ones(n)}};
    const PivotResult result = lemke(problem, Vec::Constant(n, 0.5), options);
    expect_solved(problem, result);
    EXPECT_LE(result.refactorizations, 3);
  }
}

// From the end of a run the cell of the solution is known: one step. This is what a Newton method lives on.
TEST(LemkeResult, WarmStartTakesOneStep) {
  Random random(9);
  for (int k = 0; k < 20; ++k) {
    const AffineMcp p{support::h_plus(50, 3, random), random.normals(50), support::mixed_box(50, random)};
    const PivotResult cold = lemke_ray(p);
    expect_solved(p, cold);
    LemkeOptions options;
    options.perturbation = 0;
    const PivotResult warm = lemke(p, cold.x, options);
    expect_solved(p, warm);
    EXPECT_EQ(warm.pivots, 1);
    EXPECT_LT((warm.z - cold.z).norm(), 1e-12);
  }
}

// Units are the user's business: scaled rows and columns leave a P-matrix one. Catches absolute tolerances, which take
// all pivots of a problem in other units for zero. `solved` is told in the user's units, which hide rows of small ones;
// that the pivoting has solved those too is checked up to eight orders of magnitude.
TEST(LemkeScaling, ScaledPMatricesAreSolved) {
  Random random(10);
  for (int k = 0; k < 300; ++k) {
    const Index n = random.integer(2, 20);
    const AffineMcp p = standard_lcp(support::h_plus(n, 2, random), random.normals(n));
    const double decades = k % 3 == 0 ? 0 : k % 3 == 1 ? 4 : 8;
    const double unit = decades == 0 ? std::pow(10, random.integer(-12, 12)) : 1;
    const auto factors = [&] {
      return Vec(Vec::NullaryExpr(n, [&] { return unit * std::pow(10, random.uniform(-decades, decades)); }));
    };
    const Vec rows = factors();
    const Vec columns = factors();
    AffineMcp scaled = p;
    scaled.M = rows.asDiagonal() * p.M * columns.asDiagonal();
    scaled.q = rows.asDiagonal() * p.q;
    const PivotResult result = lemke_ray(scaled);
    ASSERT_EQ(to_string(result.end), "solved") << k;
    if (decades > 4 || result.t < 1) continue;  // t < 1: solved, by the user's units, before the end of the path
    EXPECT_LT(support::violation(p, columns.asDiagonal() * result.z), 1e-6) << k;
  }
}

// Numbers near the ends of the range: refused or answered, but nothing called solved that is not.
TEST(LemkeScaling, ExtremeNumbers) {
  const double values[] = {1e-320, 1e-300, 1e-100, 1, 1e100, 1e300};
  for (const double m : values)
    for (const double q : values)
      for (const double u : {1e-310, 1.0, 1e300, infinity}) {
        AffineMcp p = standard_lcp(matrix({{m, 0}, {m, 1}}), vec({-q, 1}));
        p.box.upper.setConstant(u);
        for (const LemkeStart start : {LemkeStart::Ray, LemkeStart::Regular}) {
          LemkeOptions options;
          options.start = start;
          options.max_pivots = 1000;
          const PivotResult result = lemke(p, vec({0.5, 0.5}), options);
          if (result.solved()) {
            EXPECT_LE(support::violation(p, result.z), 1.01e-9 * (1 + q)) << m << ' ' << q << ' ' << u;
          }
        }
      }
}

}  // namespace
}  // namespace perp::lcp
