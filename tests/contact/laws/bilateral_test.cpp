// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/bilateral.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"
#include "contact/laws/frictionless.hpp"

namespace perp::contact {
namespace {

using support::matrix;
using support::vec;
using Unknowns = BilateralContact::Unknowns;

/// Direct form by lcp::solve, or through the Schur complement.
BilateralContact::Point motion(const BilateralContact& contact, bool reduced) {
  if (!reduced) {
    const lcp::AffineMcp problem = lcp::to_affine(contact.mlcp());
    const lcp::Result result = lcp::solve(problem, Vec::Zero(problem.size()), lcp::Auto{}, {.tol = 1e-11});
    EXPECT_TRUE(result.solved()) << result.message;
    return contact.recover(lcp::from_affine(contact.mlcp(), result.z));
  }
  const lcp::SchurReduction schur(contact.mlcp());
  EXPECT_EQ(schur.status(), lcp::LuStatus::Ok);
  const lcp::Result result =
      lcp::solve(schur.problem(), Vec::Zero(schur.problem().size()), lcp::Auto{}, {.tol = 1e-11});
  EXPECT_TRUE(result.solved()) << result.message;
  return contact.recover(schur.recover(result.z));
}

/// A bead of mass 2 on a rail of slope 1 (v_x = v_y), under the impulse f = (0, -4), above a floor y >= 0.
Global bead() {
  return {.M = matrix({{2, 0}, {0, 2}}),
          .H = matrix({{0, 1}, {1, 0}}),  // N = y, T = x
          .G = matrix({{1}, {-1}}),
          .f = vec({0, -4}),
          .w = vec({0, 0}),
          .b = vec({0})};
}

// The floor holds the bead: v = 0, so f + G lambda + H_N r_N = 0 gives lambda = 0, r_N = 4. Raised floor speed w_N =
// 0.5: it may sink with v_y = -0.5 = v_x; 2 v = f + lambda (1, -1) + r_N (0, 1) gives lambda = -1, r_N = 4 - 2 = 2.
TEST(Bilateral, BeadOnARail) {
  for (const Unknowns unknowns : {Unknowns::Velocities, Unknowns::Multipliers})
    for (const bool reduced : {false, true}) {
      Global global = bead();
      const BilateralContact held(global, 2, unknowns);
      const auto p = motion(held, reduced);
      EXPECT_NEAR(p.contact.r[0], 4, 1e-12);
      EXPECT_NEAR(p.lambda[0], 0, 1e-12);
      EXPECT_LE(p.v.norm(), 1e-12);
      Global sinking = bead();
      sinking.w[0] = 0.5;
      const auto s = motion(BilateralContact(sinking, 2, unknowns), reduced);
      EXPECT_NEAR(s.contact.r[0], 2, 1e-12);
      EXPECT_NEAR(s.lambda[0], -1, 1e-12);
      EXPECT_LE((s.v - vec({-0.5, -0.5})).norm(), 1e-12);
      EXPECT_LE((s.contact.u - vec({0, -0.5})).norm(), 1e-12);
    }
}

Global dense_global(std::mt19937& random, Index m, Index k, Index n, int dimension) {
  std::normal_distribution<double> normal;
  const auto dense = [&](Index rows, Index columns) {
    support::Dense X(rows, columns);
    for (Index j = 0; j < columns; ++j)
      for (Index i = 0; i < rows; ++i) X(i, j) = normal(random);
    return X;
  };
  const support::Dense R = dense(m, m);
  Global g;
  g.M = SpMat((R.transpose() * R + support::Dense::Identity(m, m)).sparseView());
  g.H = SpMat(dense(m, dimension * n).sparseView());
  g.G = SpMat(dense(m, k).sparseView());
  g.f = dense(m, 1);
  g.w = Vec::Zero(dimension * n);
  g.b = dense(k, 1);
  return g;
}

// Both sets of unknowns, direct and reduced, and the condensed problem's LCP(W_NN, q_N): one v. The equations are
// checked in their own words: a lost sign of b, G or f shows.
TEST(Bilateral, AllWaysLeadToOneMotion) {
  std::mt19937 random(31);
  for (int k = 0; k < 20; ++k) {
    const int dimension = 2 + k % 2;
    const Global g = dense_global(random, 12, 3, 5, dimension);
    const Problem condensed = condense(g, Vec::Zero(5), dimension);
    const Frictionless lcp_form(condensed, {.scaled = false});
    const Solution expected = lcp_form.recover(solved(lcp_form).z);
    for (const Unknowns unknowns : {Unknowns::Velocities, Unknowns::Multipliers}) {
      const BilateralContact contact(g, dimension, unknowns);
      for (const bool reduced : {false, true}) {
        const auto p = motion(contact, reduced);
        EXPECT_LE((p.contact.u - expected.u).norm(), 1e-8 * (1 + expected.u.norm()));
        EXPECT_LE((g.M * p.v - g.H * p.contact.r - g.G * p.lambda - g.f).norm(), 1e-8 * (1 + g.f.norm()));
        EXPECT_LE((g.G.transpose() * p.v + g.b).norm(), 1e-9 * (1 + g.b.norm()));
        EXPECT_LE(residual(condensed, p.contact.r).scaled, 1e-9);
      }
    }
  }
}

// A constraint stated twice: no Schur complement, but the direct forms are solved, and the motion is the same.
TEST(Bilateral, DependentConstraintsNeedTheDirectForm) {
  Global twice = bead();
  twice.G = matrix({{1, 1}, {-1, -1}});
  twice.b = vec({0, 0});
  twice.w[0] = 0.5;
  for (const Unknowns unknowns : {Unknowns::Velocities, Unknowns::Multipliers}) {
    const BilateralContact contact(twice, 2, unknowns);
    EXPECT_EQ(lcp::SchurReduction(contact.mlcp()).status(), lcp::LuStatus::Singular);
    const auto p = motion(contact, false);
    EXPECT_NEAR(p.contact.r[0], 2, 1e-9);
    EXPECT_NEAR(p.lambda.sum(), -1, 1e-9);
    EXPECT_LE((p.v - vec({-0.5, -0.5})).norm(), 1e-9);
  }
}

TEST(Bilateral, RefusesMalformedInput) {
  Global g = bead();
  EXPECT_THROW(BilateralContact(g, 3), std::invalid_argument);
  g.b = vec({0, 0});
  EXPECT_THROW(BilateralContact(g, 2), std::invalid_argument);
  Global massless = bead();
  massless.M = matrix({{2, 0}, {0, 0}});
  massless.M.makeCompressed();
  EXPECT_THROW(BilateralContact(massless, 2, Unknowns::Multipliers), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact
