// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/enumeration.hpp"

#include <gtest/gtest.h>

#include "lcp/pivoting/block_pivoting.hpp"
#include "lcp/pivoting/pivoting_support.hpp"
#include "lcp/pivoting/principal_pivoting.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

void expect_found(const AffineMcp& problem, const Solutions& all, const std::vector<Vec>& isolated, const char* what) {
  SCOPED_TRACE(what);
  EXPECT_TRUE(all.complete) << all.message;
  EXPECT_EQ(all.found.size(), isolated.size());
  for (const Solution& s : all.found) {
    EXPECT_EQ(s.dimension, 0);
    EXPECT_LE(support::violation(problem, s.z), 2e-9 * (1 + norm_inf(problem.q)));
  }
  for (const Vec& z : isolated)
    EXPECT_TRUE(std::any_of(all.found.begin(), all.found.end(), [&](const Solution& s) {
      return norm_inf(s.z - z) < 1e-8 * (1 + norm_inf(z));
    })) << z.transpose();
}

// Cottle, Pang & Stone 2009, example 4.4.23, a bimatrix game. By hand, with A = B = [10 20; 30 15] and both players'
// supports: {1},{1}: 10 y_1 = 1; {2},{2}: 15 y_2 = 1; both: (1, 4)/90; supports of different size or {1},{2} fail.
TEST(Enumeration, BimatrixGame) {
  const AffineMcp game =
      standard_lcp(matrix({{0, 0, 10, 20}, {0, 0, 30, 15}, {10, 20, 0, 0}, {30, 15, 0, 0}}), vec({-1, -1, -1, -1}));
  expect_found(game, enumerate(game), {vec({0.1, 0, 0.1, 0}), vec({0, 1.0 / 15, 0, 1.0 / 15}), vec({1, 4, 1, 4}) / 90},
               "game");
}

// Remark 4.1.14 there: the solutions are the segment z_1 + z_2 = 1, z >= 0. Its ends, solutions of two other cells,
// must not come as isolated ones, and the point must be inside.
TEST(Enumeration, SegmentOfSolutions) {
  const AffineMcp problem = standard_lcp(matrix({{1, 1}, {1, 1}}), vec({-1, -1}));
  const Solutions all = enumerate(problem);
  EXPECT_TRUE(all.complete);
  ASSERT_EQ(all.found.size(), 1U);
  EXPECT_EQ(all.found[0].dimension, 1);
  EXPECT_NEAR(all.found[0].z.sum(), 1, 1e-12);
  EXPECT_GT(all.found[0].z.minCoeff(), 0.01);
}

// M = 0: every z >= 0 with q = 0 (dimension n); z_1 >= 0 alone with q = (0, 1); none with q = (0, -1).
TEST(Enumeration, PolyhedraOfEveryDimension) {
  const SpMat zero(3, 3);
  for (int positive = 0; positive <= 3; ++positive) {
    Vec q = Vec::Zero(3);
    q.head(positive).setOnes();
    const Solutions all = enumerate(standard_lcp(zero, q));
    EXPECT_TRUE(all.complete);
    ASSERT_EQ(all.found.size(), 1U);
    EXPECT_EQ(all.found[0].dimension, 3 - positive);
    EXPECT_GT(all.found[0].z.tail(3 - positive).sum(), positive == 3 ? -1 : 0);
  }
  const Result none = enumeration(standard_lcp(zero, vec({0, 0, -1})), Vec::Zero(3));
  EXPECT_EQ(none.status, Status::Infeasible);
  EXPECT_NE(none.message.find("all 2^3 cells examined"), std::string::npos) << none.message;
  // Two sets that meet in a point: z_1 z_2 = 0 for M = [0 1; 1 0], q = 0; both axes.
  const Solutions axes = enumerate(standard_lcp(matrix({{0, 1}, {1, 0}}), Vec::Zero(2)));
  EXPECT_TRUE(axes.complete);
  ASSERT_EQ(axes.found.size(), 2U);
  EXPECT_EQ(axes.found[0].dimension, 1);
  EXPECT_EQ(axes.found[1].dimension, 1);
  // In a box: z_1 z_2 = 0 no more; [0, 1]^2 with F = 0 is all of it.
  const AffineMcp square{SpMat(2, 2), Vec::Zero(2), {Vec::Zero(2), Vec::Ones(2)}};
  const Solutions all = enumerate(square);
  ASSERT_EQ(all.found.size(), 1U);
  EXPECT_EQ(all.found[0].dimension, 2);
}

/// All solutions of the cells with regular matrices, cell by cell without any pruning.
std::vector<Vec> brute_force(const AffineMcp& p) {
  const Index n = p.size();
  const Dense M(p.M);
  std::vector<Vec> found;
  std::vector<int> place(static_cast<std::size_t>(n), 0);
  for (;;) {
    Dense A = Dense::Identity(n, n);
    Vec b(n);
    bool cell = true;
    for (Index i = 0; i < n; ++i) {
      const int k = place[static_cast<std::size_t>(i)];
      const bool fixed = p.box.lower[i] == p.box.upper[i];
      b[i] = k == 0 ? p.box.lower[i] : p.box.upper[i];
      if (k == 2) A.row(i) = M.row(i), b[i] = -p.q[i];
      cell = cell && std::isfinite(b[i]) && !(fixed && k > 0);
    }
    if (cell) {
      const Vec z = A.partialPivLu().solve(b);
      const Vec F = M * z + p.q;
      for (Index i = 0; i < n; ++i) {
        const int k = place[static_cast<std::size_t>(i)];
        const bool fixed = p.box.lower[i] == p.box.upper[i];
        if (fixed) continue;
        if (k == 0) cell = cell && F[i] >= 0;
        if (k == 1) cell = cell && F[i] <= 0;
        if (k == 2) cell = cell && z[i] >= p.box.lower[i] && z[i] <= p.box.upper[i];
      }
      if (cell) found.push_back(z);
    }
    std::size_t i = 0;
    while (i < place.size() && place[i] == 2) place[i++] = 0;
    if (i == place.size()) return found;
    ++place[i];
  }
}

// Against the definition on random problems in general position, every kind of box, solutions planted so that there are
// several. Catches a bound with the wrong sign in a partial cell, a branch left out, a cut that was none.
TEST(Enumeration, EveryCellOfRandomProblems) {
  Random random(1);
  std::size_t most = 0;
  std::size_t none = 0;
  for (int run = 0; run < 300; ++run) {
    const Index n = random.integer(0, 6);
    Dense M = random.normals(n, n);
    if (run % 2 == 1) M = -M.cwiseAbs();  // many solutions
    const Box box = run % 3 == 0 ? Box::nonnegative(n) : support::mixed_box(n, random);
    const AffineMcp problem{support::sparse(M), random.normals(n), box};
    const std::vector<Vec> expected = brute_force(problem);
    expect_found(problem, enumerate(problem), expected, ("run " + std::to_string(run)).c_str());
    most = std::max(most, expected.size());
    none += expected.empty() ? 1 : 0;
  }
  EXPECT_GE(most, 5U);
  EXPECT_GE(none, 10U);
}

// -I with q = e: w_i = 1 - z_i, so every z in {0, 1}^n, 2^n solutions (Cottle, Pang & Stone 1992, section 3.3).
TEST(Enumeration, AllCellsHoldASolution) {
  const Index n = 8;
  const AffineMcp problem = standard_lcp(SpMat(-1 * support::tridiagonal(n, 0, 1, 0)), Vec::Ones(n));
  const Solutions all = enumerate(problem);
  EXPECT_TRUE(all.complete);
  EXPECT_EQ(all.found.size(), 256U);
  const Solutions some = enumerate(problem, {.max_solutions = 10});
  EXPECT_FALSE(some.complete);
  EXPECT_EQ(some.found.size(), 10U);
  EXPECT_EQ(some.stopped, Status::IterationLimit);
}

// P-matrices have one solution, degenerate or not: every degenerate index makes two cells hold the same point.
TEST(Enumeration, DegeneratePointsComeOnce) {
  Random random(2);
  for (int run = 0; run < 60; ++run) {
    const Index n = random.integer(1, 9);
    const auto [problem, solution] = plant(support::h_plus(n, 2, random), support::mixed_box(n, random), 0.7, random);
    expect_found(problem, enumerate(problem), {solution}, ("run " + std::to_string(run)).c_str());
  }
}

// n = 20, a million cells, in far fewer partial ones: random (indefinite), P, infeasible, and one with 2^10 solutions.
TEST(Enumeration, TwentyVariables) {
  Random random(3);
  for (int run = 0; run < 8; ++run) {
    Dense M = random.normals(20, 20);
    Vec q = random.normals(20);
    if (run % 4 == 1) M = M * M.transpose() + 0.1 * Dense::Identity(20, 20);
    if (run % 4 == 2) M.row(7) = -M.row(7).cwiseAbs(), q[7] = -1;  // w_8 < 0
    if (run % 4 == 3) {
      M = Dense::Identity(20, 20);
      M.topLeftCorner(10, 10) *= -1;
      q.head(10).setOnes();
    }
    const AffineMcp problem = standard_lcp(support::sparse(M), q);
    const Solutions all = enumerate(problem, {.max_solutions = 2000});
    EXPECT_TRUE(all.complete) << all.message;
    EXPECT_LT(all.nodes, 30'000);
    if (run % 4 == 1) {
      EXPECT_EQ(all.found.size(), 1U);
    }
    if (run % 4 == 2) {
      EXPECT_TRUE(all.found.empty());
    }
    if (run % 4 == 3) {
      EXPECT_EQ(all.found.size(), 1024U);
    }
  }
}

// q = 0: z = 0 is a solution, a point of all 2^20 cells. The cells in which a w_i is zero throughout are left to their
// neighbours, so that few are examined; with M = 0 all z >= 0 are found in one.
TEST(Enumeration, TotallyDegenerate) {
  Random random(5);
  const AffineMcp problem = standard_lcp(support::sparse(random.normals(20, 20)), Vec::Zero(20));
  const Solutions all = enumerate(problem);
  EXPECT_TRUE(all.complete);
  EXPECT_LT(all.nodes, 10000);
  EXPECT_TRUE(std::any_of(all.found.begin(), all.found.end(), [](const Solution& s) { return s.z.isZero(1e-9); }) ||
              std::any_of(all.found.begin(), all.found.end(), [](const Solution& s) { return s.dimension > 0; }));
  const Solutions everything = enumerate(standard_lcp(SpMat(20, 20), Vec::Zero(20)));
  EXPECT_TRUE(everything.complete);
  ASSERT_EQ(everything.found.size(), 1U);
  EXPECT_EQ(everything.found[0].dimension, 20);
}

// Small integers: singular cells, continua, ties everywhere; badly scaled rows. Every point is a solution; an empty
// answer means that no other method finds one (badly scaled rows apart, which a tolerance relative to the largest
// forgives), a certificate that the answer is empty. Catches a cell cut off wrongly.
TEST(Enumeration, AgreesWithOtherMethods) {
  Random random(4);
  int continua = 0;
  int empty = 0;
  int undecided = 0;  // of 100
  for (int run = 0; run < 400; ++run) {
    const Index n = random.integer(1, 7);
    Dense M = random.normals(n, n).unaryExpr([&](double a) { return random.chance(0.5) ? 0 : std::round(a); });
    Vec q = random.normals(n).unaryExpr([](double a) { return std::round(a); });
    if (run % 4 == 0)
      for (Index i = 0; i < n; ++i) {
        const double row = std::pow(10, random.integer(-8, 8));
        M.row(i) *= row;
        q[i] *= row;
      }
    const AffineMcp problem{support::sparse(M), q, run % 2 == 0 ? Box::nonnegative(n) : support::mixed_box(n, random)};
    const Solutions all = enumerate(problem);
    // Of a singular cell with rows of size 1e8 no point may be known to the tolerance: undecided, and said so.
    if (run % 4 == 0)
      undecided += all.complete ? 0 : 1;
    else
      EXPECT_TRUE(all.complete) << "run " << run << ": " << all.message;
    if (!all.complete) continue;
    for (const Solution& s : all.found) {
      EXPECT_TRUE(accepts(problem, s.z, 1e-9)) << "run " << run;  // rows of 1e8 are solved to rounding only
      continua += s.dimension > 0 ? 1 : 0;
    }
    const Result block = block_pivoting(problem, Vec::Zero(n));
    const Result principal = principal_pivoting(problem, Vec::Zero(n));
    if (all.found.empty()) {
      ++empty;
      EXPECT_FALSE(run % 4 != 0 && (block.solved() || principal.solved())) << "run " << run;
    } else {
      EXPECT_NE(principal.status, Status::Infeasible) << "run " << run;
    }
  }
  EXPECT_LE(undecided, 5);
  EXPECT_GT(continua, 50);
  EXPECT_GT(empty, 50);
}

TEST(Enumeration, EdgesAndRefusals) {
  const AffineMcp empty{SpMat(0, 0), Vec(0), Box::nonnegative(0)};
  EXPECT_EQ(enumerate(empty).found.size(), 1U);
  EXPECT_TRUE(enumeration(empty, Vec(0)).solved());
  const AffineMcp big = standard_lcp(support::tridiagonal(21, 0, 1, 0), Vec::Constant(21, -1));
  EXPECT_EQ(enumeration(big, Vec::Zero(21)).status, Status::NotApplicable);
  EXPECT_TRUE(enumeration(big, Vec::Zero(21), {.max_bounded = 21}).solved());
  // 30 free variables and one with bounds: few cells.
  AffineMcp free{support::tridiagonal(31, -1, 3, -1), Vec::Constant(31, -1), Box::free(31)};
  free.box.lower[15] = 0;
  EXPECT_EQ(enumerate(free).found.size(), 1U);
  Limits limits;
  limits.interrupted = [] { return true; };
  const Result stopped = enumeration(standard_lcp(matrix({{-1}}), vec({-1})), Vec::Zero(1), {}, limits);
  EXPECT_EQ(stopped.status, Status::Interrupted);
  EXPECT_THROW(enumerate(empty, {.max_bounded = -1}), std::invalid_argument);
  EXPECT_THROW(enumeration(empty, Vec(1)), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp
