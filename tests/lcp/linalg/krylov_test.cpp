// SPDX-License-Identifier: Apache-2.0
/// Krylov solves of Newton systems H = Da + Db J against sparse LU.
#include "lcp/linalg/krylov.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {
namespace {

/// -Laplace + wind d/dx on an N x N grid, times h^2; symmetric where wind = 0.
SpMat grid(int N, double wind, double shift = 0) {
  const Index n = static_cast<Index>(N) * N;
  SpMat A(n, n);
  A.reserve(Eigen::VectorXi::Constant(n, 5));
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int k = j * N + i;
      if (j > 0) A.insert(k - N, k) = -1;
      if (i > 0) A.insert(k - 1, k) = -1 + wind;
      A.insert(k, k) = 4 + shift;
      if (i + 1 < N) A.insert(k + 1, k) = -1 - wind;
      if (j + 1 < N) A.insert(k + N, k) = -1;
    }
  A.makeCompressed();
  return A;
}

struct System {
  SpMat J;
  Vec Da, Db, b;
  SpMat H() const {
    SpMat H = Db.asDiagonal() * J;
    H += SpMat(Da.asDiagonal());
    return H;
  }
};

/// Diagonals as the Fischer-Burmeister function gives them: (1 - c, 1 - s), c^2 + s^2 = 1, some of them at bounds.
System random_system(const SpMat& J, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  System s{.J = J, .Da = Vec(J.rows()), .Db = Vec(J.rows()), .b = Vec(J.rows())};
  for (Index i = 0; i < J.rows(); ++i) {
    const double u = uniform(engine);
    const double angle = u < 0.3 ? 0 : u < 0.6 ? 1.5707963267948966 : 1.5707963267948966 * uniform(engine);
    s.Da[i] = u < 0.3 ? 0 : 1 - std::cos(angle);
    s.Db[i] = u < 0.3 ? 1 : u < 0.6 ? 0 : 1 - std::sin(angle);
    s.b[i] = 2 * uniform(engine) - 1;
  }
  return s;
}

Vec exact(const System& s) {
  SparseLu lu;
  EXPECT_EQ(lu.factor(s.H()), LuStatus::Ok);
  Vec d(s.b.size());
  lu.solve_refined(s.b, d);
  return d;
}

// Catches: rows divided or eliminated wrongly, a residual measured in another norm than promised.
TEST(Krylov, AgreesWithLuWhereSymmetric) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const System s = random_system(grid(40, 0), seed);
    const KrylovResult found = KrylovSystem(s.J, s.Da, s.Db).solve(s.b, 1e-12);
    ASSERT_TRUE(found.solved()) << found.reduction;
    EXPECT_EQ(found.kind, KrylovKind::ConjugateGradients);
    EXPECT_LE((s.H() * found.d - s.b).norm(), 1.2e-12 * s.b.norm());
    EXPECT_LT((found.d - exact(s)).lpNorm<Eigen::Infinity>(), 1e-9);
  }
}

// Catches: a transposed block, which a symmetric J does not show.
TEST(Krylov, AgreesWithLuWhereNot) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const System s = random_system(grid(30, 0.6), seed);
    const KrylovResult found = KrylovSystem(s.J, s.Da, s.Db).solve(s.b, 1e-10);
    ASSERT_TRUE(found.solved()) << found.reduction;
    EXPECT_EQ(found.kind, KrylovKind::BiCgStab);
    EXPECT_LT((found.d - exact(s)).lpNorm<Eigen::Infinity>(), 1e-7);
  }
}

// Indefinite: conjugate gradients must not be believed. Catches: no second solver after negative curvature.
TEST(Krylov, AgreesWithLuWhereIndefinite) {
  System s = random_system(grid(20, 0, -0.4), 3);
  s.Da.setZero();
  s.Db.setOnes();
  const KrylovResult found = KrylovSystem(s.J, s.Da, s.Db).solve(s.b, 1e-9);
  ASSERT_TRUE(found.solved()) << found.reduction;
  EXPECT_LT((found.d - exact(s)).norm(), 1e-5 * exact(s).norm());
}

/// [Q -A'; A 0], Q the grid's matrix, row k of A the sum of the k-th pair of neighbours: the multipliers' rows have
/// nothing on the diagonal.
SpMat saddle_point(int N) {
  const SpMat Q = grid(N, 0, 0.1);
  const Index n = Q.rows();
  const Index m = n / 4;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(Q, j); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(j), it.value());
  for (int k = 0; k < m; ++k)
    for (const int j : {4 * k, 4 * k + 1}) {
      entries.emplace_back(static_cast<int>(n) + k, j, 1);
      entries.emplace_back(j, static_cast<int>(n) + k, -1);
    }
  SpMat J(n + m, n + m);
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

// The Karush-Kuhn-Tucker system of a quadratic program (Nocedal & Wright 2006, section 16.1): equations only, and
// inequalities, whose rows are the Fischer-Burmeister function's. Catches: rows without a diagonal entry that are taken
// for known.
TEST(Krylov, SaddlePoints) {
  const SpMat J = saddle_point(20);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    System s = random_system(J, seed);
    const Index rows = seed <= 5 ? s.b.size() : 400;
    s.Da.head(rows).setZero();
    s.Db.head(rows).setOnes();
    const KrylovResult found = KrylovSystem(s.J, s.Da, s.Db).solve(s.b, 1e-10);
    ASSERT_TRUE(found.solved()) << seed << ": " << found.reduction;
    EXPECT_LT((s.H() * found.d - s.b).norm(), 1.2e-10 * s.b.norm());
    EXPECT_LT((found.d - exact(s)).norm(), 1e-6 * exact(s).norm());
  }
}

// Catches: an interrupt that waits for the end of a solve, or is told as a failure to converge.
TEST(Krylov, StopsInsideSolvesWhenAsked) {
  for (const double wind : {0.0, 0.6}) {
    const System s = random_system(grid(60, wind), 2);
    int polls = 0;
    const Limits limits{.interrupted = [&polls] { return ++polls > 6; }};
    KrylovSystem system(s.J, Vec::Zero(s.b.size()), Vec::Ones(s.b.size()), {.drop = 0.1}, limits);
    const KrylovResult found = system.solve(s.b, 1e-12);
    EXPECT_EQ(found.end, KrylovEnd::Stopped);
    EXPECT_GE(found.iterations, 1);
    EXPECT_LE(found.iterations, 6);
    polls = 0;
    const Vec d = damped_least_squares(s.J, s.Da, s.Db, s.b, 0.01, 1e-12, 2000, limits);
    EXPECT_EQ(polls, 7);
    EXPECT_EQ(d, damped_least_squares(s.J, s.Da, s.Db, s.b, 0.01, 1e-12, 6));
    // Before anything is made:
    const KrylovResult nothing =
        KrylovSystem(s.J, s.Da, s.Db, {}, {.interrupted = [] { return true; }}).solve(s.b, 0.1);
    EXPECT_EQ(nothing.end, KrylovEnd::Stopped);
    EXPECT_EQ(nothing.iterations, 0);
  }
}

// 40 000 unknowns, not symmetric: past its deadline a solve ends as soon as the incomplete LU factorization is there.
// The first solve, of one iteration, says how long that takes. Catches: iterations that do not look at the clock.
TEST(Krylov, EndsAtItsDeadline) {
  using Clock = std::chrono::steady_clock;
  const System s = random_system(grid(200, 0.6), 2);
  const Vec zero = Vec::Zero(s.b.size());
  const Vec one = Vec::Ones(s.b.size());
  const auto begin = Clock::now();
  (void)KrylovSystem(s.J, zero, one, {.max_iterations = 1, .drop = 1e-2}).solve(s.b, 0.5);
  const auto once = Clock::now() - begin;
  const auto again = Clock::now();
  const Limits limits{.deadline = again + std::chrono::milliseconds(50)};
  const KrylovResult found =
      KrylovSystem(s.J, zero, one, {.max_iterations = 1'000'000, .drop = 1e-2}, limits).solve(s.b, 1e-30);
  const auto taken = Clock::now() - again;
  EXPECT_EQ(found.end, KrylovEnd::Stopped);
  EXPECT_LT(taken, 3 * once + std::chrono::milliseconds(300));
}

// Multigrid: the number of iterations does not grow with the grid. Catches: a preconditioner of another matrix.
TEST(Krylov, IterationsDoNotGrowWithTheGrid) {
  int least = 1000;
  int most = 0;
  for (const int N : {60, 120, 240}) {
    const System s = random_system(grid(N, 0), 5);
    const KrylovResult found = KrylovSystem(s.J, Vec::Zero(s.b.size()), Vec::Ones(s.b.size())).solve(s.b, 1e-8);
    ASSERT_TRUE(found.solved());
    least = std::min(least, found.iterations);
    most = std::max(most, found.iterations);
  }
  EXPECT_LE(most, 2 * least);
  EXPECT_LE(most, 25);
}

// Catches: a second right-hand side that meets the first one's leavings.
TEST(Krylov, KeepsItsPreconditionerForOtherRightHandSides) {
  for (const double wind : {0.0, 0.6}) {
    System s = random_system(grid(30, wind), 9);
    KrylovSystem system(s.J, s.Da, s.Db);
    ASSERT_TRUE(system.solve(s.b, 1e-10).solved());
    s.b = random_system(s.J, 10).b;
    const KrylovResult found = system.solve(s.b, 1e-10);
    ASSERT_TRUE(found.solved());
    EXPECT_LT((found.d - exact(s)).lpNorm<Eigen::Infinity>(), 1e-7);
  }
}

// Everything at bounds; nothing to do; a row that says nothing; no iterations. Catches: crashes and false claims.
TEST(Krylov, Extremes) {
  const SpMat J = grid(10, 0);
  const Vec ones = Vec::Ones(100);
  const Vec zero = Vec::Zero(100);
  EXPECT_EQ(KrylovSystem(J, ones, zero).solve(ones, 1e-8).d, ones);
  const KrylovResult nothing = KrylovSystem(J, ones, ones).solve(zero, 1e-8);
  EXPECT_TRUE(nothing.solved());
  EXPECT_EQ(nothing.d, zero);
  Vec hole = ones;
  hole[7] = 0;
  EXPECT_FALSE(KrylovSystem(J, zero, hole).solve(ones, 1e-8).solved());
  KrylovOptions short_of{};
  short_of.max_iterations = 1;
  const KrylovResult cut = KrylovSystem(J, zero, ones, short_of).solve(ones, 1e-14);
  EXPECT_EQ(cut.solved(), (J * cut.d - ones).norm() <= 1.2e-14 * ones.norm());
}

// The normal equations H'H d + nu d = H'b, and descent wherever the iterations stop, for a singular H. Catches: a sign,
// a scaling that is not undone.
TEST(Krylov, DampedLeastSquares) {
  System s = random_system(grid(12, 0.6), 4);
  s.Da[5] = s.Db[5] = 0;
  const SpMat H = s.H();
  const double nu = 0.01;
  const Vec d = damped_least_squares(s.J, s.Da, s.Db, s.b, nu, 1e-12, 2000);
  const Vec right = H.transpose() * s.b;
  EXPECT_LT((H.transpose() * (H * d) + nu * d - right).norm(), 1e-9 * right.norm());
  for (const int k : {1, 2, 5, 20}) EXPECT_GT(damped_least_squares(s.J, s.Da, s.Db, s.b, nu, 1e-12, k).dot(right), 0);
}

}  // namespace
}  // namespace perp::lcp
