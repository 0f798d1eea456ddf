// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/block_pivoting.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

constexpr BlockPivoting plain{.components = false};

// Planted solutions of P-matrices of every kind in every kind of box, degenerate or not, from several starts. Catches a
// wrong sign at upper bounds, a fixed variable that moves, a tie that makes it cycle.
TEST(BlockPivoting, SolvesPMatrices) {
  Random random(1);
  for (int run = 0; run < 200; ++run) {
    const Index n = random.integer(1, 60);
    const int kind = run % 4;
    SpMat M = support::h_plus(n, 3, random);
    if (kind == 1) M = support::m_matrix(n, 3, random);
    if (kind == 2) M = support::p_matrix(n, 2, random);
    if (kind == 3) {
      const Dense B = random.normals(n, n);
      const Dense S = random.normals(n, n);
      M = support::sparse(Dense(B * B.transpose() + 0.1 * Dense::Identity(n, n) + S - S.transpose()));
    }
    const Box box = run % 3 == 0 ? Box::nonnegative(n) : support::mixed_box(n, random);
    const auto [problem, solution] = plant(M, box, run % 2 == 0 ? 0 : 0.5, random);
    for (const Vec& start : {Vec(Vec::Zero(n)), Vec(10 * random.normals(n)), solution})
      for (const BlockPivoting& options : {BlockPivoting{}, plain}) {
        const Result result = block_pivoting(problem, start, options);
        expect_solved(problem, result, "run " + std::to_string(run));
        if (kind != 2) {
          EXPECT_LT(norm_inf(result.z - solution), 1e-6 * (1 + norm_inf(solution))) << "run " << run;
        }
      }
  }
}

// From the solution's places the run ends without an exchange.
TEST(BlockPivoting, WarmStartEndsAtOnce) {
  Random random(2);
  const auto [problem, solution] = plant(support::h_plus(50, 3, random), Box::nonnegative(50), 0, random);
  const Result cold = block_pivoting(problem, Vec::Zero(50), plain);
  EXPECT_GT(cold.iterations, 0);
  const Result warm = block_pivoting(problem, cold.z, plain);
  expect_solved(problem, warm, "warm");
  EXPECT_EQ(warm.iterations, 0);
  EXPECT_EQ(warm.factorizations, 1);
}

// The obstacle problem -Laplace u >= -1, u >= 0.1 - |x - (1/2, 1/2)|^2 on N x N points, u = 0 around: an M-matrix. The
// coincidence set moves by a mesh width or more a round, the method must not fall back to one unknown a round.
TEST(BlockPivoting, ObstacleProblem) {
  const int N = 60;
  const double h = 1.0 / (N + 1);
  AffineMcp problem = standard_lcp(support::five_point(N, 4), Vec::Constant(N * N, h * h));
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int k = j * N + i;
      problem.box.lower[k] = 0.1 - std::pow(h * (i + 1) - 0.5, 2) - std::pow(h * (j + 1) - 0.5, 2);
    }
  for (const Vec& start : {Vec(Vec::Ones(N * N)), problem.box.lower}) {
    const Result result = block_pivoting(problem, start);
    expect_solved(problem, result, "obstacle");
    EXPECT_LT(result.residual, 1e-13);
    EXPECT_LT(result.iterations, N) << result.message;
  }
}

// -Laplace u + (100, 50) . grad u on N x N points by upwind differences, times h^2, with a source that changes its sign
// four times: M is an M-matrix and not symmetric. The coincidence set alone moves by some mesh widths a round (26
// rounds at N = 100, 74 at N = 316). With places from coarser problems the rounds do not grow with N, whatever the box.
TEST(BlockPivoting, RoundsDoNotGrowWithTheMesh) {
  for (const int N : {60, 150}) {
    const double h = 1.0 / (N + 1);
    SpMat M = support::five_point(N, 4 + 150 * h);
    for (Index j = 0; j < M.cols(); ++j)
      for (SpMat::InnerIterator it(M, j); it; ++it) {
        if (it.row() == j + 1) it.valueRef() -= 100 * h;
        if (it.row() == j + N) it.valueRef() -= 50 * h;
      }
    Vec q(N * N);
    for (int k = 0; k < N * N; ++k)
      q[k] = -100 * h * h * std::sin(2 * M_PI * h * (k % N + 1)) * std::sin(2 * M_PI * h * (k / N + 1));
    for (const double upper : {infinity, 0.1}) {
      AffineMcp problem = standard_lcp(M, q);
      problem.box.upper.setConstant(upper);
      const Result result = block_pivoting(problem, Vec::Zero(N * N));
      expect_solved(problem, result, "N = " + std::to_string(N));
      EXPECT_LE(result.iterations, 15) << result.message;
    }
    AffineMcp mixed = standard_lcp(M, q);  // free and fixed unknowns between the others
    for (int k = 0; k < N * N; k += 5) mixed.box.lower[k] = -infinity;
    for (int k = 2; k < N * N; k += 11) mixed.box.lower[k] = mixed.box.upper[k] = 0.01;
    expect_solved(mixed, block_pivoting(mixed, Vec::Zero(N * N)), "mixed, N = " + std::to_string(N));
  }
}

// Murty's problems, exponential for one-by-one pivoting, by their reducibility: triangular matrices are solved by
// substitution. q = -e with both triangles (Murty 1988, section 6.2) and the right-hand side of Murty 1978.
TEST(BlockPivoting, MurtyInNoTime) {
  const auto begin = std::chrono::steady_clock::now();
  for (const Index n : {5, 20, 60}) {
    const SpMat U = support::murty(n);
    const SpMat L = U.transpose();
    const Vec minus_one = Vec::Constant(n, -1);
    for (const Vec& start : {Vec(Vec::Zero(n)), Vec(Vec::Ones(n))}) {
      const Result upper = block_pivoting(standard_lcp(U, minus_one), start);
      expect_solved(standard_lcp(U, minus_one), upper, "upper");
      EXPECT_EQ(upper.z, Vec(Vec::Unit(n, n - 1)));
      const Result lower = block_pivoting(standard_lcp(L, minus_one), start);
      expect_solved(standard_lcp(L, minus_one), lower, "lower");
      EXPECT_EQ(lower.z, Vec(Vec::Unit(n, 0)));
      const Result murty = block_pivoting(murty_1978(n), start);
      expect_solved(murty_1978(n), murty, "1978");
      EXPECT_EQ(murty.z, Vec(Vec::Unit(n, 0) * std::ldexp(1, static_cast<int>(n))));
    }
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

// Without reducibility the block rule still needs few rounds at n = 20, and a run that is too long says so. At n = 60
// from 0 the upper triangle is where the least-index rule is exponential.
TEST(BlockPivoting, MurtyAsAWhole) {
  const auto problem = [](Index n) { return standard_lcp(support::murty(n), Vec::Constant(n, -1)); };
  const Result result = block_pivoting(problem(20), Vec::Zero(20), plain);
  expect_solved(problem(20), result, "n = 20");
  EXPECT_LT(result.iterations, 100) << result.message;
  const Result limited = block_pivoting(problem(60), Vec::Zero(60), {.max_iterations = 200, .components = false});
  expect_honest(problem(60), limited, "n = 60");
  EXPECT_EQ(limited.status, Status::IterationLimit);
  EXPECT_EQ(limited.iterations, 200);
  EXPECT_NE(limited.message.find("least-index steps in 200 rounds"), std::string::npos) << limited.message;
}

// With p_max = 0 every round is a least-index step, and the fallback alone solves P-matrices. Of one round the message
// does not speak as of many.
TEST(BlockPivoting, FallbackAlone) {
  Random random(3);
  for (int run = 0; run < 50; ++run) {
    const Index n = random.integer(1, 12);
    const auto [problem, solution] = plant(support::p_matrix(n, 2, random), support::mixed_box(n, random), 0.5, random);
    const Result result = block_pivoting(problem, Vec::Zero(n), {.p_max = 0, .components = false});
    expect_solved(problem, result, "run " + std::to_string(run));
    const std::string steps = std::to_string(result.iterations);
    EXPECT_EQ(result.message, result.iterations == 1 ? "1 least-index step in 1 round"
                                                     : steps + " least-index steps in " + steps + " rounds");
  }
}

// Cottle, Pang & Stone 1992, example 4.1.3: the simple rule "any index" cycles on this P-matrix with q = -e; the
// least-index rule ends. From 0 on I + 2 (strict upper triangle) with q = -e it passes through all 2^n sets (Murty
// 1988, section 6.2: 2^n - 1 steps); with the lower triangle it needs one. No P-matrix: a cycle is noticed.
TEST(LeastIndex, StepsOfTheLiterature) {
  constexpr BlockPivoting least_index{.p_max = 0, .components = false};
  const AffineMcp circulant = standard_lcp(matrix({{1, 2, 0}, {0, 1, 2}, {2, 0, 1}}), vec({-1, -1, -1}));
  const Result result = block_pivoting(circulant, Vec::Zero(3), least_index);
  expect_solved(circulant, result, "circulant");
  EXPECT_LT(norm_inf(result.z - Vec::Constant(3, 1.0 / 3)), 1e-15);
  for (const Index n : {1, 4, 8, 12}) {
    const SpMat U = support::murty(n);
    const AffineMcp upper = standard_lcp(U, Vec::Constant(n, -1));
    const AffineMcp lower = standard_lcp(SpMat(U.transpose()), Vec::Constant(n, -1));
    EXPECT_EQ(block_pivoting(upper, Vec::Zero(n), least_index).iterations, (1L << n) - 1);
    EXPECT_EQ(block_pivoting(lower, Vec::Zero(n), least_index).iterations, 1);
  }
  EXPECT_EQ(block_pivoting(standard_lcp(matrix({{-1}}), vec({-1})), Vec::Zero(1), least_index).status, Status::Stalled);
}

// M_FF of the block is singular, one index alone is not: [1 1; 1 1] with q = (-1, -1).
TEST(BlockPivoting, SingularBlockIsAvoided) {
  const AffineMcp problem = standard_lcp(matrix({{1, 1}, {1, 1}}), vec({-1, -1}));
  const Result result = block_pivoting(problem, Vec::Zero(2), plain);
  expect_solved(problem, result, "ones");
  // From inside, where the matrix of all variables is singular too.
  EXPECT_EQ(block_pivoting(problem, Vec::Ones(2), plain).status, Status::Singular);
  // No exchange leads to a regular block.
  EXPECT_EQ(block_pivoting(standard_lcp(matrix({{0, 0}, {0, 0}}), vec({-1, 0})), Vec::Zero(2)).status,
            Status::Singular);
  // A free variable without its own pivot: solved from a start where the bounded one is inside as well.
  const AffineMcp saddle{matrix({{0, 1}, {-1, 0}}), vec({-1, 2}), {vec({-infinity, 0}), vec({infinity, infinity})}};
  const Result s = block_pivoting(saddle, Vec::Zero(2), plain);
  expect_solved(saddle, s, "saddle");
  EXPECT_LT(norm_inf(s.z - vec({2, 1})), 1e-14);
}

// Problems of every kind, with solution or without: an honest answer and an end.
TEST(BlockPivoting, HonestOnAnything) {
  Random random(4);
  int solved = 0;
  for (int run = 0; run < 400; ++run) {
    const Index n = random.integer(0, 12);
    Dense M = n > 0 ? random.normals(n, n) : Dense(0, 0);
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
    const Result result = block_pivoting(problem, random.normals(n));
    expect_honest(problem, result, "run " + std::to_string(run));
    solved += result.solved() ? 1 : 0;
  }
  EXPECT_GT(solved, 100);
}

TEST(BlockPivoting, EdgesAndRefusals) {
  const AffineMcp empty{SpMat(0, 0), Vec(0), Box::nonnegative(0)};
  EXPECT_TRUE(block_pivoting(empty, Vec(0)).solved());
  const AffineMcp one = standard_lcp(matrix({{2}}), vec({-1}));
  EXPECT_EQ(block_pivoting(one, vec({0})).z[0], 0.5);
  EXPECT_EQ(block_pivoting(one, vec({0}), {.max_iterations = 0, .components = false}).status, Status::IterationLimit);
  Limits limits;
  limits.interrupted = [] { return true; };
  EXPECT_EQ(block_pivoting(one, vec({0}), plain, limits).status, Status::Interrupted);
  EXPECT_THROW(block_pivoting(one, vec({0, 0})), std::invalid_argument);
  EXPECT_THROW(block_pivoting(one, vec({std::nan("")})), std::invalid_argument);
  EXPECT_THROW(block_pivoting(one, vec({0}), {.p_max = -1}), std::invalid_argument);
  EXPECT_THROW(block_pivoting(one, vec({0}), {.max_iterations = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
