// SPDX-License-Identifier: Apache-2.0
/// The paths over the cones, and the piles they are for (docs/contact/piles.md).
#include "contact/cones/cone_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

// Piles of spheres poured for mu = 0.6 that stick at 0.4, and that Glocker's homotopy alone does not solve or only
// after many attempts (89 factorizations and more): the associated path ends where they stand.
TEST(ConePath, PilesStandByTheAssociatedLaw) {
  for (const auto& [seed, mu] : {std::pair{1U, 0.4}, {2U, 0.4}, {15U, 0.4}, {2U, 0.6}}) {
    Problem problem = make_scene("spheres", 300, seed).problem();
    problem.mu.setConstant(mu);
    const Result result = solve(problem);
    EXPECT_TRUE(result.solved()) << result.message;
    EXPECT_LE(result.stats.factorizations, 35) << seed;
  }
}

// Piles in which two contacts slip in the end: with all contacts coupled the path turns back, and Newton steps from the
// end of the associated path do not lead there. Coupled where contacts slip it leads to the slips before any attempt of
// Glocker's homotopy is made; in the last pile others begin to slip on the way. Catches couplings that are lost between
// paths, and a coupled path from the wrong point.
TEST(ConePath, CouplingFindsTheFewThatSlip) {
  for (const auto& [contacts, seed, mu] : {std::tuple{100, 4U, 0.6}, {100, 7U, 0.6}, {100, 8U, 0.6}, {300, 12U, 0.4}}) {
    Problem problem = make_scene("spheres", contacts, seed).problem();
    problem.mu.setConstant(mu);
    const Result result = solve(problem);
    EXPECT_TRUE(result.solved()) << result.message;
    EXPECT_EQ(result.stats.attempts, 0) << seed;
    EXPECT_LE(result.stats.factorizations, 40) << seed;
    const std::vector<ContactState> all = states(problem, result.solution.r);
    EXPECT_GT(std::ranges::count(all, State::Slip, &ContactState::state), 0) << seed;
  }
}

// Piles in which a contact neither moves nor carries anything in the end: its slip falls like the root of tau and looks
// like a real one all the way. Regions make nothing of it (39 factorizations), Newton steps from the path's end do.
TEST(ConePath, NothingIsMadeOfSlipsThatVanish) {
  for (const unsigned seed : {24U, 60U}) {
    const Result result = solve(make_scene("spheres", 100, seed).problem());
    EXPECT_TRUE(result.solved()) << result.message;
    EXPECT_LE(result.stats.factorizations, 25) << seed;
  }
}

// Nine contacts slip on this pile, and the path that is coupled where contacts slip by the associated law turns back.
// Catches paths over the cones that leave it to Glocker's homotopy.
TEST(ConePath, ItsSlipsAreFoundWithoutTheHomotopy) {
  Problem problem = make_scene("spheres", 1000, 4).problem();
  problem.mu.setConstant(0.4);
  const Result result = solve(problem);
  EXPECT_TRUE(result.solved()) << result.message;
  EXPECT_EQ(result.stats.attempts, 0);
}

}  // namespace
}  // namespace perp::contact
