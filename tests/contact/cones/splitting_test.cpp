// SPDX-License-Identifier: Apache-2.0
/// Douglas and Rachford's splitting of Coulomb's law, and the piles it is for (docs/contact/piles.md).
#include "contact/cones/splitting.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "contact/cones/cone_path.hpp"
#include "contact/contact_support.hpp"
#include "contact/laws/glocker_support.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {
namespace {

using support::Random;
using test::solvable_problem;

/// y = W r + q + |u_T| e_N.
Vec corrected_velocities(const Scaled& problem, In r) {
  Vec y = problem.W * r + problem.q;
  for (const Scaled::Block& block : problem.blocks) y[block.first] += block.of(y).tail<2>().norm();
  return y;
}

/// The most by which y = W r + q + |y_T| e_N, r.y = 0 or the cones are missed.
double distance_from_the_law(const Scaled& problem, const Vec& r, const Vec& y) {
  Vec rest = y - problem.W * r - problem.q;
  double worst = 0;
  for (const Scaled::Block& block : problem.blocks) {
    rest[block.first] -= block.of(y).tail<2>().norm();
    for (const Eigen::Vector3d& of : {block.of(r), block.of(y)}) worst = std::max(worst, of.tail<2>().norm() - of[0]);
    worst = std::max(worst, std::abs(block.of(r).dot(block.of(y))));
  }
  return std::max(worst, rest.lpNorm<Eigen::Infinity>());
}

Problem pile(long contacts, unsigned seed, double mu) {
  Problem problem = make_scene("spheres", contacts, seed).problem();
  problem.mu.setConstant(mu);
  return problem;
}

// A solution of Coulomb's law stays where it is, in steps and in extrapolations, in 2D, in 3D and with frictionless
// contacts. Catches openings in the wrong row or of the wrong point, and a relaxation of one of r and y alone.
TEST(Splitting, ASolutionIsAFixedPoint) {
  Random random(5);
  for (const int dimension : {2, 3})
    for (int k = 0; k < 4; ++k) {
      Problem problem = solvable_problem(dimension, 6, 24, random, 0.2);
      if (k == 0) problem.mu.head(2).setZero();
      const Result result = solve(problem, {.tol = 1e-12});
      ASSERT_TRUE(result.solved()) << result.message;
      const Scaled coordinates = scaled(problem);
      ContactSystem system(coordinates);
      const Vec r = coordinates.reduce(result.solution.r);
      const Vec y = corrected_velocities(coordinates, r);
      Splitting splitting(coordinates, system, r, y);
      ASSERT_TRUE(splitting.factor());
      for (int lot = 0; lot < 3; ++lot) {
        for (int i = 0; i < 5; ++i) splitting.step();
        splitting.accelerate();
      }
      EXPECT_LE((splitting.r() - r).norm(), 1e-8 * (1 + r.norm()));
      EXPECT_LE((splitting.y() - y).norm(), 1e-8 * (1 + y.norm()));
    }
}

// Steps lead from the start to Coulomb's law, with one factorization. Catches steps that do not follow their own
// openings: the associated law is what they would end in.
TEST(Splitting, LeadsToCoulombsLaw) {
  Random random(11);
  int slipping = 0;
  for (int k = 0; k < 10; ++k) {
    const Scaled coordinates = scaled(solvable_problem(3, 6, 24, random));
    ContactSystem system(coordinates);
    const ConePath path(coordinates, system);
    Splitting splitting(coordinates, system, path.point().r, path.point().y);
    ASSERT_TRUE(splitting.factor());
    for (int lot = 0; lot < 200 && natural_map(coordinates, splitting.r()) > 1e-10; ++lot) {
      for (int i = 0; i < 25; ++i) splitting.step();
      splitting.accelerate();
    }
    EXPECT_LE(natural_map(coordinates, splitting.r()), 1e-10) << k;
    EXPECT_LE(distance_from_the_law(coordinates, splitting.r(), splitting.y()), 1e-6) << k;
    for (const Scaled::Block& block : coordinates.blocks)
      if (block.of(splitting.y()).tail<2>().norm() > 1e-3 && splitting.r()[block.first] > 1e-3) ++slipping;
    EXPECT_EQ(system.factorizations(), 1);
  }
  EXPECT_GT(slipping, 0);
}

// r and y stay complementary parts of one vector where an extrapolation moves both. Catches one that moves r alone.
TEST(Splitting, AnExtrapolationKeepsThemComplementary) {
  const Scaled coordinates = scaled(pile(60, 4, 0.6));
  ContactSystem system(coordinates);
  const ConePath path(coordinates, system);
  Splitting splitting(coordinates, system, path.point().r, path.point().y);
  ASSERT_TRUE(splitting.factor());
  int moved = 0;
  for (int lot = 0; lot < 100; ++lot) {
    splitting.step();
    const Vec before = splitting.r();
    splitting.accelerate();
    moved += splitting.r() == before ? 0 : 1;
    for (const Scaled::Block& block : coordinates.blocks)
      ASSERT_LE(std::abs(block.of(splitting.r()).dot(block.of(splitting.y()))), 1e-9);
  }
  EXPECT_GT(moved, 0);
}

// Piles whose slips feed themselves (docs/contact/piles.md): the first is solved by the proximal loop alone without the
// splitting, in 1,861 factorizations; the last needs more than 1,500 steps of it. Catches a splitting that is not
// tried, and one that does not end near a solution.
TEST(Splitting, FindsTheOpeningsOfHardPiles) {
  for (const auto& [contacts, seed, mu] : {std::tuple{300, 19U, 0.6},
                                           {300, 91U, 0.6},
                                           {300, 10U, 0.4},
                                           {1000, 9U, 0.6},
                                           {1000, 23U, 0.4},
                                           {3000, 5U, 0.6},
                                           {1000, 15U, 0.4},
                                           {1000, 33U, 0.4}}) {
    const Result result = solve(pile(contacts, seed, mu));
    EXPECT_TRUE(result.solved()) << result.message;
    EXPECT_GT(result.stats.splitting_steps, 0) << seed;
    EXPECT_LE(result.stats.factorizations, 45) << seed;
    EXPECT_EQ(result.stats.attempts, 0) << seed;
  }
}

}  // namespace
}  // namespace perp::contact
