// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/ball.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace perp::contact {
namespace {

using Kind = FrictionLaw::Kind;

double farthest(const BallPath& path, const BallPath& from) {
  double distance = 0;
  for (std::size_t k = 0; k < path.centres.size(); ++k)
    distance = std::max(distance, (path.centres[k] - from.centres[k]).norm());
  return distance;
}

BallPath solved(const CyclicBall& ball, const FrictionLaw& law = {}) {
  BallPath path = run_ball(ball, law);
  EXPECT_TRUE(path.solved) << name(law) << ": " << path.message;
  return path;
}

// (26) of the lecture: 60 degrees, 180, -60, of 5 s each, again from 15 s on.
TEST(Ball, LoadIsTheLectures) {
  const CyclicBall ball;
  const double s = std::sqrt(3) / 2;
  EXPECT_LE((load_direction(ball, 0) - Vec3(0.5, s, 0)).norm(), 1e-15);
  EXPECT_LE((load_direction(ball, 4.99) - Vec3(0.5, s, 0)).norm(), 1e-15);
  EXPECT_LE((load_direction(ball, 5) - Vec3(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LE((load_direction(ball, 10) - Vec3(0.5, -s, 0)).norm(), 1e-15);
  EXPECT_LE((load_direction(ball, 15) - Vec3(0.5, s, 0)).norm(), 1e-15);
  EXPECT_LE((load_direction(ball, 36) - Vec3(-1, 0, 0)).norm(), 1e-15);
}

// The lecture's load is as large as friction can be: by Coulomb's law the ball stays. A polygon within the disk lets it
// go where it has no corner: 4 facets let it slide by tens of metres, 6 have corners towards all three loads.
TEST(Ball, StaysAtRestByCoulombsLawAlone) {
  const CyclicBall ball{.cycles = 1, .h = 0.02};
  const BallPath exact = solved(ball);
  EXPECT_LE(farthest(exact, {.centres = std::vector<Vec3>(exact.centres.size(), exact.centres[0])}), 1e-7);
  EXPECT_GT(farthest(solved(ball, {Kind::Inner, 4}), exact), 10);
  EXPECT_GT(farthest(solved(ball, {Kind::Inner, 8}), exact), 1);
  EXPECT_LT(farthest(solved(ball, {Kind::Inner, 6}), exact), 1e-6);
  EXPECT_LT(farthest(solved(ball, {Kind::Outer, 4}), exact), 1e-6);
}

// From rest under L > 1 it slides along the load with (L - 1) mu g: x = (L - 1) mu g t^2 / 2, exact with theta = 1/2.
// Polygons leave the direction of the load (4 facets slide at 45 degrees under a load at 60).
TEST(Ball, FirstPhaseIsUniformAcceleration) {
  const CyclicBall ball{.load = 1.5, .cycles = 1.0 / 3, .h = 0.02};
  const BallPath path = solved(ball);
  for (std::size_t k = 0; k < path.times.size(); ++k) {
    const double s = 0.5 * 0.5 * ball.mu * ball.gravity * path.times[k] * path.times[k];
    ASSERT_LE((path.centres[k] - path.centres[0] - s * load_direction(ball, 0)).norm(), 1e-7);
  }
  const Vec3 end = solved(ball, {Kind::Inner, 4}).centres.back();
  EXPECT_NEAR(std::atan2(end.y(), end.x()), std::numbers::pi / 4, 1e-6);
}

// L = 1: |v| (1 + cos phi) is constant during a phase, phi from load to velocity (ball.hpp). First order in h.
TEST(Ball, PhasesOfTheLectureKeepTheirInvariant) {
  const auto worst = [](double h) {
    const CyclicBall ball{.cycles = 1, .h = h, .velocity = Vec3(4, -1, 0)};
    const BallPath path = solved(ball);
    double deviation = 0;
    double constant = 0;
    const auto phase = static_cast<std::size_t>(std::lround(ball.phase / h));
    for (std::size_t k = 0; k + 1 < path.times.size(); ++k) {
      const Vec3 d = load_direction(ball, path.times[k] + h / 2);
      if (k % phase == 0) constant = path.velocities[k].norm() + path.velocities[k].dot(d);
      const Vec3& v = path.velocities[k + 1];
      deviation = std::max(deviation, std::abs(v.norm() + v.dot(d) - constant));
    }
    return deviation;
  };
  const double coarse = worst(0.02);
  EXPECT_LE(coarse, 0.1);
  EXPECT_NEAR(coarse / worst(0.01), 2, 0.4);
}

// By symmetry (ball.hpp) the exact path closes, and so does one with 6 facets; with 4, 8, 16 the ball drifts for ever.
TEST(Ball, ExactPathClosesAndPolygonsDrift) {
  const CyclicBall ball{.load = 1.5, .cycles = 5, .h = 0.05};
  EXPECT_LT(solved(ball).drift(ball).norm(), 1e-4);
  EXPECT_LT(solved(ball, {Kind::Inner, 6}).drift(ball).norm(), 1e-4);
  EXPECT_GT(solved(ball, {Kind::Inner, 4}).drift(ball).norm(), 1);
  EXPECT_GT(solved(ball, {Kind::Inner, 8}).drift(ball).norm(), 0.3);
  EXPECT_GT(solved(ball, {Kind::Inner, 16}).drift(ball).norm(), 0.1);
  EXPECT_GT(solved(ball, {Kind::Outer, 8}).drift(ball).norm(), 0.3);
}

// The frame (T1, T2) is a convention: Coulomb's law gives the same path in any, a polygon turns with it.
TEST(Ball, FrameMeansNothingToTheExactLaw) {
  CyclicBall ball{.load = 1.3, .cycles = 1, .h = 0.05};
  const BallPath exact = solved(ball);
  const BallPath faceted = solved(ball, {Kind::Inner, 8});
  for (const double frame : {0.2, 0.7, 2.0}) {
    ball.frame = frame;
    EXPECT_LE(farthest(solved(ball), exact), 1e-6) << frame;
    EXPECT_GE(farthest(solved(ball, {Kind::Inner, 8}), faceted), 1) << frame;
  }
}

// The lecture's load: what a polygon lacks of the disk is O(1 / K^2), and so is the drift, over all frames. (One frame
// says little: how far its corners are from the loads decides.)
TEST(Ball, DriftFallsLikeOneOverKSquared) {
  const auto error = [](int K) {
    CyclicBall ball{.cycles = 1, .h = 0.05};
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      ball.frame = 2 * std::numbers::pi / K * (k + 0.5) / 4;
      const BallPath path = solved(ball, {Kind::Inner, K});
      sum += (path.centres.back() - path.centres.front()).squaredNorm();
    }
    return std::sqrt(sum / 4);
  };
  const double order = std::log(error(4) / error(64)) / std::log(16.0);
  EXPECT_GT(order, 1.7);
  EXPECT_LT(order, 2.5);
}

// A ball that may turn rolls, F = 7/5 m a (textbook), and needs 2/7 F of friction: no law of friction shows.
TEST(Ball, RollsTheSameByAnyLaw) {
  const CyclicBall ball{.cycles = 1.0 / 3, .h = 0.05, .rolls = true};
  const double a = 5.0 / 7 * ball.mu * ball.gravity;
  const Vec3 expected = Vec3(0, 0, ball.radius) + 0.5 * a * 25 * load_direction(ball, 0);
  for (const FrictionLaw& law : {FrictionLaw{}, FrictionLaw{Kind::Inner, 4}})
    EXPECT_LE((solved(ball, law).centres.back() - expected).norm(), 1e-6) << name(law);
}

// Everything the load did is in the kinetic energy or in friction.
TEST(Ball, EnergyIsAccountedFor) {
  for (const FrictionLaw& law : {FrictionLaw{}, FrictionLaw{Kind::Inner, 8}}) {
    const BallPath path = solved({.load = 1.4, .cycles = 1, .h = 0.05}, law);
    const Energy& e = path.energy;
    EXPECT_GT(e.friction, 0);
    EXPECT_NEAR(e.kinetic + e.potential + e.friction, path.start_energy + e.work, 1e-6 * e.work);
    EXPECT_NEAR(e.impacts, 0, 1e-8);
  }
}

TEST(Ball, RefusesWhatMakesNoSense) {
  for (const CyclicBall& ball : {CyclicBall{.mu = -1}, CyclicBall{.load = std::nan("")}, CyclicBall{.phase = 0},
                                 CyclicBall{.h = 0}, CyclicBall{.theta = 0.2}, CyclicBall{.cycles = 1e12}})
    EXPECT_THROW(run_ball(ball, {}), std::invalid_argument);
  EXPECT_THROW(run_ball({}, {Kind::Inner, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact
