// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/rigid_bodies.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "contact/contact_support.hpp"
#include "contact/scenes/scenes_support.hpp"

namespace perp::contact {
namespace {

RigidBodies random_bodies(std::mt19937& random, int bodies, int contacts) {
  RigidBodies scene;
  for (int k = 0; k < bodies; ++k) {
    Mat3 R;
    R << random_vector(random), random_vector(random), random_vector(random);
    scene.add({.mass = 0.5 + k,
               .inertia = R * R.transpose() + Mat3::Identity(),
               .centre = random_vector(random),
               .velocity = random_vector(random),
               .spin = random_vector(random)});
  }
  for (int k = 0; k < contacts; ++k)
    scene.touch({.a = k % bodies,
                 .b = (k + 1) % bodies,
                 .point = random_vector(random),
                 .normal = random_vector(random).normalized(),
                 .mu = 0.1 * k});
  return scene;
}

// Right-handed, orthonormal, and its first column the normal: u_N would otherwise mix with u_T.
TEST(RigidBodies, FramesAreRotations) {
  std::mt19937 random(1);
  for (int k = 0; k < 50; ++k) {
    const Vec3 n = k < 3 ? Vec3::Unit(k) : Vec3(random_vector(random).normalized());
    const Mat3 F = contact_frame(n);
    EXPECT_LE((F.transpose() * F - Mat3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(F.determinant(), 1, 1e-14);
    EXPECT_EQ(F.col(0), n);
  }
}

// u = H'v is the velocity of A's material point against B's in the contact's frame, by v + omega x arm.
TEST(RigidBodies, HIsTheKinematics) {
  std::mt19937 random(2);
  const RigidBodies scene = random_bodies(random, 4, 7);
  const Global global = scene.global(0.1, Vec3::Zero());
  Vec v(24);
  for (Index i = 0; i < 24; i += 3) v.segment<3>(i) = random_vector(random);
  const Vec u = global.H.transpose() * v + global.w;
  for (Index a = 0; a < 7; ++a) {
    const auto& c = scene.contacts()[static_cast<std::size_t>(a)];
    const auto point_velocity = [&](Index body) {
      const Vec3 arm = c.point - scene.bodies()[static_cast<std::size_t>(body)].centre;
      const Vec3 omega = v.segment<3>(6 * body + 3);
      return Vec3(v.segment<3>(6 * body) + omega.cross(arm));
    };
    const Vec3 relative = contact_frame(c.normal).transpose() * (point_velocity(c.a) - point_velocity(c.b));
    EXPECT_LE((u.segment<3>(3 * a) - relative).norm(), 1e-13);
  }
}

// Impulses between bodies change neither momentum nor angular momentum about the origin: a wrong arm, a wrong sign for
// B, would.
TEST(RigidBodies, InnerImpulsesKeepMomentum) {
  std::mt19937 random(3);
  const RigidBodies scene = random_bodies(random, 5, 12);
  const Global global = scene.global(0.1, Vec3::Zero());
  Vec r(36);
  for (Index i = 0; i < 36; i += 3) r.segment<3>(i) = random_vector(random);
  const Vec p = global.H * r;
  Vec3 momentum = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
  for (Index b = 0; b < 5; ++b) {
    const Vec3 push = p.segment<3>(6 * b);
    momentum += push;
    angular += scene.bodies()[static_cast<std::size_t>(b)].centre.cross(push) + p.segment<3>(6 * b + 3);
  }
  EXPECT_LE(momentum.norm(), 1e-13);
  EXPECT_LE(angular.norm(), 1e-13);
}

// f = M v_k + h (m g, -omega x J omega): a body without contacts flies its parabola, and gyroscopic moments act.
TEST(RigidBodies, FreeFlight) {
  std::mt19937 random(4);
  const RigidBodies scene = random_bodies(random, 2, 0);
  const Vec3 down(0, 0, -g);
  const Global global = scene.global(0.01, down);
  for (Index b = 0; b < 2; ++b) {
    const auto& body = scene.bodies()[static_cast<std::size_t>(b)];
    EXPECT_LE((global.f.segment<3>(6 * b) / body.mass - (body.velocity + 0.01 * down)).norm(), 1e-14);
    const Vec3 L = body.inertia * body.spin;
    EXPECT_LE((global.f.segment<3>(6 * b + 3) - (L - 0.01 * body.spin.cross(L))).norm(), 1e-13);
  }
}

// A cube of edge a: m a^2 / 6; a plate of no thickness: J_zz = m (b^2 + c^2) / 12; a sphere: 2/5 m r^2.
TEST(RigidBodies, Inertias) {
  EXPECT_LE((RigidBodies::box_inertia(3, Vec3::Constant(2)) - 2 * Mat3::Identity()).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(RigidBodies::box_inertia(12, Vec3(3, 4, 0))(2, 2), 25);
  EXPECT_DOUBLE_EQ(RigidBodies::sphere_inertia(5, 2)(1, 1), 8);
}

TEST(RigidBodies, Refusals) {
  RigidBodies scene;
  EXPECT_THROW(scene.add({.mass = 0, .inertia = Mat3::Identity()}), std::invalid_argument);
  EXPECT_THROW(scene.add({.mass = 1, .inertia = Mat3::Zero()}), std::invalid_argument);
  scene.add({.mass = 1, .inertia = Mat3::Identity()});
  EXPECT_THROW(scene.touch({.a = 0, .b = 1}), std::invalid_argument);
  EXPECT_THROW(scene.touch({.a = 0, .b = 0}), std::invalid_argument);
  EXPECT_THROW(scene.touch({.a = 0, .b = ground, .normal = Vec3(0, 0, 2)}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact
