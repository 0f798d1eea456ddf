// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/refusal.hpp"
#include "contact/scenes/elastic_rod.hpp"
#include "contact/scenes/pendulum_chain.hpp"

namespace perp::contact {
namespace {

Vec value_of(const NonlinearProblem& problem, In v) {
  Vec R = Vec::Zero(problem.size());
  EXPECT_TRUE(problem.R->eval(v, R));
  return R;
}

// One link is the mathematical pendulum: m l^2 (v - v_k) + h m g l sin(a), a at the middle of the step.
TEST(PendulumChain, OfOneLinkIsThePendulum) {
  const PendulumChain chain{.links = 1, .length = 2, .mass = 3, .floor = -9, .h = 0.1};
  const Motion at{.x = Vec::Constant(1, 2.5), .v = Vec::Constant(1, -1)};
  const NonlinearProblem problem = chain.step(at);
  const double v = 0.7;
  const double a = 2.5 + 0.5 * 0.1 * 0.5 * (v - 1);
  EXPECT_NEAR(value_of(problem, Vec::Constant(1, v))[0], 12 * (v + 1) + 0.1 * 6 * 9.81 * std::sin(a), 1e-12);
  EXPECT_EQ(problem.contacts(), 0);
}

// Free large rotations keep the energy up to O(h^2): a wrong sign of a centrifugal term, or an M at the wrong angles,
// would show in the first swing. Released from the horizontal, far above the floor.
TEST(PendulumChain, KeepsItsEnergyToSecondOrder) {
  double error[2] = {};
  for (const int refined : {0, 1}) {
    const PendulumChain chain{.links = 4, .floor = -9, .h = 0.002 / (1 + refined)};
    Motion at = chain.straight(std::numbers::pi / 2);
    const double before = chain.energy(at);
    for (int k = 0; k < 150 * (1 + refined); ++k) {
      const NonlinearResult step = solve(chain.step(at), at.v, {.tol = 1e-11});
      ASSERT_TRUE(step.solved()) << step.message;
      at = chain.moved(at, step.v);
      error[refined] = std::max(error[refined], std::abs(chain.energy(at) - before));
    }
  }
  EXPECT_LT(error[0], 1e-4);
  EXPECT_NEAR(error[0] / error[1], 4, 0.5);
}

// It falls onto the floor: every step is accepted, nothing gets deeper than a step's way, and energy is only lost.
TEST(PendulumChain, FallsOntoTheFloor) {
  const PendulumChain chain{.links = 12, .h = 0.01};
  Motion at = chain.straight(1.5);
  const double before = chain.energy(at);
  Index most = 0;
  for (int k = 0; k < 100; ++k) {
    const NonlinearProblem problem = chain.step(at);
    most = std::max(most, problem.contacts());
    const NonlinearResult step = solve(problem, at.v, {.tol = 1e-9});
    ASSERT_TRUE(step.solved()) << k << ": " << step.message;
    at = chain.moved(at, step.v);
    for (Index i = 0; i < chain.links; ++i) EXPECT_GE(chain.height(at, i), chain.floor - 0.05) << k;
  }
  EXPECT_GE(most, 4);
  EXPECT_LT(chain.energy(at), before);
}

// R - m (v - v_k) - h (c v - F) is h E' of the energy, compared with differences of it: exact to 1e-7.
TEST(ElasticRod, ForceIsTheGradientOfItsEnergy) {
  const ElasticRod rod{.nodes = 5, .damping = 0, .gravity = 0, .press = 0, .push = Vec3::Zero(), .h = 1};
  Motion at = rod.straight(0.1);
  for (Index i = 0; i < at.x.size(); ++i) at.x[i] += 0.02 * std::sin(1.0 + 3.0 * static_cast<double>(i * i));
  const Vec R = value_of(rod.step(at), Vec::Zero(15));
  for (Index i = 0; i < 15; ++i) {
    constexpr double step = 1e-6;
    Motion up = at;
    Motion down = at;
    up.x[i] += step;
    down.x[i] -= step;
    const double slope = (rod.elastic_energy(up) - rod.elastic_energy(down)) / (2 * step);
    EXPECT_NEAR(R[i], slope, 1e-6 * (1 + std::abs(slope))) << i;
  }
}

// At rest after a while, pressed and pushed: the plane carries weight and press, and friction holds the push, since it
// is below mu times that.
TEST(ElasticRod, ComesToRestUnderItsLoad) {
  const ElasticRod rod;
  Motion at = rod.straight();
  Vec r;
  for (int k = 0; k < 400; ++k) {
    const NonlinearProblem problem = rod.step(at);
    const NonlinearResult step = solve(problem, at.v, {.tol = 1e-9});
    ASSERT_TRUE(step.solved()) << k << ": " << step.message;
    at = rod.moved(at, step.v);
    r = step.solution.r;
  }
  EXPECT_EQ(r.size(), 60);
  EXPECT_LE(at.v.lpNorm<Eigen::Infinity>(), 1e-4);
  Vec3 sum = Vec3::Zero();
  for (Index a = 0; a < rod.nodes; ++a) sum += r.segment<3>(3 * a);
  EXPECT_NEAR(sum[0], rod.h * 20 * (0.01 * 9.81 + 0.5), 1e-6);
  EXPECT_NEAR(sum[1], -rod.h * 3, 1e-4);
  EXPECT_NEAR(sum[2], -rod.h * 1, 1e-4);
}

TEST(NonlinearScenes, RefuseWithTheNameOfTheField) {
  EXPECT_EQ(test::refusal_of([] { PendulumChain{.h = -1}.step(PendulumChain{}.straight(0)); }),
            "pendulum chain: h is -1; it must be positive");
  EXPECT_NE(test::refusal_of([] { PendulumChain{}.step(PendulumChain{.links = 3}.straight(0)); }).find("3 entries"),
            std::string::npos);
  EXPECT_EQ(test::refusal_of([] { ElasticRod{.mu = -0.5}.step(ElasticRod{}.straight()); }),
            "elastic rod: mu is -0.5; it must be at least 0");
}

}  // namespace
}  // namespace perp::contact
