// SPDX-License-Identifier: Apache-2.0
/// The paths over the cones, and the piles they are for (docs/contact/piles.md).
#include "contact/cones/cone_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "contact/contact_support.hpp"
#include "contact/laws/glocker_support.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {
namespace {

using support::Random;
using test::solvable_problem;

/// |x_T| - x_N at the worst contact: how far x is outside of the cones.
double outside(const Scaled& problem, In x) {
  double worst = -lcp::infinity;
  for (const Scaled::Block& block : problem.blocks) {
    const Eigen::Vector3d part = block.of(x);
    worst = std::max(worst, part.tail<2>().norm() - part[0]);
  }
  return worst;
}

void follow(ConePath& path, double until) {
  for (int k = 0; k < 100 && path.tau() > until; ++k) ASSERT_TRUE(path.step());
  ASSERT_LE(path.tau(), until);
}

// With given openings the end of the path solves the second-order cone problem: y = W r + q + s e_N, r and y in the
// cones, r.y = 0 contact by contact (Alizadeh & Goldfarb 2003). In 2D, in 3D and with frictionless contacts. Catches
// errors in the scaling, the elimination and the step to the boundary.
TEST(ConePath, SolvesTheConeProblem) {
  Random random(3);
  for (const int dimension : {2, 3})
    for (int k = 0; k < 5; ++k) {
      Problem problem = solvable_problem(dimension, 6, 24, random, 0.2);
      if (k == 0) problem.mu.head(2).setZero();
      const Scaled coordinates = scaled(problem);
      ContactSystem system(coordinates);
      ConePath path(coordinates, system);
      Vec openings(problem.contacts());
      for (Index a = 0; a < openings.size(); ++a) openings[a] = 0.1 * static_cast<double>((a + k) % 3);
      path.open(ConePath::Point(path.point()), openings);
      follow(path, 1e-10);
      const Vec& r = path.r();
      const Vec& y = path.point().y;
      EXPECT_LE(outside(coordinates, r), 0);
      EXPECT_LE(outside(coordinates, y), 0);
      EXPECT_LE(r.dot(y), 1e-10 * 1.01 * static_cast<double>(openings.size()));
      Vec error = coordinates.W * r + coordinates.q - y;
      for (std::size_t a = 0; a < coordinates.blocks.size(); ++a)
        error[coordinates.blocks[a].first] += openings[static_cast<Index>(a)];
      EXPECT_LE(error.norm(), 1e-6 * (1 + coordinates.q.norm()));
    }
}

// Near any r there is a point of the centre: r_a o y_a = tau e, both in the cone, with r_a - y_a = r - u - s e_N.
// Catches roots that cancel at small tau, and openings in the wrong row.
TEST(ConePath, NearAPointIsTheCentre) {
  Random random(4);
  for (const double tau : {1e-2, 1e-9}) {
    const Problem problem = solvable_problem(3, 6, 24, random, 0.2);
    const Scaled coordinates = scaled(problem);
    ContactSystem system(coordinates);
    const ConePath path(coordinates, system);
    Vec r = random.normals(coordinates.size(), 1);
    Vec openings = Vec::Zero(problem.contacts());
    openings[2] = 0.7;
    const Vec u = coordinates.W * r + coordinates.q;
    const ConePath::Point point = path.near(r, openings, tau);
    for (std::size_t a = 0; a < coordinates.blocks.size(); ++a) {
      const Eigen::Vector3d r_a = coordinates.blocks[a].of(point.r);
      const Eigen::Vector3d y_a = coordinates.blocks[a].of(point.y);
      Eigen::Vector3d x = coordinates.blocks[a].of(r) - coordinates.blocks[a].of(u);
      x[0] -= openings[static_cast<Index>(a)];
      EXPECT_LE((r_a - y_a - x).norm(), 1e-14 * (1 + x.norm()));
      EXPECT_NEAR(r_a.dot(y_a), tau, 1e-14 * (1 + x.squaredNorm()));
      EXPECT_LE((r_a[0] * y_a.tail<2>() + y_a[0] * r_a.tail<2>()).norm(), 1e-14 * (1 + x.squaredNorm()));
      EXPECT_GT(r_a[0], r_a.tail<2>().norm());
      EXPECT_GT(y_a[0], y_a.tail<2>().norm());
    }
  }
}

// With s coupled the end obeys Coulomb's law, by its judge: one contact that slips, W = 1, q = (-1, 2, 0), mu = 0.4.
// Catches errors in the coupling's derivatives only as lost convergence, and in the coupling as a wrong law.
TEST(ConePath, CoupledIsCoulombsLaw) {
  const Problem problem = test::one_contact(support::vec({-1, 2, 0}), 0.4);
  const Scaled coordinates = scaled(problem);
  ContactSystem system(coordinates);
  ConePath path(coordinates, system);
  path.couple(ConePath::Point(path.point()));
  follow(path, 1e-13);
  EXPECT_LE(residual(problem, coordinates.expand(path.r())).largest(), 1e-8);
}

// Newton's step on the coupled equations is theirs: a small step along it changes y - W r - q - s e_N, which includes
// the coupling, by its own share. Catches a wrong derivative of s.
TEST(ConePath, CoupledResidualFallsWithTheStep) {
  Random random(8);
  const Problem problem = solvable_problem(3, 5, 12, random, 0.2);
  const Scaled coordinates = scaled(problem);
  ContactSystem system(coordinates);
  ConePath path(coordinates, system);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(path.step());
  const auto error = [&](const ConePath::Point& at) {
    Vec e = at.y - coordinates.W * at.r - coordinates.q;
    for (const Scaled::Block& block : coordinates.blocks) {
      const Eigen::Vector3d r = block.of(at.r);
      const Eigen::Vector3d y = block.of(at.y);
      e[block.first] += r.tail<2>().dot(y.tail<2>()) / r[0];
    }
    return e;
  };
  const ConePath::Point from = path.point();
  path.couple(ConePath::Point(from));
  ASSERT_TRUE(path.step());
  const double share = 1e-4;
  const ConePath::Point near{from.r + share * (path.point().r - from.r), from.y + share * (path.point().y - from.y)};
  const Vec change = (error(near) - error(from)) / (share * path.last_step());
  EXPECT_LE((change + error(from)).norm(), 1e-2 * error(from).norm());
}

// Piles that Glocker's homotopy alone does not solve, or only after many attempts (89 factorizations and more): some
// stick in the end, in some a few contacts slip, in one nine, in some a contact neither moves nor carries anything and
// its slip falls like the root of tau. Paths over the cones, the splitting and Newton steps lead there without it.
TEST(ConePath, PilesNeedNoHomotopy) {
  for (const auto& [contacts, seed, mu, most] : {std::tuple{300, 1U, 0.4, 35},
                                                 {300, 2U, 0.4, 35},
                                                 {300, 15U, 0.4, 35},
                                                 {300, 2U, 0.6, 35},
                                                 {100, 4U, 0.6, 40},
                                                 {100, 7U, 0.6, 40},
                                                 {100, 8U, 0.6, 40},
                                                 {300, 12U, 0.4, 40},
                                                 {100, 24U, 0.6, 25},
                                                 {100, 60U, 0.6, 25},
                                                 {1000, 4U, 0.4, 45}}) {
    Problem problem = make_scene("spheres", contacts, seed).problem();
    problem.mu.setConstant(mu);
    const Result result = solve(problem);
    EXPECT_TRUE(result.solved()) << result.message;
    EXPECT_EQ(result.stats.attempts, 0) << seed;
    EXPECT_LE(result.stats.factorizations, most) << seed;
  }
}

}  // namespace
}  // namespace perp::contact
