// SPDX-License-Identifier: Apache-2.0
/// Ralph 1994; Dirkse & Ferris 1995; Ferris, Kanzow & Munson 1999: the method by its behaviour on problems with known
/// solutions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::expect_solution;
using support::expect_solved;
using support::NamedMethod;
using support::Random;
using support::vec;

PathSearch without_crash() { return {.crash = {.on = false}}; }

/// The starts (0, ...), (1, ...), (10, ...), (100, ...) with what PATH 4.7 takes of major iterations from each.
struct Measured {
  double start;
  int majors;
};

void expect_majors(bool josephy, std::initializer_list<Measured> measured) {
  const auto mcp = make_mcp(support::kojima_shindo(josephy));
  for (const auto& [label, method] : {NamedMethod{"crash", path()}, NamedMethod{"no crash", path(without_crash())}})
    for (const auto& [start, majors] : measured) {
      const Result result = expect_solved(*mcp, Vec::Constant(4, start), method, label);
      EXPECT_LE(result.stats.iterations, majors) << label << " from " << start;
      EXPECT_EQ(result.stats.restarts, 0) << label << " from " << start;
      EXPECT_TRUE(support::is_kojima_shindo_solution(result.x, josephy, 1e-4)) << result.x.transpose();
    }
}

// PATH 4.7.03, default options, measured. Catches whatever makes the path search slower than the code it follows.
TEST(PathSearch, TakesNoMoreMajorIterationsThanPath) {
  expect_majors(true, {{0, 16}, {1, 4}, {10, 14}, {100, 14}});
  expect_majors(false, {{0, 6}, {1, 4}, {10, 6}, {100, 13}});
}

// Order 2 near strongly regular solutions without chord steps, 3 with one (Robinson 1994; Shamanskii 1967). Near them
// no variable is left to pivot on but a few. Catches a linearisation that is a little wrong, a proximal term that
// stays, unchecked steps that lead away, chord steps with the matrix of another point.
TEST(PathSearch, ConvergesQuadraticallyAndFasterWithChordSteps) {
  for (const int chord_steps : {0, 1}) {
    Random random(3);
    int measured = 0;
    double mean = 0;
    for (int k = 0; k < 16; ++k) {
      const auto [functions, solution] = support::planted(20, k % 2 == 0 ? 0.5 : 0, random);
      std::vector<Iteration> records;
      PathSearch method = without_crash();
      method.chord_steps = chord_steps;
      expect_solved(*make_mcp(functions), solution + 0.1 * random.normals(20), method, "", record(records));
      const double order = support::last_order(records, chord_steps == 0 ? 1e-3 : 3e-2);
      if (order == 0) continue;
      mean += (order - mean) / ++measured;
      EXPECT_GT(order, 1.5);
    }
    EXPECT_GE(measured, 3) << chord_steps;
    EXPECT_GT(mean, 1.7 + 0.5 * chord_steps) << chord_steps;
  }
}

/// M x + q + exp of a part of the variables, M a dense P-matrix, the box with every kind of interval; the linear
/// entries are declared, so that presolve has something to do. The solution planted is the only one.
support::Planted declared(Index n, Random& random) {
  const Box box = support::mixed_box(n, random);
  SpMat M = support::p_matrix(n, 2, random);
  M.makeCompressed();
  const Vec curved = Vec::NullaryExpr(n, [&](Index) { return random.chance(0.4) ? 1.0 : 0.0; });
  const auto exponential = [curved](In x) { return Vec(curved.array() * (0.5 * x.array()).exp()); };
  const Vec solution = lcp::project(box, random.normals(n));
  Vec q = -(M * solution) - exponential(solution);
  for (Index i = 0; i < n; ++i) {
    if (solution[i] == box.upper[i])
      q[i] -= random.uniform(0.1, 2);
    else if (solution[i] == box.lower[i])
      q[i] += random.uniform(0.1, 2);
  }
  Functions functions{.name = "declared", .box = box, .pattern = M, .F = {}, .J = {}};
  functions.F = [=](In x, Out F) {
    F = M * x + q + exponential(x);
    return F.allFinite();
  };
  functions.J = [=](In x, SpMat& J) {
    J = M;
    const Vec slope = 0.5 * exponential(x);
    for (Index i = 0; i < x.size(); ++i)
      if (curved[i] > 0) J.coeffRef(i, i) += slope[i];
    return slope.allFinite();
  };
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator e(M, j); e; ++e) functions.linear_entries.push_back(e.row() != e.col() || curved[j] == 0);
  return {std::move(functions), solution};
}

// Catches pairs that presolve takes out and puts back wrongly, and a residual that is the reduced problem's.
TEST(PathSearch, PresolveOnAndOffComeToTheSameSolutions) {
  Random random(4);
  int presolved = 0;
  for (int k = 0; k < 60; ++k) {
    const Index n = 1 + k % 12;
    const auto [functions, solution] = declared(n, random);
    const auto mcp = make_mcp(functions);
    const Vec x0 = 2 * random.normals(n);
    for (const bool preprocess : {true, false}) {
      Method method = path();
      std::get<On>(method).enabled = preprocess;
      const Result result = expect_solution(*mcp, x0, method, solution, 1e-6);
      EXPECT_NEAR(result.residual.natural, support::violation(*mcp, result.x), 1e-15);
      presolved += result.stats.presolved;
      EXPECT_TRUE(preprocess || result.stats.presolved == 0);
    }
  }
  EXPECT_GT(presolved, 20);
}

// The linearisation of an affine problem is the problem. Catches a q that is not F - J x, or a step that is damped.
TEST(PathSearch, SolvesAffineProblemsInOneIteration) {
  Random random(2);
  for (int k = 0; k < 30; ++k) {
    const Index n = 2 + k;
    const auto mcp =
        make_mcp(support::affine({.M = k % 2 == 0 ? support::p_matrix(n, 2, random) : support::h_plus(n, 3, random),
                                  .q = 5 * random.normals(n),
                                  .box = support::mixed_box(n, random)}));
    for (const auto& [label, method] : support::path_variants()) {
      const Result result = expect_solved(*mcp, random.normals(n), method, label);
      EXPECT_LE(result.stats.iterations, 1) << label << ", n = " << n;
    }
  }
}

/// Records of runs on problems with many cells, whose merit rises along some Newton steps.
std::vector<std::vector<Iteration>> rugged_runs(const Nms& nms) {
  std::vector<std::vector<Iteration>> runs;
  const auto run = [&](const Mcp& mcp, const Vec& x0) {
    PathSearch method{.crash = {.on = false}, .nms = nms};
    method.chord_steps = 0;
    solve(mcp, x0, method, record(runs.emplace_back()));
  };
  for (const bool josephy : {false, true})
    for (const Vec& x0 : support::kojima_shindo_starts()) run(*make_mcp(support::kojima_shindo(josephy)), x0);
  const auto wave = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::atan(x) + 0.3 * std::sin(3 * x); },
      [](double x) { return 1 / (1 + x * x) + 0.9 * std::cos(3 * x); }));
  for (int k = 0; k < 30; ++k) run(*wave, vec({-6 + 0.4 * k}));
  return runs;
}

// Without stabilisation every step beats the last merit; with it merits rise, D-steps are taken without a look at the
// merit, in the first iteration where its search comes to nothing, and watchdogs take runs back: to a merit no greater
// than the one before the D-steps. Catches a reference that stays where it began, stabilisation that is on in name
// only, and leaps to anywhere.
TEST(PathSearch, NonMonotoneStabilisationLetsMeritsRise) {
  int leaps = 0;
  int unchecked = 0;
  int watchdogs = 0;
  int rises = 0;
  for (const auto& records : rugged_runs({.on = false}))
    for (std::size_t k = 1; k < records.size(); ++k)
      EXPECT_LT(records[k].merit, records[k - 1].merit * (1 + 1e-12)) << records[k].kind;
  for (const auto& records : rugged_runs({.memory = 1, .initial_reference_factor = 1})) {
    double passed = records.front().merit;  // of the last point that passed a test
    for (std::size_t k = 1; k < records.size(); ++k) {
      const Iteration& it = records[k];
      rises += it.merit > records[k - 1].merit;
      unchecked += it.kind == 'D';
      leaps += k == 1 && it.kind == 'D';
      EXPECT_TRUE(k > 1 || it.merit <= 1e4 * passed * (1 + 1e-12)) << it.merit;
      watchdogs += it.kind == 'W' && it.step > 0;
      if (it.kind == 'D' || it.step == 0) continue;
      EXPECT_LE(it.merit, passed) << it.kind;
      passed = it.merit;
    }
  }
  EXPECT_GT(leaps, 0);
  EXPECT_GT(unchecked, 0);
  EXPECT_GT(watchdogs, 0);
  EXPECT_GT(rises, 0);
}

// Near 0 every merit function has a local minimum that is no solution; PATH 4.7 fails (Billups 1995).
TEST(PathSearch, BillupsFromZero) {
  const auto mcp = make_mcp(support::billups());
  for (const auto& [label, method] : support::path_variants())
    expect_solution(*mcp, vec({0}), method, vec({1 + std::sqrt(1.01)}), 1e-7, label);
}

// 10^4 unknowns; one dense matrix of them would take 800 MB, so would the kinks of a path that are all kept.
TEST(PathSearch, ObstacleProblemStaysSparse) {
  const double before = support::peak_megabytes();
  const Result near = expect_solved(*make_mcp(support::obstacle(100, 2)), Vec::Zero(10000), path());
  const Result result = expect_solved(*make_mcp(support::obstacle(100)), near.x, without_crash());
  EXPECT_EQ(result.stats.iterations, 1);
  EXPECT_GT(result.stats.pivots, 1);
  EXPECT_LT(support::peak_megabytes() - before, 400);
}

// Equal solutions by crash alone, by pivoting alone and by a method that shares nothing with them but F.
TEST(PathSearch, CrashAndPivotingAgreeOnTheObstacleProblem) {
  const auto mcp = make_mcp(support::obstacle(20));
  const Result crash = expect_solved(*mcp, Vec::Zero(400), path({.stop = {.tol = 1e-12}}));
  PathSearch pivoting = without_crash();
  pivoting.stop.tol = 1e-12;
  const Result pivoted = expect_solved(*mcp, Vec::Zero(400), pivoting);
  const Result semismooth = expect_solved(*mcp, Vec::Zero(400), SemismoothNewton{.stop = {.tol = 1e-12}});
  EXPECT_EQ(crash.stats.pivots, 0);
  EXPECT_GT(crash.stats.crash_iterations, 0);
  EXPECT_GT(pivoted.stats.pivots, 0);
  EXPECT_EQ(pivoted.stats.crash_iterations, 0);
  EXPECT_LE((crash.x - pivoted.x).lpNorm<Eigen::Infinity>(), 1e-9);
  EXPECT_LE((crash.x - semismooth.x).lpNorm<Eigen::Infinity>(), 1e-9);
}

// J' is the same with or without units: the same problem in other units, row and column, is solved as well.
TEST(PathSearch, SolvesInBadUnits) {
  Random random(6);
  for (int k = 0; k < 20; ++k) {
    const auto [functions, solution] = support::planted(6, 0, random);
    const Vec R = Vec::NullaryExpr(6, [&](Index) { return std::ldexp(1, random.integer(0, 20)); });
    const Vec C = Vec::NullaryExpr(6, [&](Index) { return std::ldexp(1, random.integer(-10, 10)); });
    Functions scaled = functions;
    scaled.box = {functions.box.lower.cwiseQuotient(C), functions.box.upper.cwiseQuotient(C)};
    scaled.F = [F = functions.F, R, C](In x, Out out) {
      Vec y(x.size());
      const bool defined = F(x.cwiseProduct(C), y);
      out = y.cwiseProduct(R);
      return defined;
    };
    scaled.J = [J = functions.J, R, C](In x, SpMat& out) {
      const bool defined = J(x.cwiseProduct(C), out);
      for (Index j = 0; j < out.cols(); ++j)
        for (SpMat::InnerIterator e(out, j); e; ++e) e.valueRef() *= R[e.row()] * C[j];
      return defined;
    };
    const Result result = expect_solved(*make_mcp(scaled), (3 * random.normals(6)).cwiseQuotient(C), path());
    EXPECT_LE((result.x.cwiseProduct(C) - solution).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace perp::ncp
