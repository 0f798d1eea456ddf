// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/lemke.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lcp/pivoting/lemke_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::SpMat;
using support::vec;

/// From the ray and from several regular starts: the one solution.
void expect_unique_solution(const AffineMcp& problem, const Vec& solution, const char* what) {
  SCOPED_TRACE(what);
  const auto check = [&](const PivotResult& result, const char* start) {
    expect_solved(problem, result, start);
    EXPECT_LT((result.z - solution).lpNorm<Eigen::Infinity>(), 1e-8 * (1 + solution.lpNorm<Eigen::Infinity>()))
        << start;
  };
  check(lemke_ray(problem), "ray");
  for (const double at : {-10.0, -0.5, 0.0, 1.0, 30.0})
    check(lemke(problem, Vec::Constant(problem.size(), at)), "regular");
  check(lemke(problem, solution), "at the solution");
}

// Cottle, Pang & Stone 1992, chapter 1: M = [2 1; 1 2].
TEST(Lemke, TwoByTwoOfTheBook) {
  const SpMat M = matrix({{2, 1}, {1, 2}});
  expect_unique_solution(standard_lcp(M, vec({-5, -6})), vec({4.0 / 3, 7.0 / 3}), "interior");
  expect_unique_solution(standard_lcp(M, vec({5, -6})), vec({0, 3}), "second");
  expect_unique_solution(standard_lcp(M, vec({-5, 6})), vec({2.5, 0}), "first");
  expect_unique_solution(standard_lcp(M, vec({5, 6})), vec({0, 0}), "none");
  expect_unique_solution(standard_lcp(M, vec({0, 0})), vec({0, 0}), "degenerate");
  expect_unique_solution(standard_lcp(M, vec({-4, -2})), vec({2, 0}), "degenerate: F_2 = 0 as well");
}

// The KKT system of min x1^2 - 2 x1 x2 + 2 x2^2 - 2 x1 - 6 x2 with x1 + x2 <= 2, -x1 + 2 x2 <= 2, x >= 0: by hand
// x = (0.8, 1.2) with multipliers (2.8, 0).
TEST(Lemke, QuadraticProgramOfCottle) {
  const AffineMcp p =
      standard_lcp(matrix({{0, 0, -1, -1}, {0, 0, 1, -2}, {1, -1, 2, -2}, {1, 2, -2, 4}}), vec({2, 2, -2, -6}));
  const PivotResult result = lemke_ray(p);
  expect_solved(p, result);
  EXPECT_LT((result.z - vec({2.8, 0, 0.8, 1.2})).norm(), 1e-12);
  const PivotResult again = lemke(p, vec({1, 1, 1, 1}));
  expect_solved(p, again);
  EXPECT_LT((again.z - vec({2.8, 0, 0.8, 1.2})).norm(), 1e-12);
}

// Standard problems with q = -e: M e_n = (2, .., 2, 1), and by transposition e_1 (Murty 1988, section 6.2); Fathi's
// M = L L' with the same L has M e_1 = (1, 2, .., 2) (Fathi 1979), condition growing exponentially.
TEST(Lemke, MurtyAndFathi) {
  for (const Index n : {1, 2, 5, 16, 60}) {
    const SpMat U = support::murty(n);
    const SpMat L = U.transpose();
    const Vec minus_one = Vec::Constant(n, -1);
    expect_unique_solution(standard_lcp(U, minus_one), Vec::Unit(n, n - 1), "upper");
    expect_unique_solution(standard_lcp(L, minus_one), Vec::Unit(n, 0), "lower");
    if (n <= 16) expect_unique_solution(standard_lcp(SpMat(L * U), minus_one), Vec::Unit(n, 0), "Fathi");
  }
}

// Ahn's tridiag(1, 4, -2) and Geiger & Kanzow's tridiag(-1, 4, -1), q = -e: both inverses map e to positive vectors, so
// that M z = e is the solution.
TEST(Lemke, AhnAndGeigerKanzow) {
  for (const auto& [below, above] : {std::pair{1.0, -2.0}, {-1.0, -1.0}})
    for (const Index n : {4, 32, 256}) {
      const SpMat M = support::tridiagonal(n, below, 4, above);
      const Vec z = Dense(M).partialPivLu().solve(Vec::Ones(n));
      ASSERT_GT(z.minCoeff(), 0);
      expect_unique_solution(standard_lcp(M, Vec::Constant(n, -1)), z, "tridiagonal");
    }
}

// Triangular P-matrices are solved by substitution, z_i = max(0, -(q + M z)_i / M_ii): a reference for any q.
TEST(Lemke, TriangularProblemsBySubstitution) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Index n = random.integer(1, 40);
    const SpMat L = support::sparse(Dense(support::murty(n).transpose()));
    const Vec q = random.normals(n);
    Vec z = Vec::Zero(n);
    for (Index i = 0; i < n; ++i) z[i] = std::max(0.0, -(q + L * z)[i]);
    const AffineMcp p = standard_lcp(L, q);
    for (const PivotResult& result : {lemke_ray(p), lemke(p, Vec::Zero(n))}) {
      expect_solved(p, result);
      ASSERT_LT((result.z - z).norm(), 1e-8 * (1 + z.norm())) << n;
    }
  }
}

// Lemke's method with covering vector e on Murty's lower triangular matrix and q_i = -(2^n + .. + 2^(n-i+1)) takes 2^n
// pivots (Murty 1978; 1988, section 6.2): the path itself is checked, not only its end.
TEST(Lemke, ExponentialPathOfMurty) {
  for (Index n = 1; n <= 12; ++n) {
    Vec q(n);
    double sum = 0;
    for (Index i = 0; i < n; ++i) q[i] = -(sum += std::ldexp(1, static_cast<int>(n - i)));
    const AffineMcp p = standard_lcp(SpMat(support::murty(n).transpose()), q);
    const PivotResult result = lemke_covering(p, Vec::Ones(n));
    expect_solved(p, result);
    EXPECT_EQ(result.pivots, 1 << n) << n;
  }
}

// M = [1 2 0; 0 1 2; 2 0 1], q = -e is the 3 x 3 P-matrix on which pivoting without a rule for ties, or by Bard's rule,
// goes round in a circle (Murty 1974; Cottle, Pang & Stone 1992, section 4.2). With covering vector e
// all ratios are equal at the first pivot.
TEST(Lemke, CyclingExampleEnds) {
  const AffineMcp p = standard_lcp(matrix({{1, 2, 0}, {0, 1, 2}, {2, 0, 1}}), vec({-1, -1, -1}));
  expect_unique_solution(p, Vec::Constant(3, 1.0 / 3), "cyclic");
  const PivotResult classical = lemke_covering(p, Vec::Ones(3));
  expect_solved(p, classical, "classical");
  LemkeOptions exact;
  exact.perturbation = 0;
  expect_solved(p, lemke(p, Vec::Zero(3), exact), "from the corner, unperturbed");
}

// Sparse problems of the classes with a guarantee, from the ray: psd + skew with q in the feasible set, H+, M, and P
// far from dominance. Catches loss of accuracy over many pivots and refactorizations.
TEST(Lemke, SparseClassesAreSolved) {
  Random random(2);
  for (const Index n : {200, 500})
    for (int k = 0; k < 3; ++k) {
      SpMat monotone = support::psd_plus_skew(n, 2, random);
      // q = F - M z with z, F >= 0: feasible.
      const Vec z = random.normals(n).cwiseMax(0);
      const Vec q = random.normals(n).cwiseMax(0) - monotone * z;
      const AffineMcp problems[] = {standard_lcp(monotone, q),
                                    standard_lcp(support::h_plus(n, 2, random), random.normals(n)),
                                    standard_lcp(support::m_matrix(n, 2, random), random.normals(n)),
                                    standard_lcp(support::p_matrix(n, 2, random), random.normals(n))};
      const char* names[] = {"psd + skew", "H+", "M", "P"};
      for (int c = 0; c < 4; ++c) {
        const PivotResult result = lemke_ray(problems[c]);
        expect_solved(problems[c], result, names[c]);
        EXPECT_LT(result.pivots, 20 * n) << names[c];
      }
    }
}

// Ties everywhere: q of zeros and minus ones, integer data, the obstacle problem with a flat obstacle.
TEST(Lemke, DegenerateProblemsEnd) {
  Random random(3);
  for (int k = 0; k < 40; ++k) {
    const Index n = random.integer(2, 60);
    const SpMat M = support::tridiagonal(n, -1, 2, -1);
    const Vec q = Vec::NullaryExpr(n, [&] { return static_cast<double>(random.integer(-1, 0)); });
    const AffineMcp p = standard_lcp(M, q);
    expect_solved(p, lemke_ray(p), "laplacian, ray");
    expect_solved(p, lemke(p, Vec::Zero(n)), "laplacian, regular");
    AffineMcp boxed = p;
    boxed.box.upper.setConstant(1);
    expect_solved(boxed, lemke_ray(boxed), "boxed");
    expect_solved(boxed, lemke(boxed, Vec::Ones(n)), "boxed, from the upper bounds");
    // With covering vector e and nothing perturbed: every ratio test is a tie.
    expect_solved(p, lemke_covering(p, Vec::Ones(n)), "laplacian, e");
  }
}

// Two solutions each (0 and another): which one is found may depend on the start, that it is one must not.
TEST(Lemke, FindsSomeSolutionOfSeveral) {
  const AffineMcp p = standard_lcp(matrix({{-1, 0}, {0, -1}}), vec({1, 2}));  // z_i in {0, q_i}: four solutions
  for (const double a : {-3.0, 0.25, 0.75, 5.0})
    for (const double b : {-3.0, 0.5, 1.5, 5.0}) {
      const PivotResult result = lemke(p, vec({a, b}));
      expect_solved(p, result);
      EXPECT_LT(std::min(std::abs(result.z[0]), std::abs(result.z[0] - 1)), 1e-12);
      EXPECT_LT(std::min(std::abs(result.z[1]), std::abs(result.z[1] - 2)), 1e-12);
    }
  expect_solved(p, lemke_ray(p));
}

// Bimatrix games as LCPs, M = [0 A; B' 0] with A, B > 0, q = -e: a ray start from a covering vector ends at an
// equilibrium in theory only for Lemke & Howson's; whatever ends as solved must be one. Matching pennies (A shifted
// by 2, x = y = (1/2, 1/2) and value 3/2 hence z = (1/3, ..)) has that equilibrium only.
TEST(Lemke, MatchingPennies) {
  const SpMat M = matrix({{0, 0, 2, 1}, {0, 0, 1, 2}, {1, 2, 0, 0}, {2, 1, 0, 0}});
  const AffineMcp p = standard_lcp(M, Vec::Constant(4, -1));
  const PivotResult result = lemke(p, vec({1, 1, 1, 1}));
  expect_solved(p, result);
  EXPECT_LT((result.z - Vec::Constant(4, 1.0 / 3)).norm(), 1e-12);
}

// All unknowns free: one linear system. All fixed: nothing to solve. No unknowns: solved.
TEST(Lemke, TrivialBoxes) {
  Random random(4);
  AffineMcp p{support::random_sparse(30, 3, random), random.normals(30), Box::free(30)};
  for (const PivotResult& result : {lemke_ray(p), lemke(p, random.normals(30))}) {
    expect_solved(p, result, "free");
    EXPECT_EQ(result.pivots, 1);
  }
  p.box.lower = p.box.upper = random.normals(30);
  for (const PivotResult& result : {lemke_ray(p), lemke(p, random.normals(30))}) {
    expect_solved(p, result, "fixed");
    EXPECT_EQ(result.z, p.box.lower);
  }
  const AffineMcp empty{SpMat(0, 0), Vec(0), Box::free(0)};
  expect_solved(empty, lemke_ray(empty), "empty");
  expect_solved(empty, lemke(empty, Vec(0)), "empty");
}

}  // namespace
}  // namespace perp::lcp
