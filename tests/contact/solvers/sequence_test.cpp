// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/sequence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "contact/refusal.hpp"
#include "contact/scenes/shaken_scene.hpp"

namespace perp::contact {
namespace {

using test::refusal_of;

// Impulses go with their keys, whatever the order; new contacts begin with zero, and those that are gone are forgotten.
TEST(KeptImpulses, GoWithTheirKeys) {
  KeptImpulses kept;
  const std::vector<ContactKey> first{7, 3};
  EXPECT_EQ(kept.start(3, first).size(), 0);
  Vec r(6);
  r << 1, 2, 3, 4, 5, 6;
  kept.keep(3, first, r);
  const std::vector<ContactKey> second{9, 3, 7};
  Vec expected(9);
  expected << 0, 0, 0, 4, 5, 6, 1, 2, 3;
  EXPECT_EQ(kept.start(3, second), expected);
  kept.keep(3, std::vector<ContactKey>{9}, r.head(3));
  EXPECT_EQ(kept.start(3, first).size(), 0);
  const std::vector<ContactKey> twice{1, 1};
  EXPECT_NE(refusal_of([&] { kept.start(3, twice); }).find("key 1 of contact 1"), std::string::npos);
}

// A shaken arch: each step is accepted by the judge of its own problem, by every method, and the velocities are those
// of the cold solve. A step that was called solved because the one before it was would differ.
TEST(Sequence, StepsAreTheColdOnes) {
  for (const char* text : {"glocker", "coulomb+nsgs", "inner:8"}) {
    const Variant variant = variant_of(text);
    ShakenScene scene(make_scene(Arch{.voussoirs = 5}), {.amplitude = 1});
    Sequence warm({.variant = variant});
    Sequence cold({.variant = variant, .warm = false});
    for (int k = 0; k < 25; ++k) {
      const Problem problem = scene.problem();
      const contact::Run w = warm.step(problem);
      const contact::Run c = cold.step(problem);
      ASSERT_TRUE(w.solved && c.solved) << text << " step " << k << ": " << w.message;
      EXPECT_TRUE(!variant.exact() || accepted(residual(problem, w.solution.r), 1e-8)) << text << " step " << k;
      EXPECT_LE((w.solution.u - c.solution.u).norm(), 1e-5 * problem.q.norm()) << text << " step " << k;
      scene.advance(w.solution.r);
    }
    EXPECT_EQ(warm.stats().steps, 25);
    EXPECT_EQ(warm.stats().solved, 25);
    EXPECT_EQ(cold.stats().warm, 0);
    EXPECT_EQ(warm.stats().warm + warm.stats().cold_again, 24) << text;
  }
}

// What it is for: a tenth of the factorizations of cold steps, on an arch that is shaken by 0.05 g. Without a start,
// with impulses at the wrong contacts, or where r wanders onto the border of the cones it is far more.
TEST(Sequence, TakesATenthOfTheFactorizations) {
  ShakenScene scene(make_scene("arch", 60), {.amplitude = 0.5});
  Sequence warm;
  Sequence cold({.warm = false});
  for (int k = 0; k < 100; ++k) {
    const Problem problem = scene.problem();
    cold.step(problem);
    scene.advance(warm.step(problem).solution.r);
  }
  EXPECT_EQ(warm.stats().solved, 100);
  EXPECT_EQ(cold.stats().solved, 100);
  EXPECT_LE(warm.stats().factorizations, 0.1 * static_cast<double>(cold.stats().factorizations));
}

// Boxes that slide down an incline are solved by a few sweeps, warm as cold, or by the factors of the step before.
// Boxes that slide as fast as each other touch without impulses: Newton steps that close such contacts, because
// rounding says so, end far away, and took 3 to 10 factorizations a step. How near to one a step it is depends on
// rounding, too.
TEST(Sequence, NeedsFewFactorizationsWhereBoxesSlide) {
  ShakenScene scene(make_scene("incline", 100), {.amplitude = 2});
  Sequence sequence;
  long before = 0;
  constexpr int settled = 10;
  constexpr int steps = 30;
  for (int k = 0; k < settled + steps; ++k) {
    if (k == settled) before = sequence.stats().factorizations;
    const contact::Run run = sequence.step(scene.problem());
    ASSERT_TRUE(run.solved) << run.message;
    scene.advance(run.solution.r);
  }
  EXPECT_LE(sequence.stats().factorizations - before, 2 * steps);
}

// Four contacts a box are redundant: r is not unique, and must stay in the middle of the cones where all of it sticks,
// step after step. Newton steps of least norm carry it onto their border.
TEST(Sequence, KeepsRedundantImpulsesInsideTheirCones) {
  ShakenScene scene(make_scene("stack", 60), {.amplitude = 0.5});
  Sequence sequence;
  for (int k = 0; k < 60; ++k) {
    const contact::Run run = sequence.step(scene.problem());
    ASSERT_TRUE(run.solved) << run.message;
    const double largest = run.solution.r.lpNorm<Eigen::Infinity>();
    for (const ContactState& contact : run.states)
      EXPECT_TRUE(k < 20 || (contact.state == State::Stick && contact.margin > 1e-4 * largest)) << k;
    scene.advance(run.solution.r);
  }
  EXPECT_EQ(sequence.stats().cold_again, 0);
}

// Walls on both sides of a box may press it with any force: impulses stay bounded although the middle of the cones is
// at infinity.
TEST(Sequence, KeepsPrestressBounded) {
  Scene scene{.name = "wedged"};
  const Index box = scene.bodies.add({.mass = 1, .inertia = RigidBodies::box_inertia(1, Vec3::Ones())});
  for (const double side : {-0.5, 0.5})
    for (const auto& [y, z] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
      scene.bodies.touch(
          {.a = box, .b = ground, .point = Vec3(side, y, z), .normal = Vec3(side < 0 ? 1 : -1, 0, 0), .mu = 0.8});
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    scene.bodies.touch({.a = box, .b = ground, .point = Vec3(x, y, -0.5), .mu = 0.8});
  ShakenScene shaken(scene, {.amplitude = 0.5});
  Sequence sequence;
  for (int k = 0; k < 200; ++k) {
    const Problem problem = shaken.problem();
    const contact::Run run = sequence.step(problem);
    ASSERT_TRUE(run.solved) << run.message;
    EXPECT_LE(run.solution.r.norm(), 100 * problem.q.norm()) << k;  // of mass 1
    shaken.advance(run.solution.r);
  }
  EXPECT_EQ(sequence.stats().cold_again, 0);
}

// Where W or the friction changes nothing of what was kept for the last one is used.
TEST(Sequence, TakesAnotherProblemOfTheSamePattern) {
  Problem problem = make_scene("stack", 24).problem();
  (void)problem.W.given();
  Sequence sequence;
  ASSERT_TRUE(sequence.step(problem).solved);
  for (const double factor : {2.0, 0.5, 1.0}) {
    Problem other = problem;
    other.W.given() *= factor;
    other.mu *= std::sqrt(factor);
    other.q *= 0.9;
    for (int again = 0; again < 2; ++again) {
      const contact::Run run = sequence.step(other);
      ASSERT_TRUE(run.solved) << run.message;
      EXPECT_TRUE(accepted(residual(other, run.solution.r), 1e-8)) << factor;
      EXPECT_EQ(run.residual.largest(), residual(other, run.solution.r).largest());
      other.q *= 1.01;
    }
  }
}

// The same problem again is accepted as it is, without a factorization; with other keys all contacts are new.
TEST(Sequence, KnowsTheStepBeforeByItsKeys) {
  const Problem problem = make_scene("stack", 20).problem();
  std::vector<ContactKey> keys;
  for (Index a = 0; a < problem.contacts(); ++a) keys.push_back(static_cast<ContactKey>(100 + a));
  Sequence sequence;
  ASSERT_TRUE(sequence.step(problem, keys).solved);
  const contact::Run again = sequence.step(problem, keys);
  EXPECT_EQ(again.solved_by, "warm-start");
  EXPECT_EQ(again.steps(), 0);
  for (ContactKey& key : keys) key += 1000;
  EXPECT_NE(sequence.step(problem, keys).solved_by, "warm-start");
  sequence.forget();
  EXPECT_NE(sequence.step(problem, keys).solved_by, "warm-start");
  keys.pop_back();
  EXPECT_NE(refusal_of([&] { sequence.step(problem, keys); }).find("keys"), std::string::npos);
}

// Contacts come and go: the second step has one contact less and is no continuation by order, but by keys.
TEST(Sequence, TakesOtherNumbersOfContacts) {
  Sequence sequence;
  for (const Index contacts : {24, 12, 36, 1}) {
    const Problem problem = make_scene("wall", contacts).problem();
    const contact::Run run = sequence.step(problem);
    EXPECT_TRUE(run.solved) << contacts << ": " << run.message;
    EXPECT_TRUE(accepted(residual(problem, run.solution.r), 1e-8));
  }
}

// At A = 0 nothing shakes: a scene at rest stays, gaps stay closed. Its q is that of the scene's own problem.
TEST(ShakenScene, RestsWithoutShaking) {
  const Scene made = make_scene("wall", 30);
  ShakenScene scene(made, {.amplitude = 0});
  EXPECT_LE((scene.problem().q - made.problem().q).norm(), 1e-12 * made.problem().q.norm());
  Sequence sequence;
  for (int k = 0; k < 5; ++k) {
    const contact::Run run = sequence.step(scene.problem());
    ASSERT_TRUE(run.solved) << run.message;
    scene.advance(run.solution.r);
  }
  EXPECT_LE(scene.velocities().norm(), 1e-6);
  EXPECT_LE(scene.gaps().maxCoeff(), 1e-8);
  EXPECT_NE(refusal_of([&] { ShakenScene(made, {.direction = Vec3(1, 1, 0)}); }).find("direction"), std::string::npos);
}

// A single box on the ground with mu = 0.5 follows 2 m/s^2 of the table, and not 8: then it slides by the difference.
TEST(ShakenScene, BoxesSlideWhereTheTableIsTooFast) {
  for (const double amplitude : {2.0, 8.0}) {
    ShakenScene scene(make_scene(BoxStack{.boxes = 1, .shift = 0}), {.amplitude = amplitude, .frequency = 0.5});
    Sequence sequence;
    for (int k = 0; k < 50; ++k) {
      const contact::Run run = sequence.step(scene.problem());
      ASSERT_TRUE(run.solved) << run.message;
      scene.advance(run.solution.r);
    }
    EXPECT_EQ(scene.velocities().head(2).norm() > 1e-3, amplitude > 5) << amplitude;
  }
}

}  // namespace
}  // namespace perp::contact
