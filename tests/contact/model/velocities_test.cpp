// SPDX-License-Identifier: Apache-2.0
/// u = W r + q for the judge, W by its parts, beside rational arithmetic on the same doubles.
#include "contact/model/velocities.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "contact/model/residual.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/run.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;
using Rationals = std::vector<mpq_class>;

/// M^-1 p by elimination; M is positive definite.
Rationals exact_inverse(const SpMat& M, Rationals p) {
  const std::size_t m = p.size();
  std::vector<Rationals> A(m, Rationals(m));
  for (Index j = 0; j < M.cols(); ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it) A[at(it.row())][at(j)] = it.value();
  for (std::size_t k = 0; k < m; ++k)
    for (std::size_t i = k + 1; i < m; ++i) {
      if (A[i][k] == 0) continue;
      const mpq_class factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < m; ++j) A[i][j] -= factor * A[k][j];
      p[i] -= factor * p[k];
    }
  for (std::size_t k = m; k-- > 0;) {
    for (std::size_t j = k + 1; j < m; ++j) p[k] -= A[k][j] * p[j];
    p[k] /= A[k][k];
  }
  return p;
}

/// H' M^-1 H r + q
Rationals exactly(const Global& g, const Vec& r, const Vec& q) {
  Rationals p(at(g.H.rows()));
  for (Index j = 0; j < g.H.cols(); ++j)
    for (SpMat::InnerIterator it(g.H, j); it; ++it) p[at(it.row())] += mpq_class(it.value()) * mpq_class(r[j]);
  const Rationals v = exact_inverse(g.M, std::move(p));
  Rationals u(at(q.size()));
  for (Index j = 0; j < g.H.cols(); ++j) {
    u[at(j)] = q[j];
    for (SpMat::InnerIterator it(g.H, j); it; ++it) u[at(j)] += mpq_class(it.value()) * v[at(it.row())];
  }
  return u;
}

/// M of rigid bodies or of one body that is none, H that joins bodies.
Global random_bodies(bool flexible, Index contacts, Random& random) {
  const Index m = flexible ? 30 : 12;
  Dense M = Dense::Zero(m, m);
  const Index block = flexible ? m : 3;
  for (Index i = 0; i < m; i += block) {
    const Dense X = random.normals(block, block);
    const Dense B = X * X.transpose() + 0.1 * Dense::Identity(block, block);
    M.block(i, i, block, block) = std::ldexp(1.0, random.integer(-10, 10)) * (B + B.transpose());
  }
  Dense H = random.normals(m, 3 * contacts);
  for (Index j = 0; j < H.cols(); ++j)
    for (Index i = 0; i < m; ++i)
      if (random.chance(0.6)) H(i, j) = 0;
  return {.M = sparse(M),
          .H = sparse(H),
          .G = SpMat(m, 0),
          .f = random.normals(m),
          .w = random.normals(3 * contacts),
          .b = Vec(0)};
}

// Impulses of 1, and of 1e15 and 1e30 of which W r nearly or wholly cancels q or itself. Catches a product in working
// precision, where u is the rounding of what cancels, and a refinement that stops early.
TEST(Velocities, OfPartsAreExactBesideRationals) {
  Random random(11);
  for (int k = 0; k < 60; ++k) {
    const Global g = random_bodies(k % 2 == 1, 4, random);
    Problem p = condense(g, Vec::Ones(4));
    ASSERT_TRUE(p.W.parts());
    Vec r = random.normals(12);
    if (k % 3 == 1) r *= 1e15;
    if (k % 3 == 2) r *= 1e30;
    if (k % 5 == 0) p.q = -(p.W * r);
    const std::vector<double> coupled = coupled_velocities(p);
    const Velocities found = exact_velocities(p, r, coupled);
    const Rationals u = exactly(g, r, p.q);
    // What may be left: the last place of v's second part.
    const double last_place =
        1e-29 * (g.H.cwiseAbs().transpose() * p.W.parts()->inverse(g.H * r).cwiseAbs()).maxCoeff();
    for (Index i = 0; i < 12; ++i) {
      const double error = std::abs(mpq_class(u[at(i)] - mpq_class(found.u[i])).get_d());
      const double size = std::abs(u[at(i)].get_d());
      EXPECT_LE(error, 2e-14 * std::max(size, 1e-6 * coupled[at(i / 3)]) + last_place) << k << ' ' << i;
      EXPECT_LE(Vec(p.W.matrix().cwiseAbs() * r.cwiseAbs() + p.q.cwiseAbs())[i], found.terms[i] * (1 + 1e-12)) << k;
    }
  }
}

// Two contacts press a body from both sides with 1e33: H r is 0, and u is q to the last bit. Catches a judge to whom q
// is lost in what cancels.
TEST(Velocities, SqueezedBodyKeepsItsVelocity) {
  Global g{.M = support::matrix({{3, 0}, {0, 3}}),
           .H = support::matrix({{1, 0, -1, 0}, {0, 1, 0, 1}}),
           .G = SpMat(2, 0),
           .f = vec({0, 0}),
           .w = vec({-0.1, 0.7, -0.3, 0.2}),
           .b = Vec(0)};
  const Problem p = condense(g, vec({0.5, 0.5}), 2);
  ASSERT_TRUE(p.W.parts());
  EXPECT_EQ(velocities(p, vec({1e33, 0, 1e33, 0})), g.w);
  EXPECT_FALSE(accepted(residual(p, vec({1e33, 0, 1e33, 0})), 1e-4));
}

// The judge says of W by its parts what it says of its entries. Shares may be less: N'N is not below |W|.
TEST(Velocities, JudgeOfPartsAgreesWithThatOfEntries) {
  for (const char* name : {"wall", "spheres", "arch", "chain", "incline", "stack"}) {
    const Problem problem = make_scene(name, 60).problem();
    Problem given = problem;
    (void)given.W.given();
    ASSERT_TRUE(problem.W.parts() && !given.W.parts()) << name;
    const auto run = contact::run(problem, variant_of("glocker"));
    ASSERT_TRUE(run.solved) << name;
    EXPECT_TRUE(accepted(residual(given, run.solution.r), 1.01e-8)) << name;
    Random random(5);
    const Vec r = run.solution.r + 0.1 * run.solution.r.cwiseAbs().maxCoeff() * random.normals(problem.q.size());
    const Residual a = residual(problem, r);
    const Residual b = residual(given, r);
    EXPECT_NEAR(a.natural, b.natural, 1e-12 * b.natural) << name;
    EXPECT_NEAR(a.scaled, b.scaled, 1e-12 * b.scaled) << name;
    EXPECT_LE(a.normal_share, b.normal_share * (1 + 1e-12)) << name;
    EXPECT_GE(a.normal_share, 0.1 * b.normal_share) << name;
  }
}

}  // namespace
}  // namespace perp::contact
