// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/principal_pivoting.hpp"

#include <gtest/gtest.h>

#include <tuple>

#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

// Planted solutions of P-matrices in every kind of box, degenerate or not, cold and warm.
TEST(PrincipalPivoting, SolvesPMatrices) {
  Random random(1);
  for (int run = 0; run < 200; ++run) {
    const Index n = random.integer(1, 40);
    const SpMat M = run % 2 == 0 ? support::h_plus(n, 3, random) : support::p_matrix(n, 2, random);
    const Box box = run % 3 == 0 ? Box::nonnegative(n) : support::mixed_box(n, random);
    const auto [problem, solution] = plant(M, box, run % 4 < 2 ? 0 : 0.5, random);
    for (const Vec& start : {Vec(Vec::Zero(n)), Vec(10 * random.normals(n)), solution})
      expect_solved(problem, principal_pivoting(problem, start), "run " + std::to_string(run));
  }
}

// Positive semidefinite, neither symmetric nor definite: the KKT systems of random convex QPs
//     min x'Q x / 2 + c'x,  A x >= b,  x >= 0,   M = [Q -A'; A 0],  q = (c, -b)
// with Q of rank n / 2 and a planted solution. 2 x 2 pivots are needed (the diagonal of the second block is zero).
TEST(PrincipalPivoting, SolvesConvexQuadraticPrograms) {
  Random random(2);
  for (int run = 0; run < 150; ++run) {
    const Index n = random.integer(1, 15);
    const Index m = random.integer(1, 15);
    const Dense B = random.normals(n, n / 2);
    const Dense A = random.normals(m, n);
    Dense M = Dense::Zero(n + m, n + m);
    if (run % 3 > 0) M.topLeftCorner(n, n) = B * B.transpose();  // else a linear program
    M.topRightCorner(n, m) = -A.transpose();
    M.bottomLeftCorner(m, n) = A;
    const Box box = run % 2 == 0 ? Box::nonnegative(n + m) : support::mixed_box(n + m, random);
    const auto [problem, solution] = plant(support::sparse(M), box, run % 4 < 2 ? 0 : 0.4, random);
    expect_solved(problem, principal_pivoting(problem, Vec::Zero(n + m)), "run " + std::to_string(run));
    expect_solved(problem, principal_pivoting(problem, solution), "warm run " + std::to_string(run));
  }
}

// Positive semidefinite problems in general, feasible or not: solved, or infeasible with a proof; never anything else.
// Catches a ray that is no certificate, a certificate lost on the way back from the standard form.
TEST(PrincipalPivoting, DecidesSemidefiniteProblems) {
  Random random(3);
  int solved = 0;
  int infeasible = 0;
  for (int run = 0; run < 400; ++run) {
    const Index n = random.integer(1, 20);
    const Index rank = random.integer(0, static_cast<int>(n) / 2);
    Dense B = random.normals(n, rank);
    Dense S = random.normals(n, n);
    if (run % 2 == 0) {  // degenerate: small integers
      B = B.unaryExpr([](double a) { return std::round(a); });
      S = S.unaryExpr([&](double a) { return random.chance(0.5) ? 0 : std::round(a); });
    }
    const Dense M = rank > 0 ? Dense(B * B.transpose() + S - S.transpose()) : Dense(S - S.transpose());
    Vec q = random.normals(n);
    if (run % 2 == 0) q = q.unaryExpr([](double a) { return std::round(a); });
    const AffineMcp problem{support::sparse(M), q, run % 4 < 2 ? Box::nonnegative(n) : support::mixed_box(n, random)};
    const Result result = principal_pivoting(problem, Vec::Zero(n));
    expect_honest(problem, result, "run " + std::to_string(run));
    if (result.status == Status::Infeasible) {
      ++infeasible;
      EXPECT_GT(result.certificate.size(), 0);
    } else {
      expect_solved(problem, result, "run " + std::to_string(run));
      ++solved;
    }
  }
  EXPECT_GT(solved, 50);
  EXPECT_GT(infeasible, 50);
}

// min x1 + x2 (no bounds on x): no solution with a certificate; x free with a singular block is split.
TEST(PrincipalPivoting, FreeVariablesWithoutPivot) {
  // Equality-constrained: Q x + A'y + c = 0, A x = b with Q = diag(1, 0), A = (1 1): M_UU = [1 0 -1; 0 0 -1; 1 1 0].
  const AffineMcp saddle{matrix({{1, 0, -1}, {0, 0, -1}, {1, 1, 0}}), vec({-1, 2, -3}), Box::free(3)};
  const Result result = principal_pivoting(saddle, Vec::Zero(3));
  expect_solved(saddle, result, "saddle");
  EXPECT_LT(norm_inf(result.z - vec({3, 0, 2})), 1e-14);
  // 0 = 1 and 0 = 0.
  const AffineMcp nonsense{matrix({{0, 0}, {0, 0}}), vec({1, 0}), Box::free(2)};
  const Result none = principal_pivoting(nonsense, Vec::Zero(2));
  EXPECT_EQ(none.status, Status::Infeasible);
  EXPECT_TRUE(proves_infeasible(nonsense, none.certificate));
  // The free variable's own diagonal is zero, its column is not: z_2 = 2 (row 1), z_1 = -3 (row 2).
  const AffineMcp skew{matrix({{0, 1}, {-1, 0}}), vec({-2, -3}), {vec({-infinity, 0}), vec({infinity, infinity})}};
  const Result s = principal_pivoting(skew, Vec::Zero(2));
  expect_solved(skew, s, "skew");
  EXPECT_LT(norm_inf(s.z - vec({-3, 2})), 1e-14);
}

// Sufficient, neither P nor semidefinite: [0 1; -a 0] with a > 0, a != 1, and its principal rescalings (Cottle, Pang &
// Venkateswaran 1989, sufficient matrices).
TEST(PrincipalPivoting, SufficientMatrices) {
  Random random(4);
  for (int run = 0; run < 100; ++run) {
    const Index n = random.integer(1, 12);
    const Dense S = random.normals(n, n);
    const Vec d = Vec::NullaryExpr(n, [&] { return std::exp2(random.integer(-3, 2)); });
    const Vec e = Vec::NullaryExpr(n, [&] { return std::exp2(random.integer(-3, 2)); });
    // Rows and columns scaled, without rounding: sufficient.
    const Dense M = d.asDiagonal() * (S - S.transpose()) * e.asDiagonal();
    const AffineMcp problem = standard_lcp(support::sparse(M), random.normals(n));
    const Result result = principal_pivoting(problem, Vec::Zero(n));
    expect_honest(problem, result, "run " + std::to_string(run));
    EXPECT_TRUE(result.solved() || result.status == Status::Infeasible) << result.message;
  }
}

// Cottle, Pang & Stone 1992: M = [-1] is not sufficient, which a pivot shows; the bimatrix game of example 4.4.23 is
// not either, which shows in a ray that proves nothing (the game has solutions).
TEST(PrincipalPivoting, SaysWhereItDoesNotApply) {
  const Result result = principal_pivoting(standard_lcp(matrix({{-1}}), vec({-1})), Vec::Zero(1));
  EXPECT_EQ(result.status, Status::NotApplicable);
  const AffineMcp game =
      standard_lcp(matrix({{0, 0, 10, 20}, {0, 0, 30, 15}, {10, 20, 0, 0}, {30, 15, 0, 0}}), vec({-1, -1, -1, -1}));
  const Result none = principal_pivoting(game, Vec::Zero(4));
  EXPECT_EQ(none.status, Status::Ray) << none.message;
  EXPECT_NE(none.message.find("not sufficient"), std::string::npos);
}

TEST(PrincipalPivoting, HonestOnAnything) {
  Random random(5);
  for (int run = 0; run < 400; ++run) {
    const Index n = random.integer(0, 12);
    Dense M = random.normals(n, n);
    Vec q = random.normals(n);
    if (run % 4 == 1) M = M.unaryExpr([&](double a) { return random.chance(0.6) ? 0 : std::round(a); });
    if (run % 4 == 2)
      for (Index i = 0; i < n; ++i) {
        const double row = std::pow(10, random.integer(-8, 8));
        M.row(i) *= row;
        q[i] *= row;
      }
    if (run % 4 == 3 && n > 0) M.row(random.integer(0, static_cast<int>(n) - 1)).setZero();
    const AffineMcp problem{support::sparse(M), q, support::mixed_box(n, random)};
    expect_honest(problem, principal_pivoting(problem, random.normals(n)), "run " + std::to_string(run));
  }
}

TEST(PrincipalPivoting, EdgesAndRefusals) {
  const AffineMcp one = standard_lcp(matrix({{2}}), vec({-1}));
  EXPECT_TRUE(principal_pivoting({SpMat(0, 0), Vec(0), Box::nonnegative(0)}, Vec(0)).solved());
  const AffineMcp fixed{matrix({{2}}), vec({-1}), {vec({3}), vec({3})}};
  EXPECT_EQ(principal_pivoting(fixed, vec({0})).z[0], 3);
  EXPECT_EQ(principal_pivoting(one, vec({0}), {.max_iterations = 0}).status, Status::IterationLimit);
  Limits limits;
  limits.interrupted = [] { return true; };
  EXPECT_EQ(principal_pivoting(one, vec({0}), {}, limits).status, Status::Interrupted);
  EXPECT_THROW(principal_pivoting(one, vec({0, 0})), std::invalid_argument);
  EXPECT_THROW(principal_pivoting(one, vec({0}), {.max_iterations = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
