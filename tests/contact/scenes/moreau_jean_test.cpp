// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/moreau_jean.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "contact/scenes/scenes_support.hpp"

namespace perp::contact {
namespace {

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

MovingBody ball_on_floor(const Vec3& velocity, bool turns = false) {
  MovingBody ball = MovingBody::ball(2, 0.1);
  ball.centre = Vec3(0, 0, 0.1);
  ball.velocity = velocity;
  ball.turns = turns;
  return ball;
}

/// The plane through 0 that falls by `angle` along +x.
Plane incline(double angle, double mu, double frame = 0) {
  return {.normal = Vec3(std::sin(angle), 0, std::cos(angle)), .mu = mu, .frame = frame};
}

// Sliding along a line, closed form: x = v0 t - mu g t^2 / 2, at rest from v0 / (mu g) on, after v0^2 / (2 mu g). With
// theta = 1/2 the parabola is exact, the last step off by at most mu g h^2 / 8. Would catch a wrong weight of h or mu,
// a friction that does not end, and positions moved by the old or the new velocity alone.
TEST(MoreauJean, SlidingStopsInTimeAndPlace) {
  const double mu = 0.25;
  const double v0 = 3;
  const double h = 0.007;
  const Vec3 along = Vec3(std::cos(0.4), std::sin(0.4), 0);
  MoreauJean stepping({ball_on_floor(v0 * along)}, {{.mu = mu}}, {.h = h});
  const double stop = v0 / (mu * g);
  while (stepping.time() + h < stop) {
    ASSERT_TRUE(stepping.step().solved);
    const double t = stepping.time();
    const Vec3 expected = (v0 * t - 0.5 * mu * g * t * t) * along + Vec3(0, 0, 0.1);
    ASSERT_LE((stepping.bodies()[0].centre - expected).norm(), 1e-8);
  }
  EXPECT_GT(stepping.bodies()[0].velocity.norm(), 0);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(stepping.step().solved);
  EXPECT_LE(stepping.bodies()[0].velocity.norm(), 1e-8);
  EXPECT_NEAR(stepping.bodies()[0].centre.dot(along), v0 * v0 / (2 * mu * g), mu * g * h * h / 8 + 1e-8);
}

// Coulomb's law on an incline: at rest up to tan(angle) = mu, the angle of friction itself included; beyond it slides
// with g (sin - mu cos). Would catch a cone of another opening, at the place where it decides.
TEST(MoreauJean, InclineAtTheAngleOfFriction) {
  const double mu = 0.4;
  const double limit = std::atan(mu);
  for (const double angle : {0.5 * limit, 0.999 * limit, limit, 1.01 * limit, 1.5 * limit}) {
    const Plane plane = incline(angle, mu, 0.3);
    MovingBody body = MovingBody::ball(1, 0.1);
    body.centre = 0.1 * plane.normal;
    body.turns = false;
    const Vec3 start = body.centre;
    MoreauJean stepping({body}, {plane}, {});
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(stepping.step().solved);
    const double a = std::max(0.0, g * (std::sin(angle) - mu * std::cos(angle)));
    const Vec3 down(std::cos(angle), 0, -std::sin(angle));
    EXPECT_LE((stepping.bodies()[0].centre - start - 0.5 * a * down).norm(), 1e-7) << angle / limit;
  }
}

// On an incline at the angle of friction what friction takes from |v| gravity adds to v_s, the velocity downhill:
// |v| + v_s is constant. Launched across, a body ends downhill with half its speed. Curved sliding in closed form:
// would catch friction that is not opposite to slip, and polygons. The scheme is of first order here.
TEST(MoreauJean, LaunchedAcrossAnInclineItKeepsHalfItsSpeed) {
  const double mu = 0.4;
  const Plane plane = incline(std::atan(mu), mu);
  const Vec3 down(plane.normal.z(), 0, -plane.normal.x());
  const auto worst = [&](double h, const FrictionLaw& law) {
    MovingBody body = MovingBody::ball(1, 0.1);
    body.centre = 0.1 * plane.normal;
    body.velocity = Vec3(0, 2, 0);
    body.turns = false;
    MoreauJean stepping({body}, {plane}, {.h = h, .law = law});
    double deviation = 0;
    while (stepping.time() < 3) {
      EXPECT_TRUE(stepping.step().solved);
      const Vec3 v = stepping.bodies()[0].velocity;
      deviation = std::max(deviation, std::abs(v.norm() + v.dot(down) - 2));
    }
    EXPECT_EQ(law.kind != FrictionLaw::Kind::Coulomb, (stepping.bodies()[0].velocity - down).norm() > 10 * h);
    return deviation;
  };
  const double coarse = worst(0.01, {});
  const double fine = worst(0.005, {});
  EXPECT_LE(coarse, 0.05);
  EXPECT_NEAR(coarse / fine, 2, 0.3);
  EXPECT_GT(worst(0.01, {FrictionLaw::Kind::Inner, 4}), 0.2);
}

/// A load of L mu m g that turns with Omega keeps a sliding body on a circle: in the turning frame m V Omega across and
/// mu m g along the velocity balance it, so V = (mu g / Omega) sqrt(L^2 - 1), cos(angle from velocity to load) = 1 / L.
struct Circle {
  double mu = 0.3;
  double Omega = 2;
  double L = 1.6;
  double V = mu * g / Omega * std::sqrt(L * L - 1);

  MoreauJean start(double h, const FrictionLaw& law, double frame) const {
    MovingBody body = ball_on_floor(Vec3(0, V, 0));
    body.centre = Vec3(V / Omega, 0, 0.1);
    const double ahead = std::numbers::pi / 2 + std::acos(1 / L);
    const auto load = [*this, ahead, mass = body.mass](std::size_t, double t) {
      const double angle = Omega * t + ahead;
      return Vec3(L * mu * mass * g * Vec3(std::cos(angle), std::sin(angle), 0));
    };
    return {{body}, {{.mu = mu, .frame = frame}}, {.h = h, .law = law, .load = load}};
  }
  double turn() const { return 2 * std::numbers::pi / Omega; }
};

// Sliding all the time in a direction that changes, in closed form: the body stays on its circle, up to O(h).
TEST(MoreauJean, TurningLoadKeepsItOnACircle) {
  const Circle circle;
  const double radius = circle.V / circle.Omega;
  const auto worst = [&](double h) {
    MoreauJean stepping = circle.start(h, {}, 0);
    double deviation = 0;
    while (stepping.time() < circle.turn()) {
      EXPECT_TRUE(stepping.step().solved);
      const Vec3 x = stepping.bodies()[0].centre;
      deviation = std::max(deviation, std::abs(std::hypot(x[0], x[1]) - radius));
    }
    return deviation;
  };
  const double coarse = worst(0.01);
  EXPECT_LE(coarse, 0.03 * radius);
  EXPECT_NEAR(coarse / worst(0.005), 2, 0.3);
}

// The same by polygons: the direction meets all their corners, so that what they turn aside averages out, and what is
// left is what they lack of the disk, 1 / K^2. Would catch a polygon of another size, or one corner astray.
TEST(MoreauJean, PolygonsTendToTheDiskLikeOneOverKSquared) {
  const Circle circle;
  const auto end = [&](const FrictionLaw& law, double frame) {
    MoreauJean stepping = circle.start(0.004, law, frame);
    while (stepping.time() < circle.turn() / 2) EXPECT_TRUE(stepping.step().solved);
    return stepping.bodies()[0].centre;
  };
  const Vec3 exact = end({}, 0);
  EXPECT_LE((end({}, 0.7) - exact).norm(), 1e-7);
  for (const FrictionLaw::Kind kind : {FrictionLaw::Kind::Inner, FrictionLaw::Kind::Outer}) {
    const auto error = [&](int K) {
      double sum = 0;
      for (int k = 0; k < 3; ++k)
        sum += (end({kind, K}, 2 * std::numbers::pi / K * (k + 0.5) / 3) - exact).squaredNorm();
      return std::sqrt(sum / 3);
    };
    const double middle = error(8);
    EXPECT_NEAR(std::log2(error(4) / middle), 2, 0.5) << name({kind, 4});
    EXPECT_NEAR(std::log2(middle / error(16)), 2, 0.5) << name({kind, 8});
  }
}

// A ball thrown without spin slides until 2 v0 / (7 mu g), and then rolls with 5 v0 / 7 (any textbook of mechanics: its
// angular momentum about a point of the floor is kept). Would catch wrong lever arms, inertia or attitude.
TEST(MoreauJean, ThrownBallEndsRolling) {
  const double mu = 0.2;
  const double v0 = 3;
  MoreauJean stepping({ball_on_floor(Vec3(0, v0, 0), true)}, {{.mu = mu}}, {.h = 0.002});
  const double rolls = 2 * v0 / (7 * mu * g);
  double angle = 0;
  while (stepping.time() < 1.2 * rolls) {
    const Vec3 before = stepping.bodies()[0].spin;
    const Step step = stepping.step();
    ASSERT_TRUE(step.solved);
    angle += 0.001 * (before + stepping.bodies()[0].spin)[0];
    const double slip = stepping.bodies()[0].velocity.y() + 0.1 * stepping.bodies()[0].spin.x();
    EXPECT_EQ(slip > 1e-6, stepping.time() < rolls) << stepping.time();
  }
  EXPECT_LE((stepping.bodies()[0].velocity - Vec3(0, 5 * v0 / 7, 0)).norm(), 1e-7);
  EXPECT_LE((stepping.bodies()[0].spin - Vec3(-5 * v0 / 0.7, 0, 0)).norm(), 1e-5);
  const Mat3 turned = Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
  EXPECT_LE((stepping.bodies()[0].attitude - turned).norm(), 1e-9);
}

// Newton's law: a body dropped from the height H rises to e^2 H, e^4 H, ..; events are stepped over, so up to O(h).
TEST(MoreauJean, BouncesToHeightsOfEToTheTwoK) {
  for (const double e : {0.5, 0.8, 1.0}) {
    const double H = 1;
    MovingBody body = ball_on_floor(Vec3::Zero());
    body.centre = Vec3(0, 0, H + 0.1);
    MoreauJean stepping({body}, {{.mu = 0.3, .e = e}}, {.h = 2e-4});
    std::vector<double> peaks;
    double before = 0;
    while (peaks.size() < 4) {
      ASSERT_TRUE(stepping.step().solved);
      const double v = stepping.bodies()[0].velocity.z();
      if (before > 0 && v <= 0) peaks.push_back(stepping.bodies()[0].centre.z() - 0.1);
      before = v;
      ASSERT_LT(stepping.time(), 5);
    }
    for (std::size_t k = 0; k < peaks.size(); ++k)
      EXPECT_NEAR(peaks[k], H * std::pow(e, 2.0 * static_cast<double>(k + 1)), 4e-3 * static_cast<double>(k + 1)) << e;
  }
}

// A mass that meets a plane with U_N loses (1 - e^2) m U_N^2 / 2 and nothing to friction, whatever it does along the
// plane where mu = 0. With e at a body that leaves already, or e U_N of the wrong sign, this fails.
TEST(MoreauJean, NormalImpactLosesOneMinusESquared) {
  std::mt19937 random(1);
  for (int k = 0; k < 50; ++k) {
    const double e = k == 0 ? 0 : k == 1 ? 1 : uniform(random, 0, 1);
    const Plane plane{.normal = random_vector(random).normalized(), .e = e};
    MovingBody body = MovingBody::ball(uniform(random, 0.1, 5), 0.2);
    body.centre = 0.2 * plane.normal;
    body.velocity = random_vector(random);
    const double U = plane.normal.dot(body.velocity);
    MoreauJean stepping({body}, {plane}, {.gravity = Vec3::Zero()});
    const Step step = stepping.step();
    ASSERT_TRUE(step.solved);
    EXPECT_EQ(step.touches.empty(), U > 0);
    EXPECT_NEAR(step.energy.impacts, U < 0 ? 0.5 * (1 - e * e) * body.mass * U * U : 0, 1e-7);
    EXPECT_NEAR(plane.normal.dot(stepping.bodies()[0].velocity), U < 0 ? -e * U : U, 1e-7);
    EXPECT_NEAR(step.energy.friction, 0, 1e-12);
  }
}

struct Impact {
  Step step;
  double before = 0;  // T
};

/// One step without forces of a box, or a ball, that touches some of three planes of a corner with one knob or more.
Impact random_impact(std::mt19937& random, bool box, double mu, double e, int planes) {
  MovingBody body = box ? MovingBody::box(uniform(random, 0.5, 2), random_vector(random).cwiseAbs() + Vec3::Ones())
                        : MovingBody::ball(uniform(random, 0.5, 2), 0.5);
  const Vec3 axis = random_vector(random).normalized();
  body.attitude = Eigen::AngleAxisd(uniform(random, 0, 3), axis).toRotationMatrix();
  body.velocity = random_vector(random);
  body.spin = random_vector(random);
  std::vector<Plane> walls;
  for (int k = 0; k < planes; ++k) {
    Plane wall{.normal = Mat3(Eigen::AngleAxisd(1.2 * k, Vec3(1, 1, 0.3).normalized())).col(2), .mu = mu, .e = e};
    double lowest = std::numeric_limits<double>::infinity();
    for (const MovingBody::Knob& knob : body.knobs)
      lowest = std::min(lowest, wall.normal.dot(body.attitude * knob.at) - knob.radius);
    wall.point = lowest * wall.normal;  // the lowest knob touches, others are above by less than the forecast
    walls.push_back(wall);
  }
  MoreauJean stepping({body}, walls, {.h = 0.05, .gravity = Vec3::Zero()});
  Impact impact{.step = {}, .before = stepping.kinetic()};
  impact.step = stepping.step();
  EXPECT_TRUE(impact.step.solved) << impact.step.message;
  return impact;
}

// Impacts without forces create no energy (moreau_jean.hpp): with e = 0 and any friction; frictionless with one e for
// all, where (1 - e) / (1 + e) r'W r / 2 is lost; balls on a plane with any mu, e. Random directions of everything.
TEST(MoreauJean, ImpactsCreateNoEnergyWhereTheLawForbidsIt) {
  std::mt19937 random(2);
  int touched = 0;
  for (int k = 0; k < 300; ++k) {
    const int planes = 1 + k % 3;
    const double e = uniform(random, 0, 1);
    const double mu = uniform(random, 0, 1.5);
    const bool plastic = k % 9 < 3;
    const bool smooth = k % 9 >= 6;
    const Impact impact = plastic  ? random_impact(random, k % 2 == 0, mu, 0, planes)
                          : smooth ? random_impact(random, k % 2 == 0, 0, e, planes)
                                   : random_impact(random, false, mu, e, 1);
    const Energy& energy = impact.step.energy;
    touched += impact.step.touches.empty() ? 0 : 1;
    const double rounding = 1e-7 * impact.before;
    EXPECT_GE(energy.impacts + energy.friction, -rounding) << k;
    if (plastic || smooth) continue;
    EXPECT_GE(energy.impacts, -rounding) << k;
    EXPECT_GE(energy.friction, -rounding) << k;
  }
  EXPECT_GT(touched, 150);
}

// With friction, e > 0 and corners that couple normal and tangential velocities Newton's law can create energy (Kane &
// Levinson 1985). The scheme does as the law says: the statement above has no other case.
TEST(MoreauJean, NewtonsLawWithFrictionMayCreateEnergy) {
  std::mt19937 random(3);
  double gain = 0;
  for (int k = 0; k < 400; ++k) {
    const Impact impact = random_impact(random, true, 0.8, 0.9, 1);
    gain = std::max(gain, -(impact.step.energy.impacts + impact.step.energy.friction) / impact.before);
  }
  EXPECT_GT(gain, 1e-3);
}

// The balance of moreau_jean.hpp, term by term, on balls with gravity, a load, friction, impacts and any theta: what is
// left to the scheme is (theta - 1/2) h F'(v_{k+1} - v_k), not a joule more.
TEST(MoreauJean, EnergyBalanceCloses) {
  std::mt19937 random(4);
  for (const double theta : {0.5, 0.7, 1.0}) {
    const double h = 0.01;
    const auto load = [](std::size_t, double t) { return Vec3(3 * std::cos(t), 2, -std::sin(3 * t)); };
    std::vector<MovingBody> bodies;
    for (int k = 0; k < 3; ++k) {
      bodies.push_back(MovingBody::ball(1 + k, 0.2));
      bodies.back().centre = Vec3(k, 0, 0.2 + 0.3 * k);
      bodies.back().velocity = random_vector(random);
      bodies.back().spin = 5 * random_vector(random);
    }
    MoreauJean stepping(bodies, {{.mu = 0.3, .e = 0.6}, {.point = Vec3(0, 2, 0), .normal = -Vec3::UnitY(), .e = 0.2}},
                        {.h = h, .theta = theta, .load = load});
    for (int k = 0; k < 200; ++k) {
      const std::vector<MovingBody> before = stepping.bodies();
      const double t = stepping.time() + h / 2;
      const Step step = stepping.step();
      ASSERT_TRUE(step.solved);
      double expected = 0;
      for (std::size_t i = 0; i < bodies.size(); ++i)
        expected +=
            (theta - 0.5) * h *
            (bodies[i].mass * Vec3(0, 0, -g) + load(i, t)).dot(stepping.bodies()[i].velocity - before[i].velocity);
      EXPECT_NEAR(step.energy.scheme, expected, 1e-9);
    }
  }
}

// With e = 0, theta = 1 the energy never grows, forces and reversals of slip included: r.u <= 0 at every contact, and
// (theta - 1/2) |v_{k+1} - v_k|^2_M is lost. Frictionless it does not for 1/2 <= theta <= 1 / (1 + e) (Acary, ZAMM 96
// (2016) 585), except where a body that has got into the plane leaves it with U_N < g h: gravity then closes the
// contact in a step that ends with U_N = 0 but moves by (1 - theta) h U_N, and r_N (1 - theta) U_N <= m (g h)^2 / 8 is
// gained.
TEST(MoreauJean, EnergyDoesNotGrow) {
  std::mt19937 random(5);
  const double h = 0.01;
  int exceptions = 0;
  for (int k = 0; k < 30; ++k) {
    const bool rough = k % 2 == 0;
    const double e = rough ? 0 : uniform(random, 0, 1);
    const double theta = rough ? 1 : uniform(random, 0.5, 1 / (1 + e));
    std::vector<Plane> walls{{.mu = rough ? 0.5 : 0, .e = e}};
    walls.push_back({.normal = Vec3(0.6, 0, 0.8), .mu = walls[0].mu, .e = e});
    MovingBody body = MovingBody::ball(1, 0.1);
    body.centre = Vec3(1, 0, 0.5);
    body.velocity = 2 * random_vector(random);
    body.spin = 10 * random_vector(random);
    MoreauJean stepping({body}, walls, {.h = h, .theta = theta});
    double energy = stepping.kinetic() + stepping.potential();
    for (int count = 0; count < 200; ++count) {
      const Vec3 v = stepping.bodies()[0].velocity;
      const Step step = stepping.step();
      ASSERT_TRUE(step.solved);
      const auto leaves = [&](const Touch& touch) {
        const double U_N = walls[touch.plane].normal.dot(v);
        return U_N > 1e-8 && U_N < g * h;
      };
      const bool exception = !rough && std::ranges::any_of(step.touches, leaves);
      exceptions += exception ? 1 : 0;
      const double now = stepping.kinetic() + stepping.potential();
      ASSERT_LE(now, energy + 1e-8 + (exception ? g * g * h * h / 8 : 0)) << "e " << e << ", theta " << theta;
      energy = now;
    }
  }
  EXPECT_LT(exceptions, 100);
}

// A box on its four corners, redundant contacts, on an incline below the angle of friction: it stays, and does not
// turn.
TEST(MoreauJean, BoxRestsOnAnIncline) {
  const Plane plane = incline(0.3, 0.5);
  MovingBody box = MovingBody::box(3, Vec3(0.4, 0.3, 0.2));
  box.attitude = Eigen::AngleAxisd(0.3, Vec3::UnitY()).toRotationMatrix();
  box.centre = 0.1 * plane.normal;
  MoreauJean stepping({box}, {plane}, {});
  for (int k = 0; k < 100; ++k) {
    const Step step = stepping.step();
    ASSERT_TRUE(step.solved) << step.message;
    ASSERT_EQ(step.touches.size(), 4);
  }
  EXPECT_LE((stepping.bodies()[0].centre - box.centre).norm(), 1e-7);
  EXPECT_LE((stepping.bodies()[0].attitude - box.attitude).norm(), 1e-7);
}

// A start near the solution changes the way to it, not the path.
TEST(MoreauJean, WarmStartsChangeNothing) {
  const auto run = [](bool warm) {
    MoreauJean stepping({MovingBody::ball(1, 0.1), ball_on_floor(Vec3(1, 2, 0), true)}, {{.mu = 0.3, .e = 0.5}},
                        {.warm_start = warm});
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(stepping.step().solved);
    return stepping.bodies()[1];
  };
  EXPECT_LE((run(true).centre - run(false).centre).norm(), 1e-8);
}

/// The path of a ball from rest, step by step, under a load of L mu m g from 60, 180 and -60 degrees in turn, 5 s each:
/// (26) of the lecture.
std::vector<Vec3> cyclic_path(double L, double cycles, const FrictionLaw& law = {}, double frame = 0) {
  constexpr double h = 0.05;
  const double mu = 0.3;
  const auto load = [force = L * mu * 2 * g](std::size_t, double t) {
    const double angle = std::array{60, 180, -60}.at(static_cast<std::size_t>(t / 5) % 3) * std::numbers::pi / 180;
    return Vec3(force * std::cos(angle), force * std::sin(angle), 0);
  };
  MoreauJean stepping({ball_on_floor(Vec3::Zero())}, {{.mu = mu, .frame = frame}}, {.h = h, .law = law, .load = load});
  std::vector<Vec3> path{stepping.bodies()[0].centre};
  for (long k = std::lround(15 * cycles / h); k > 0; --k) {
    EXPECT_TRUE(stepping.step().solved) << name(law);
    path.push_back(stepping.bodies()[0].centre);
  }
  return path;
}

double farthest(const std::vector<Vec3>& path, const std::vector<Vec3>& from) {
  double distance = 0;
  for (std::size_t k = 0; k < path.size(); ++k) distance = std::max(distance, (path[k] - from[k]).norm());
  return distance;
}

using enum FrictionLaw::Kind;

// L = 1, as large as friction can be: by Coulomb's law the ball stays. A polygon within the disk lets it go where it
// has no corner: 4 facets let it slide by tens of metres, 6 have corners towards all three loads.
TEST(CyclicLoad, MovesNothingByCoulombsLawAlone) {
  const std::vector<Vec3> exact = cyclic_path(1, 1);
  EXPECT_LE(farthest(exact, std::vector<Vec3>(exact.size(), exact[0])), 1e-7);
  EXPECT_GT(farthest(cyclic_path(1, 1, {Inner, 4}), exact), 10);
  EXPECT_GT(farthest(cyclic_path(1, 1, {Inner, 8}), exact), 1);
  EXPECT_LT(farthest(cyclic_path(1, 1, {Inner, 6}), exact), 1e-6);
  EXPECT_LT(farthest(cyclic_path(1, 1, {Outer, 4}), exact), 1e-6);
}

// The ball slides from rest under L > 1 along the load: x = (L - 1) mu g t^2 / 2. By symmetry the exact path closes,
// and so does one with 6 facets; with 4, 8, 16 the ball drifts for ever: its mean velocity over the last cycle.
TEST(CyclicLoad, ExactPathClosesAndPolygonsDrift) {
  const auto drift = [](const FrictionLaw& law) {
    const std::vector<Vec3> path = cyclic_path(1.5, 5, law);
    return (path.back() - path[path.size() - 301]).norm() / 15;
  };
  const std::vector<Vec3> first = cyclic_path(1.5, 1.0 / 3);
  const Vec3 along(0.5, std::sqrt(3) / 2, 0);
  EXPECT_LE((first.back() - first[0] - 0.5 * 0.5 * 0.3 * g * 25 * along).norm(), 1e-7);
  EXPECT_LT(drift({}), 1e-4);
  EXPECT_LT(drift({Inner, 6}), 1e-4);
  EXPECT_GT(drift({Inner, 4}), 1);
  EXPECT_GT(drift({Inner, 8}), 0.3);
  EXPECT_GT(drift({Inner, 16}), 0.1);
  EXPECT_GT(drift({Outer, 8}), 0.3);
}

// The frame (T1, T2) is a convention: Coulomb's law gives the same path in any, a polygon turns with it.
TEST(CyclicLoad, FrameMeansNothingToTheExactLaw) {
  for (const double frame : {0.2, 2.0}) {
    EXPECT_LE(farthest(cyclic_path(1.3, 1, {}, frame), cyclic_path(1.3, 1)), 1e-6) << frame;
    EXPECT_GE(farthest(cyclic_path(1.3, 1, {Inner, 8}, frame), cyclic_path(1.3, 1, {Inner, 8})), 1) << frame;
  }
}

TEST(MoreauJean, RefusesWhatIsNoScene) {
  const MovingBody ball = MovingBody::ball(1, 0.1);
  const auto refused = [&](const MovingBody& body, const Plane& plane, const SteppingOptions& options) {
    EXPECT_THROW(MoreauJean({body}, {plane}, options), std::invalid_argument);
  };
  EXPECT_NO_THROW(MoreauJean({ball}, {Plane{}}, {}));
  MovingBody bad = ball;
  bad.mass = -1;
  refused(bad, {}, {});
  bad = ball;
  bad.attitude = -Mat3::Identity();
  refused(bad, {}, {});
  bad = ball;
  bad.knobs[0].radius = std::nan("");
  refused(bad, {}, {});
  bad = ball;
  bad.turns = false;
  bad.spin = Vec3::UnitX();
  refused(bad, {}, {});
  refused(ball, {.normal = Vec3(0, 0, 2)}, {});
  refused(ball, {.mu = -0.1}, {});
  refused(ball, {.e = 1.5}, {});
  refused(ball, {}, {.h = 0});
  refused(ball, {}, {.theta = 0.4});
  refused(ball, {}, {.law = {FrictionLaw::Kind::Inner, 2}});
  MoreauJean stepping({ball}, {Plane{}}, {.load = [](std::size_t, double) { return Vec3(std::nan(""), 0, 0); }});
  EXPECT_THROW(stepping.step(), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact
