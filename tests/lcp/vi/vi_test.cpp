// SPDX-License-Identifier: Apache-2.0
// Affine variational inequalities over polyhedra. Facchinei & Pang, Finite-Dimensional Variational Inequalities and
// Complementarity Problems, Springer 2003, proposition 1.2.1: x solves the VI iff it has multipliers. The tests look at
// these, the solver's judge at the projection, which knows none.
#include "lcp/vi/vi.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <string>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;
using support::sparse;

/// By how much x and its multipliers miss  M x + q = A'lambda + nu,  x in C,  and the signs of them.
double missed(const AffineVi& vi, const ViResult& r) {
  const Polyhedron& C = vi.C;
  const Vec Ax = C.A * r.x;
  double worst = (vi.M * r.x + vi.q - C.A.transpose() * r.multipliers - r.reduced).lpNorm<Eigen::Infinity>();
  const auto side = [&](double value, double lower, double upper, double multiplier) {
    worst = std::max({worst, lower - value, value - upper});
    if (lower == upper) return;
    if (multiplier > 0) worst = std::max(worst, std::min(multiplier, value - lower));
    if (multiplier < 0) worst = std::max(worst, std::min(-multiplier, upper - value));
  };
  for (Index i = 0; i < Ax.size(); ++i) side(Ax[i], C.rows.lower[i], C.rows.upper[i], r.multipliers[i]);
  for (Index j = 0; j < r.x.size(); ++j) side(r.x[j], C.box.lower[j], C.box.upper[j], r.reduced[j]);
  return worst;
}

Vec integers(Random& random, Index n, int most) {
  Vec v(n);
  for (Index i = 0; i < n; ++i) v[i] = std::round(random.uniform(-most, most));
  return v;
}

enum Kind { Definite, Semidefinite, NotMonotone, Degenerate, Empty };

/// Problem k of the kind; bounded, or C has a point and M is definite, so that all but the empty ones have a solution
/// (Facchinei & Pang 2003, corollary 2.2.5, theorem 2.3.3).
AffineVi problem(Kind kind, int k, Random& random) {
  const Index n = 2 + k % 12, m = 1 + (3 * k) % 17;
  Dense M = random.normals(n, n);
  const Dense G = random.normals(n, n);
  if (kind == Semidefinite) {
    const Index rank = n / 2;
    M = (M - M.transpose() + G.leftCols(rank) * G.leftCols(rank).transpose()).eval();
  } else if (kind != NotMonotone) {
    M = (M - M.transpose() + G * G.transpose() / static_cast<double>(n) + 0.1 * Dense::Identity(n, n)).eval();
  }
  Dense A = random.normals(m, n);
  const Vec inside = random.normals(n);
  AffineVi vi{sparse(M), 3 * random.normals(n), {{}, Box::free(m), Box::free(n)}};
  for (Index i = 0; i < m; ++i) {
    const double a = A.row(i).dot(inside);
    vi.C.rows.lower[i] = a - random.uniform(0, 1);
    if (i % 5 == 3) vi.C.rows.upper[i] = a + random.uniform(0, 1);
    if (i % 7 == 4) {
      vi.C.rows.lower[i] = -infinity;
      vi.C.rows.upper[i] = a + random.uniform(0, 1);
    }
    if (i == 2 && n > 2) vi.C.rows.lower[i] = vi.C.rows.upper[i] = a;
  }
  if (k % 2 == 0 || kind == Semidefinite || kind == NotMonotone) {
    vi.C.box.lower = inside - Vec::Constant(n, 1);
    vi.C.box.upper = inside + Vec::Constant(n, 1.5);
  }
  if (kind == Degenerate) {  // at a vertex many more rows than variables, copies, and opposite pairs
    const Vec vertex = integers(random, n, 3);
    A = Dense(2 * n + 4, n);
    vi.C.rows = {Vec(A.rows()), Vec::Constant(A.rows(), infinity)};
    for (Index i = 0; i < A.rows(); ++i) {
      A.row(i) = integers(random, n, 4).transpose();
      vi.C.rows.lower[i] = A.row(i).dot(vertex);
    }
    A.row(1) = A.row(0);
    A.row(2) = 3 * A.row(0);
    vi.C.rows.lower[1] = vi.C.rows.lower[0];
    vi.C.rows.lower[2] = 3 * vi.C.rows.lower[0];
    if (k % 3 == 0) {  // flat
      A.row(3) = -A.row(0);
      vi.C.rows.lower[3] = -vi.C.rows.lower[0];
    }
    vi.C.box = Box::free(n);
    if (k % 2 == 0) vi.C.box.lower = vertex;
  }
  if (kind == Empty) {  // the last row contradicts a combination of the others
    Vec y = Vec::Zero(m);
    A = Dense(m + 1, n);
    Vec lower(m + 1);
    for (Index i = 0; i < m; ++i) {
      A.row(i) = k % 2 == 0 ? integers(random, n, 9).transpose().eval() : random.normals(n).transpose().eval();
      lower[i] = std::round(random.uniform(-5, 5));
      if (i % 2 == 0) y[i] = std::round(random.uniform(1, 4));
    }
    A.row(m) = -(y.transpose() * A.topRows(m));
    lower[m] = -y.dot(lower.head(m)) + 1;
    vi.C.rows = {lower, Vec::Constant(m + 1, infinity)};
    vi.C.box = Box::free(n);
    if (k % 2 == 1) vi.C.box = {Vec::Constant(n, -100), Vec::Constant(n, 100)};
  }
  vi.C.A = sparse(A);
  return vi;
}

class Generated : public testing::TestWithParam<Kind> {};

// A hundred of each kind: monotone ones are solved, empty ones proven empty by a certificate that is checked exactly,
// and nothing is called solved that has no multipliers. Catches a projection whose error is underestimated, wrong signs
// of multipliers, and cycles of the pivoting.
TEST_P(Generated, IsSolvedOrProvenEmpty) {
  Random random(11);
  int solved = 0;
  for (int k = 0; k < 100; ++k) {
    const AffineVi vi = problem(GetParam(), k, random);
    for (const auto method : {ViOptions::Method::Auto, ViOptions::Method::Lifted}) {
      const ViResult r = solve_vi(vi, {.method = method});
      SCOPED_TRACE("problem " + std::to_string(k) + (method == ViOptions::Method::Auto ? ", auto: " : ", lifted: ") +
                   r.message);
      const double scale = 1 + r.multipliers.lpNorm<1>();
      ASSERT_TRUE(!r.accepted() || missed(vi, r) <= 1e-7 * scale);
      ASSERT_TRUE(r.status != Status::Infeasible || r.certificate.size() == 0 ||
                  proves_infeasible(lifted(vi), r.certificate));
      if (method != ViOptions::Method::Auto) continue;
      if (GetParam() == Empty) {
        ASSERT_EQ(r.status, Status::Infeasible);
        ASSERT_TRUE(r.empty);
      } else {
        ASSERT_NE(r.status, Status::Infeasible);
        ASSERT_TRUE(r.accepted() || GetParam() == NotMonotone);
      }
      solved += r.solved() ? 1 : 0;
    }
  }
  RecordProperty("solved", solved);
  // Some of the degenerate ones are flat, and are solved to rounding.
  EXPECT_GE(solved, GetParam() == Empty ? 0 : GetParam() == Degenerate ? 90 : 99);
}

std::string name_of(const testing::TestParamInfo<Kind>& kind) {
  constexpr std::array names{"definite", "semidefinite", "not_monotone", "degenerate", "empty"};
  return names[static_cast<std::size_t>(kind.param)];
}
INSTANTIATE_TEST_SUITE_P(Kinds, Generated, testing::Values(Definite, Semidefinite, NotMonotone, Degenerate, Empty),
                         name_of);

/// x1 in [0.99, infinity), x2 = 0, x1 - 100 x2 <= 1.
Polyhedron with_a_fixed_variable() {
  Dense A(1, 2);
  A << 1, -100;
  return {sparse(A),
          {Vec::Constant(1, -infinity), Vec::Constant(1, 1)},
          {support::vec({0.99, 0}), support::vec({infinity, 0})}};
}

// At x = (1 + 8e-7, 0) with F(x) = (0, -9e-9) the projection of x - F(x) is (1, 0), by hand. The empty face lets x2 be
// 9e-9, where the row seems to hold. Catches a fixed variable that is not at its bound.
TEST(JudgeVi, HoldsFixedVariables) {
  const Vec x = support::vec({1 + 8e-7, 0}), F = support::vec({0, -9e-9});
  Projector projector(with_a_fixed_variable());
  for (const Cell second : {Cell::Inside, Cell::Fixed}) {
    const ViResult r =
        judge_vi(projector, x, F, 0, x.cwiseAbs(), {.rows = {}, .bounds = {Cell::Inside, second}}, Limits{.tol = 1e-8});
    EXPECT_FALSE(r.accepted()) << r.message;
    EXPECT_GE(r.residual, 7.9e-7);
  }
  const ViResult r = judge_vi(projector, x, F, 0, x.cwiseAbs(), {}, Limits{.tol = 1e-6});
  EXPECT_TRUE(r.solved()) << r.message;
  EXPECT_NEAR(r.residual, 8e-7, 1e-15);
}

// Fixed variables that equations say, too: x1 = 1, x2 = 2, x1 + x3 = 2, x2 + x3 = 3, x1 + x2 = 3. Catches faces whose
// normals become dependent where a fixed variable is held.
TEST(SolveVi, HoldsFixedVariablesThatRowsSayToo) {
  Dense A(3, 3);
  A << 1, 0, 1, 0, 1, 1, 1, 1, 0;
  const Vec b = support::vec({2, 3, 3});
  const Polyhedron C{sparse(A), {b, b}, {support::vec({1, 2, -infinity}), support::vec({1, 2, infinity})}};
  for (const auto method : {ViOptions::Method::Auto, ViOptions::Method::Lifted}) {
    const ViResult r = solve_vi({sparse(Dense::Identity(3, 3)), Vec::Ones(3), C}, {.method = method});
    EXPECT_TRUE(r.solved()) << r.message;
  }
}

// A face that says Fixed of a row with two sides has no sign to be wrong: the projection of 0 on 1 <= x1 + x2 <= 2 is
// (1/2, 1/2), of (3/4, 3/4) itself. Catches multipliers of any sign that are taken for right.
TEST(JudgeVi, TakesNoInequalityForAnEquation) {
  Projector projector({sparse(Dense::Constant(1, 2, 1)), {Vec::Constant(1, 1), Vec::Constant(1, 2)}, Box::free(2)});
  const Vec x = Vec::Constant(2, 0.5), F = Vec::Constant(2, -0.25);
  const ViResult r =
      judge_vi(projector, x, F, 0, x, {.rows = {Cell::Fixed}, .bounds = {Cell::Inside, Cell::Inside}}, {});
  EXPECT_FALSE(r.accepted()) << r.message;
  EXPECT_NEAR(r.residual, 0.25, 1e-15);
}

// A point beside C that there was no time to project, and one whose row overflows. Catches points far from C that are
// accepted because they are their own projection on a wrong face.
TEST(JudgeVi, AcceptsNoPointOutsideC) {
  const Polyhedron half{
      sparse(Dense::Constant(1, 2, 1)), {Vec::Constant(1, 1), Vec::Constant(1, infinity)}, Box::free(2)};
  const Limits over{.deadline = std::chrono::steady_clock::now()};
  for (const auto method : {ViOptions::Method::Auto, ViOptions::Method::Lifted}) {
    const ViResult r = solve_vi({sparse(Dense::Identity(2, 2)), Vec::Zero(2), half}, {.method = method}, over);
    EXPECT_EQ(r.status, Status::TimeLimit) << r.message;
  }
  Projector projector(half);
  const ViResult r = judge_vi(projector, Vec::Zero(2), Vec::Zero(2), 0, Vec::Zero(2), {}, over);
  EXPECT_EQ(r.status, Status::TimeLimit) << r.message;
  const Polyhedron huge{
      sparse(Dense::Constant(1, 1, 1e200)), {Vec::Constant(1, -infinity), Vec::Zero(1)}, Box::free(1)};
  EXPECT_FALSE(solve_vi({sparse(Dense::Identity(1, 1)), Vec::Constant(1, -1e200), huge}).accepted());
}

// M x + q overflows. Catches a residual that is no number and taken for small.
TEST(SolveVi, AcceptsNoOverflow) {
  const Polyhedron box{SpMat(0, 1), Box::free(0), {Vec::Constant(1, 1e200), Vec::Constant(1, infinity)}};
  EXPECT_FALSE(solve_vi({sparse(Dense::Constant(1, 1, 1e200)), Vec::Zero(1), box}).accepted());
}

// Without variables a row is 0, which is in its sides or not.
TEST(SolveVi, LooksAtRowsWithoutVariables) {
  for (const double b : {-1.0, 1.0}) {
    const Polyhedron C{SpMat(1, 0), {Vec::Constant(1, b), Vec::Constant(1, infinity)}, Box::free(0)};
    const ViResult r = solve_vi({SpMat(0, 0), Vec(0), C});
    EXPECT_EQ(r.solved(), b < 0) << r.message;
  }
}

}  // namespace
}  // namespace perp::lcp
