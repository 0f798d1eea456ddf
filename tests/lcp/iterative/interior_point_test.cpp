// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/interior_point.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "lcp/pivoting/pivoting_support.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::Triplets;
using support::vec;

/// B B' + skew, symmetric part of rank n/2 at most; a solution planted in the box, degenerate with that probability.
AffineMcp monotone(Index n, const Box& box, double degenerate, Random& random) {
  return plant(support::psd_plus_skew(n, 2, random), box, degenerate, random).problem;
}

// Rank-deficient monotone problems, every kind of interval, with and without strict complementarity: catches a wrong
// sign of the upper slacks, an end that trusts a nearly active set, free variables without regularisation.
TEST(InteriorPoint, SolvesMonotoneProblems) {
  Random random(1);
  for (const double degenerate : {0.0, 0.3, 1.0})
    for (int repeat = 0; repeat < 20; ++repeat) {
      const Index n = random.integer(1, 80);
      const AffineMcp problem =
          monotone(n, repeat % 2 ? support::mixed_box(n, random) : Box::nonnegative(n), degenerate, random);
      const Result result = interior_point(problem, random.normals(n));
      expect_solved(problem, result, "n = " + std::to_string(n) + ", " + std::to_string(degenerate));
      EXPECT_LE(result.iterations, 60);
    }
}

// The result is at the level of rounding where the solution is unique: catches the loss of the last, linear solve.
TEST(InteriorPoint, EndsWithAllDigits) {
  Random random(2);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Index n = 200;
    const PlantedLinear planted = plant(SpMat(support::psd_plus_skew(n, 2, random) + support::tridiagonal(n, 0, 1, 0)),
                                        support::mixed_box(n, random), 0.2, random);
    const Result result = interior_point(planted.problem, Vec::Zero(n));
    expect_solved(planted.problem, result, "definite");
    EXPECT_LE(result.residual, 1e-13 * (1 + norm_inf(planted.problem.q)));
    EXPECT_LE(norm_inf(result.z - planted.solution), 1e-9);
    EXPECT_LE(result.iterations, 40);
  }
}

TEST(InteriorPoint, LargeAndSparse) {
  Random random(3);
  const Index n = 10000;
  Triplets entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1e-3);
    if (i + 1 < n) entries.emplace_back(i, i + 1, random.normal());
  }
  const SpMat B = support::from(n, entries);
  const SpMat Bt = B.transpose();
  const SpMat M = B * Bt + SpMat(B - Bt);
  const AffineMcp problem = plant(M, support::mixed_box(n, random), 0.2, random).problem;
  const Result result = interior_point(problem, Vec::Zero(n));
  expect_solved(problem, result, "n = 10000");
  EXPECT_LE(result.iterations, 50);
}

// A small linear program as an LCP (skew M), a quadratic program in equality form, and bounds of all kinds by hand.
TEST(InteriorPoint, ClosedForms) {
  // min -x1 - 2 x2 with x1 + x2 <= 4, x2 <= 3: x = (1, 3), multipliers (1, 1).
  const AffineMcp lp =
      standard_lcp(matrix({{0, 0, 1, 0}, {0, 0, 1, 1}, {-1, -1, 0, 0}, {0, -1, 0, 0}}), vec({-1, -2, 4, 3}));
  const Result solved = interior_point(lp, Vec::Zero(4));
  expect_solved(lp, solved, "linear program");
  EXPECT_LE(norm_inf(solved.z - vec({1, 3, 1, 1})), 1e-12);
  // min (x1^2 + x2^2) / 2 with x1 + x2 = 2, x1 <= 0.5: x = (0.5, 1.5), free multiplier.
  AffineMcp qp{.M = matrix({{1, 0, -1}, {0, 1, -1}, {1, 1, 0}}), .q = vec({0, 0, -2}), .box = Box::free(3)};
  qp.box.upper[0] = 0.5;
  const Result x = interior_point(qp, Vec::Zero(3));
  expect_solved(qp, x, "quadratic program");
  EXPECT_LE(norm_inf(x.z - vec({0.5, 1.5, 1.5})), 1e-12);
}

// Infeasible monotone problems: the certificate must hold; a feasible neighbour must not be called infeasible.
TEST(InteriorPoint, ProvesInfeasibility) {
  // Rows say z1 - z2 >= 1 and z2 - z1 >= 0.
  const AffineMcp small = standard_lcp(matrix({{1, -1}, {-1, 1}}), vec({-1, 0}));
  const Result result = interior_point(small, Vec::Zero(2));
  EXPECT_EQ(result.status, Status::Infeasible) << result.message;
  EXPECT_TRUE(proves_infeasible(small, result.certificate));
  // An infeasible and unbounded linear program, and inconsistent equations.
  const AffineMcp lp = standard_lcp(matrix({{0, 0, -1}, {0, 0, 1}, {1, -1, 0}}), vec({1, 1, -3}));
  EXPECT_TRUE(interior_point(lp, Vec::Zero(3)).solved());
  const AffineMcp none = standard_lcp(matrix({{0, 1}, {-1, 0}}), vec({1, -1}));
  EXPECT_EQ(interior_point(none, Vec::Zero(2)).status, Status::Infeasible);
  const AffineMcp equations{.M = matrix({{1, 1}, {1, 1}}), .q = vec({1, 2}), .box = Box::free(2)};
  const Result inconsistent = interior_point(equations, Vec::Zero(2));
  EXPECT_FALSE(inconsistent.solved());
  expect_honest(equations, inconsistent, "inconsistent equations");
  Random random(4);
  int proven = 0;
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Index n = 30;
    const auto integers = [&](Index columns) -> Dense {
      return random.normals(n, columns).unaryExpr([](double a) { return std::round(2 * a); });
    };
    const Dense B = integers(n);
    const Vec y = integers(1).cwiseMax(0);
    // M = P (B B' + skew) P with P y = 0: M'y = 0, and q'y < 0. Integers over a power of two, so that this is exact.
    const double scale = std::exp2(-std::round(std::log2(y.squaredNorm())));
    const Dense P = scale * (y.squaredNorm() * Dense::Identity(n, n) - y * y.transpose());
    const Dense M = 0.25 * P * (B * B.transpose() + (B - B.transpose())) * P;
    const Vec q = P * integers(1) - scale * y;
    ASSERT_TRUE((M.transpose() * y).isZero(0));
    const AffineMcp problem = standard_lcp(sparse(M), q);
    const Result r = interior_point(problem, Vec::Zero(n));
    expect_honest(problem, r, "dense " + std::to_string(repeat));
    EXPECT_FALSE(r.solved());
    proven += r.status == Status::Infeasible;
  }
  EXPECT_GE(proven, 15);
}

TEST(InteriorPoint, HonestWhereThereIsNoGuarantee) {
  Random random(5);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Index n = random.integer(1, 15);
    SpMat M = support::random_sparse(n, 2, random);
    if (repeat % 2) {
      const Vec scale = Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-4, 4)); });
      M = scale.asDiagonal() * M * scale.asDiagonal();
    }
    if (repeat % 5 == 0 && n > 1) M.prune([](Index i, Index, double) { return i != 1; });
    const AffineMcp problem{.M = M, .q = random.normals(n), .box = support::mixed_box(n, random)};
    expect_honest(problem, interior_point(problem, random.normals(n)), std::to_string(repeat));
  }
  const AffineMcp huge = standard_lcp(matrix({{1e200, 1e200}, {-1e200, 1e-200}}), vec({-1e200, -1}));
  expect_honest(huge, interior_point(huge, Vec::Ones(2)), "huge");
}

// Monotone and badly scaled: D M D with D over eight orders. Rows with terms of 1e8 are solved to rounding only.
TEST(InteriorPoint, BadlyScaled) {
  Random random(6);
  int solved = 0;
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Index n = random.integer(2, 30);
    const Vec D = Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-4, 4)); });
    const SpMat M = D.asDiagonal() * SpMat(support::psd_plus_skew(n, 2, random) + support::tridiagonal(n, 0, 0.1, 0)) *
                    D.asDiagonal();
    const AffineMcp problem = plant(M, support::mixed_box(n, random), 0.2, random).problem;
    const Result result = solve(problem, Vec::Zero(n), InteriorPoint{});
    EXPECT_TRUE(result.accepted()) << repeat << ": " << result.message;
    solved += result.solved() ? 1 : 0;
  }
  EXPECT_GE(solved, 12);  // 14 built by clang, 15 and more by GCC under every BLAS: the least, less 2
}

TEST(InteriorPoint, LimitsAndInput) {
  EXPECT_TRUE(interior_point(standard_lcp(SpMat(0, 0), Vec(0)), Vec(0)).solved());
  AffineMcp fixed{.M = matrix({{-1}}), .q = vec({1}), .box = {vec({2}), vec({2})}};
  EXPECT_TRUE(interior_point(fixed, Vec::Zero(1)).solved());
  const AffineMcp problem = standard_lcp(support::tridiagonal(50, -1, 2, -1), -Vec::Ones(50));
  EXPECT_EQ(interior_point(problem, Vec::Zero(50), {.max_iterations = 1}).status, Status::IterationLimit);
  Limits limits;
  limits.interrupted = [] { return true; };
  EXPECT_EQ(interior_point(problem, Vec::Zero(50), {}, limits).status, Status::Interrupted);
  EXPECT_THROW(interior_point(problem, Vec::Zero(50), {.proximal = 1}), std::invalid_argument);
  EXPECT_THROW(interior_point(problem, Vec::Zero(50), {.to_boundary = 1}), std::invalid_argument);
  EXPECT_THROW(interior_point(problem, Vec::Zero(5)), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
