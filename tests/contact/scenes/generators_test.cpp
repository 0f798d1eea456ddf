// SPDX-License-Identifier: Apache-2.0
/// The generated scenes against mechanics: weights, the angle of friction, the catenary, the least thickness of arches.
#include "contact/scenes/generators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"
#include "contact/scenes/scenes_support.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {
namespace {

/// Friction by the square with corners on T1 and T2: exact where contacts stick, or slip along T1 or T2.
Solution by_square(const Problem& p) {
  const InnerFaceting inner(p, {Polygon::inscribed(4)});
  const lcp::Result result = solved(inner);
  EXPECT_TRUE(result.solved()) << p.name << ": " << result.message;
  return inner.recover(result.z);
}

double mass(const Scene& scene) {
  double sum = 0;
  for (const auto& body : scene.bodies.bodies()) sum += body.mass;
  return sum;
}

/// Upward impulse from the ground.
double support_impulse(const Scene& scene, In r) {
  double sum = 0;
  for (Index a = 0; a < scene.contacts(); ++a) {
    const auto& c = scene.bodies.contacts()[static_cast<std::size_t>(a)];
    const Vec3 impulse = contact_frame(c.normal) * r.segment<3>(3 * a);
    if (c.b == ground) sum += impulse[2];
    if (c.a == ground) sum -= impulse[2];
  }
  return sum;
}

// Every joint of a resting stack carries the weight above it: sum r_N = m g h of what is above.
TEST(Generators, StackCarriesItsWeight) {
  const Scene scene = make_scene(BoxStack{.boxes = 8, .seed = 3});
  ASSERT_EQ(scene.contacts(), 32);
  const Problem p = scene.problem();
  const Solution s = by_square(p);
  EXPECT_LE(s.u.norm(), 1e-10);
  EXPECT_LE(residual(p, s.r).scaled, 1e-10);
  const double box = mass(scene) / 8;
  for (Index k = 0; k < 8; ++k) {
    double joint = 0;
    for (Index a = 4 * k; a < 4 * k + 4; ++a) joint += s.r[3 * a];
    EXPECT_NEAR(joint, static_cast<double>(8 - k) * box * g * scene.step, 1e-8 * box);
  }
}

// Four feet of one box: 12 impulses for 6 equations. W has rank 6, or "redundant" is an empty word.
TEST(Generators, FourFeetAreRedundant) {
  const Problem p = make_scene(BoxStack{.boxes = 1}).problem();
  const Vec eigenvalues = Eigen::SelfAdjointEigenSolver<support::Dense>(support::Dense(p.W.matrix())).eigenvalues();
  EXPECT_LE(std::abs(eigenvalues[5]), 1e-12 * eigenvalues[11]);
  EXPECT_GE(eigenvalues[6], 1e-3 * eigenvalues[11]);
}

// One box on a slope: at rest below the angle of friction, and above it down with h g (sin - mu cos).
TEST(Generators, BoxOnAnIncline) {
  const double mu = 0.5;
  const double critical = std::atan(mu);
  for (const int boxes : {1, 4}) {
    const Solution below = by_square(make_scene(Incline{.boxes = boxes, .angle = critical - 0.01, .mu = mu}).problem());
    EXPECT_LE(below.u.norm(), 1e-10);
    const double angle = critical + 0.01;
    const Scene scene = make_scene(Incline{.boxes = boxes, .angle = angle, .mu = mu});
    const Problem p = scene.problem();
    const Solution above = by_square(p);
    EXPECT_LE(residual(p, above.r).scaled, 1e-10);
    const double speed = scene.step * g * (std::sin(angle) - mu * std::cos(angle));
    EXPECT_GE(speed, 1e-4);
    for (Index a = 0; a < scene.contacts(); ++a) {
      const auto& c = scene.bodies.contacts()[static_cast<std::size_t>(a)];
      const Vec3 u = contact_frame(c.normal) * above.u.segment<3>(3 * a);
      const Vec3 down = c.b == ground ? Vec3(std::cos(angle), 0, -std::sin(angle)) : Vec3(Vec3::Zero());
      EXPECT_LE((u - speed * down).norm(), 1e-10) << "contact " << a;
    }
  }
}

// The catenary's tension h m g sqrt(T^2 + (k - n/2)^2), without friction, solves the exact problem: geometry, weights
// and normals agree. With the links straight instead of along the catenary, the moments would not.
TEST(Generators, ChainHangsInItsCatenary) {
  for (const int points : {1, 2}) {
    const Chain options{.links = 11, .tension = 3, .points = points};
    const Scene scene = make_scene(options);
    const Problem p = scene.problem();
    Vec r = Vec::Zero(3 * scene.contacts());
    for (Index a = 0; a < scene.contacts(); ++a) {
      const double k = static_cast<double>(a / points);
      r[3 * a] = mass(scene) / 11 * g * scene.step * std::hypot(3., k - 5.5) / points;
    }
    EXPECT_LE(residual(p, r).scaled, 1e-12) << points;
    EXPECT_GE(residual(p, Vec(1.01 * r)).scaled, 1e-4) << points;
  }
}

// Milankovitch (1907): a semicircular arch needs thickness / radius >= 0.1075, and friction: it stands for 0.25 with
// mu = 0.7, falls for 0.05 whatever mu is, and slides for mu = 0.05.
TEST(Generators, ArchStandsWhereAThrustLineFits) {
  const Scene thick = make_scene(Arch{.voussoirs = 9, .thickness = 0.5, .mu = 0.7});
  const Solution standing = by_square(thick.problem());
  EXPECT_LE(standing.u.norm(), 1e-9);
  EXPECT_NEAR(support_impulse(thick, standing.r), mass(thick) * g * thick.step, 1e-6 * mass(thick));
  const Solution thin = by_square(make_scene(Arch{.voussoirs = 9, .thickness = 0.1, .mu = 5}).problem());
  EXPECT_GE(thin.u.norm(), 1e-4);
  const Solution smooth = by_square(make_scene(Arch{.voussoirs = 9, .thickness = 0.5, .mu = 0.05}).problem());
  EXPECT_GE(smooth.u.norm(), 1e-4);
}

// The voussoirs' masses add up to the polygonal ring: density x depth x (R^2 - r^2) / 2 x n sin(pi / n).
TEST(Generators, ArchWeighsWhatItsRingDoes) {
  const Scene scene = make_scene(Arch{.voussoirs = 7});
  const double ring = (2.25 * 2.25 - 1.75 * 1.75) / 2 * 7 * std::sin(std::acos(-1.) / 7);
  EXPECT_NEAR(mass(scene), 2400 * 0.8 * ring, 1e-9);
}

TEST(Generators, WallCarriesItsWeight) {
  const Scene scene = make_scene(Wall{.courses = 3, .bricks = 3});
  // Lowest course: 3 x 4 + 2 joints x 4; second: 2 x 8 + 1 x 4; third: 1 half, 2 halves, 1 half, 2 joints.
  EXPECT_EQ(scene.contacts(), 12 + 8 + 16 + 4 + 16 + 8);
  const Solution s = by_square(scene.problem());
  EXPECT_LE(s.u.norm(), 1e-10);
  EXPECT_NEAR(support_impulse(scene, s.r), mass(scene) * g * scene.step, 1e-9 * mass(scene));
}

// Poured spheres touch where contacts say so and overlap nowhere; each has at most three supports below it or at a
// wall, and most have three. Balance of vertical momentum for whatever motion follows.
TEST(Generators, SpheresTouch) {
  const Scene scene = make_scene(Spheres{.spheres = 60, .seed = 5});
  const auto& bodies = scene.bodies.bodies();
  const auto radius = [&](Index i) {
    const auto& b = bodies[static_cast<std::size_t>(i)];
    return std::sqrt(b.inertia(0, 0) / (0.4 * b.mass));
  };
  for (Index i = 0; i < 60; ++i)
    for (Index j = 0; j < i; ++j) {
      const auto apart = bodies[static_cast<std::size_t>(i)].centre - bodies[static_cast<std::size_t>(j)].centre;
      EXPECT_GE(apart.norm(), (radius(i) + radius(j)) * (1 - 1e-8)) << i << " and " << j;
    }
  std::vector<int> supports(60, 0);
  for (const auto& c : scene.bodies.contacts()) {
    ++supports[static_cast<std::size_t>(c.a)];
    for (const Index body : {c.a, c.b}) {
      if (body == ground) continue;
      EXPECT_NEAR((c.point - bodies[static_cast<std::size_t>(body)].centre).norm(), radius(body), 1e-4 * radius(body));
    }
  }
  EXPECT_GE(std::count(supports.begin(), supports.end(), 3), 25);
  const Problem p = scene.problem();
  const Solution s = by_square(p);
  const Vec v_step = p.global->f + p.global->H * s.r;  // M v
  double momentum = 0;
  for (Index b = 0; b < 60; ++b) momentum += v_step[6 * b + 2];
  EXPECT_NEAR(momentum, support_impulse(scene, s.r) - mass(scene) * g * scene.step, 1e-9 * mass(scene));
}

// The same seed gives the same problem, another one another; sizes are about what was asked for; all of W is symmetric.
TEST(Generators, ByNameAndSize) {
  for (const GeneratorEntry& entry : generators()) {
    SCOPED_TRACE(entry.name);
    for (const Index contacts : {10, 100, 1000}) {
      const Scene scene = make_scene(entry.name, contacts, 7);
      EXPECT_NEAR(static_cast<double>(scene.contacts()), static_cast<double>(contacts),
                  std::max(3., 0.12 * static_cast<double>(contacts)));
    }
    const Problem p = make_scene(entry.name, 40, 7).problem();
    const Problem again = make_scene(entry.name, 40, 7).problem();
    EXPECT_EQ((p.W.matrix() - again.W.matrix()).norm(), 0);
    EXPECT_EQ(p.q, again.q);
    EXPECT_LE((p.W.matrix() - SpMat(p.W.matrix().transpose())).norm(), 1e-14 * p.W.matrix().norm());
  }
  EXPECT_GE((make_scene("stack", 40, 7).problem().W.matrix() - make_scene("stack", 40, 8).problem().W.matrix()).norm(),
            1e-6);
}

TEST(Generators, TenThousandContacts) {
  const Scene scene = make_scene("wall", 10000);
  const Problem p = scene.problem();
  EXPECT_NEAR(static_cast<double>(p.contacts()), 10000, 1000);
  EXPECT_LE(p.W.matrix().nonZeros(), 400 * p.contacts());
}

TEST(Generators, Refusals) {
  EXPECT_THROW(make_scene("tower", 10), std::invalid_argument);
  EXPECT_THROW(make_scene("stack", 0), std::invalid_argument);
  EXPECT_THROW(make_scene(BoxStack{.boxes = 0}), std::invalid_argument);
  EXPECT_THROW(make_scene(BoxStack{.mu = -0.1}), std::invalid_argument);
  EXPECT_THROW(make_scene(BoxStack{.shift = 0.7}), std::invalid_argument);
  EXPECT_THROW(make_scene(Spheres{.radius = NAN}), std::invalid_argument);
  EXPECT_THROW(make_scene(Spheres{.width = 0.01}), std::invalid_argument);
  EXPECT_THROW(make_scene(Arch{.thickness = 5}), std::invalid_argument);
  EXPECT_THROW(make_scene(Chain{.points = 3}), std::invalid_argument);
  EXPECT_THROW(make_scene(Wall{.bricks = 1}), std::invalid_argument);
  EXPECT_THROW(make_scene(Incline{.angle = 1.6}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact
