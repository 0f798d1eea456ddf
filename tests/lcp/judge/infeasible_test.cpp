// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/infeasible.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lcp/adversarial_support.hpp"
#include "lcp/exact_judge.hpp"
#include "lcp/solve/solve.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::vec;

// The definition by hand, every kind of bound. Catches a sign taken from the wrong bound.
TEST(ProvesInfeasible, ByHand) {
  const AffineMcp lcp = standard_lcp(matrix({{0, -1}, {1, 0}}), vec({-1, -1}));
  EXPECT_TRUE(proves_infeasible(lcp, vec({1, 0})));  // -z_2 - 1 >= 0
  EXPECT_EQ(infeasible_radius(lcp, vec({1, 0})), infinity);
  EXPECT_FALSE(proves_infeasible(lcp, vec({0, 1})));   // z_1 - 1 >= 0 is possible
  EXPECT_FALSE(proves_infeasible(lcp, vec({-1, 0})));  // not a sign that F_1 >= 0 allows
  EXPECT_FALSE(proves_infeasible(lcp, vec({0, 0})));
  EXPECT_FALSE(proves_infeasible(lcp, vec({1})));
  // z_2 <= 3 bounds what z_2 can do for row 1: z_2 - 4 >= 0 has no solution, z_2 - 3 >= 0 has one.
  AffineMcp box{matrix({{0, 1}, {0, 0}}), vec({-4, 0}), {vec({0, 0}), vec({infinity, 3})}};
  EXPECT_TRUE(proves_infeasible(box, vec({1, 0})));
  EXPECT_FALSE(proves_infeasible(box, vec({1, 1})));  // F_2 may have any sign
  box.q[0] = -3;
  EXPECT_FALSE(proves_infeasible(box, vec({1, 0})));
  // z_1 = 1 and z_1 = 2, both z free: y = (-1, 1).
  const AffineMcp equations{matrix({{1, 0}, {1, 0}}), vec({-1, -2}), Box::free(2)};
  EXPECT_TRUE(proves_infeasible(equations, vec({-1, 1})));
}

// M'y = (2^-50, 0) for y = (1, 1) is no rounding: z = 2^50 (1, 1) has F = 0. A tolerance of 1e-12 called it infeasible.
TEST(ProvesInfeasible, RowsThatAreNearlyDependent) {
  const AffineMcp solvable = standard_lcp(matrix({{1, -1}, {-1 + 0x1p-50, 1}}), vec({0, -1}));
  ASSERT_EQ(sgn(exact::residual(solvable, vec({0x1p50, 0x1p50}))), 0);
  EXPECT_FALSE(proves_infeasible(solvable, vec({1, 1})));
  EXPECT_LE(infeasible_radius(solvable, vec({1, 1})), 0x1p50);
  EXPECT_EQ(exact_certificate(solvable, vec({1, 1})).size(), 0);
  const AffineMcp none = standard_lcp(matrix({{1, -1}, {-1 - 0x1p-50, 1}}), vec({0, -1}));
  EXPECT_TRUE(proves_infeasible(none, vec({1, 1})));
}

// y = (1, 1/3) in doubles leaves 2^-54 in M'y, of the wrong sign; (3, 1) does not.
TEST(ExactCertificate, FindsMultiplesOfFewDigits) {
  const AffineMcp problem = standard_lcp(matrix({{1, -1}, {-3, 3}}), vec({-1, 0}));
  Vec y = vec({1, 1.0 / 3});
  y[1] = std::nextafter(y[1], 0);
  ASSERT_FALSE(exact::proof(problem, y).proves_all());
  const Vec certificate = exact_certificate(problem, y);
  ASSERT_EQ(certificate.size(), 2);
  EXPECT_TRUE(exact::proof(problem, certificate).proves_all());
  EXPECT_EQ(certificate[0], 3 * certificate[1]);
}

// Data of all digits, M'y = 0 in n - 1 columns but for rounding: a y nearby has M'y < 0.
TEST(ExactCertificate, MovesInside) {
  Random random(1);
  for (int run = 0; run < 50; ++run) {
    const Index n = random.integer(2, 12);
    Vec y = random.normals(n).cwiseAbs();
    Dense M = random.normals(n, n);
    M.row(0) = -(y.tail(n - 1).transpose() * M.bottomRows(n - 1)) / y[0];
    M.col(n - 1) = -M.col(n - 1).cwiseAbs();
    Vec q = random.normals(n);
    q[0] -= (q.dot(y) + 1) / y[0];
    const AffineMcp problem = standard_lcp(sparse(M), q);
    const Vec certificate = exact_certificate(problem, y);
    ASSERT_EQ(certificate.size(), n) << run;
    EXPECT_TRUE(exact::proof(problem, certificate).proves_all()) << run;
  }
}

// M = a r', z free: y = (a_2 / a_1, -1, 0 ..) has M'y = 0, and no y beside it in doubles has. The radius is that of
// twice the digits, and the referee agrees that there is no solution. Where M is singular only but for 2^-50 it is not.
TEST(ProvesInfeasible, CorrectsTheRoundingOfY) {
  Random random(2);
  for (int run = 0; run < 40; ++run) {
    const Index n = random.integer(3, 5);
    const auto digits = [&] { return random.integer(1001, 9999) * 0x1p-10; };
    const Vec r = Vec::NullaryExpr(n, [&] { return digits(); });
    const Vec a = Vec::NullaryExpr(n, [&] { return digits(); });
    const Dense M = a * r.transpose();
    const Vec q = Vec::NullaryExpr(n, [&] { return digits(); });
    const AffineMcp problem{sparse(M), q, Box::free(n)};
    Vec y = Vec::Zero(n);  // orthogonal to a, y'q < 0
    y[0] = a[1] / a[0];
    y[1] = -1;
    if (std::abs(y.dot(q)) < 1e-6) continue;
    if (y.dot(q) > 0) y = -y;
    ASSERT_FALSE(exact::decide(problem).solvable);
    EXPECT_GE(infeasible_radius(problem, y), proof_radius);
    EXPECT_TRUE(proves_infeasible(problem, y));
    AffineMcp other = problem;
    other.M.coeffRef(0, 0) *= 1 + 0x1p-50;
    EXPECT_FALSE(proves_infeasible(other, y));
  }
}

// Exponents of 680 and more, as powers of two: nothing changes.
TEST(ProvesInfeasible, AtAnyScale) {
  const AffineMcp problem{matrix({{1, -2, 0}, {-1, 2, 0}, {0, 3, -1}}), vec({-1, 0.5, 1}), Box::nonnegative(3)};
  const Vec y = vec({1, 1, 0});
  for (const double row : {0x1p-340, 1.0, 0x1p340})
    for (const double column : {0x1p-340, 1.0, 0x1p340}) {
      AffineMcp scaled = problem;
      const Vec rows = vec({row, 1, 1 / row});
      const Vec columns = vec({1 / column, column, 1});
      scaled.M = rows.asDiagonal() * problem.M * columns.asDiagonal();
      scaled.q = rows.cwiseProduct(problem.q);
      EXPECT_TRUE(proves_infeasible(scaled, y.cwiseQuotient(rows))) << row << " " << column;
      scaled.q[1] *= 2;
      EXPECT_FALSE(proves_infeasible(scaled, y.cwiseQuotient(rows))) << row << " " << column;
    }
}

// Problems with a solution, which enumeration (a fixed rounding of 1e-12) or principal pivoting called infeasible.
TEST(ProvesInfeasible, WhatWasCalledInfeasible) {
  for (const unsigned seed : {5139U, 6349U, 6958U, 7523U, 10194U, 11229U, 11264U, 14930U, 16093U, 19532U}) {
    const adversarial::Problem made = adversarial::make(seed);
    for (const double tol : {1e-6, 1e-9, 1e-12}) {
      Limits limits;
      limits.tol = tol;
      for (const Method& method : {Method(Enumeration{}), Method(PrincipalPivoting{})})
        EXPECT_NE(solve(made.mcp, made.start, method, limits).status, Status::Infeasible) << made.what;
    }
  }
}

}  // namespace
}  // namespace perp::lcp
