// SPDX-License-Identifier: Apache-2.0
/// Derivatives of contact solutions. Source of most values: differences of solutions of neighbouring problems, at
/// planted solutions (r and u chosen in every region, q = u - W r), which share nothing with the linear systems tested.
#include "contact/solvers/sensitivity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "contact/contact_support.hpp"
#include "contact/refusal.hpp"
#include "contact/scenes/rigid_bodies.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;
using testing::HasSubstr;

struct Planted {
  Problem problem{};
  Vec r{};
  std::vector<Region> regions{};
};

Vec direction(int width, Random& random) {
  const Vec n = random.normals(width);
  return n / n.norm();
}

/// Contacts in these regions; W = A A' / (2 rows) + I / 2, not symmetric to 5 % where `skew`.
Planted planted(int d, const std::vector<Region>& regions, Random& random, bool skew = false, bool rolls = false) {
  const auto n = static_cast<Index>(regions.size());
  const Dense A = random.normals(d * n, 2 * d * n);
  Dense W = A * A.transpose() / static_cast<double>(4 * d * n) + 0.5 * Dense::Identity(d * n, d * n);
  if (skew) W += 0.05 / static_cast<double>(n) * random.normals(d * n, d * n);
  Planted out{
      .problem = {.dimension = d, .W = sparse(W), .q = {}, .mu = Vec(n)}, .r = Vec::Zero(d * n), .regions = regions};
  if (rolls) out.problem.mu_r = Vec(n);
  const int width = out.problem.disk_width();
  Vec u = Vec::Zero(d * n);
  for (Index a = 0; a < n; ++a) {
    const Region region = regions[static_cast<std::size_t>(a)];
    const bool open = region == Region::Open;
    const double r_N = open || region == Region::Touching ? 0 : random.uniform(0.5, 2);
    out.r[d * a] = r_N;
    u[d * a] = open ? random.uniform(0.5, 2) : 0;
    for (int j = 0; j < (rolls ? 2 : 1); ++j) {
      double& mu = (j == 0 ? out.problem.mu : out.problem.mu_r)[a];
      mu = random.uniform(0.1, 0.7);
      const auto part = Eigen::seqN(d * a + 1 + j * width, width);
      const Vec t = direction(width, random);
      // The second disk is in a region of its own.
      const bool slips = j == 0 ? region == Region::Slip : random.chance(0.5);
      if (j == 0 && region == Region::Edge) {
        out.r(part) = mu * r_N * t;
      } else if (open || slips || (region == Region::Touching && random.chance(0.5))) {
        u(part) = random.uniform(0.5, 2) * t;
        out.r(part) = -mu * r_N * t;
      } else {
        out.r(part) = random.uniform(0, 0.9) * mu * r_N * t;
      }
    }
  }
  out.problem.q = u - W * out.r;
  return out;
}

ParameterDerivatives random_parameters(const Problem& problem, Random& random) {
  const Index all = problem.q.size();
  const Index n = problem.contacts();
  ParameterDerivatives out;
  out.dq = sparse(random.normals(all, 1));
  out.dmu = sparse(0.3 * random.normals(n, 1));
  if (problem.rolls()) out.dmu_r = sparse(0.3 * random.normals(n, 1));
  out.dW = {sparse(0.1 * random.normals(all, all))};
  return out;
}

/// The problem at p + s dp of one parameter.
Problem moved(const Problem& at, const ParameterDerivatives& parameters, double s) {
  Problem out = at;
  if (parameters.dq.size() > 0) out.q += s * Vec(parameters.dq.col(0));
  if (parameters.dmu.size() > 0) out.mu += s * Vec(parameters.dmu.col(0));
  if (parameters.dmu_r.size() > 0) out.mu_r += s * Vec(parameters.dmu_r.col(0));
  if (!parameters.dW.empty()) out.W = SpMat(at.W.matrix() + s * parameters.dW[0]);
  return out;
}

/// r and u of the problem at p + s dp, near `start`.
std::optional<Solution> solved_at(const Problem& at, const ParameterDerivatives& parameters, double s,
                                  const Vec& start) {
  const Problem there = moved(at, parameters, s);
  const Result result = solve(there, {.tol = 1e-12, .start = start});
  EXPECT_TRUE(result.solved()) << result.message;
  if (!result.solved()) return {};
  return Solution{.r = result.solution.r, .u = velocities(there, result.solution.r)};
}

double size(const Sensitivity& s) { return std::max({1.0, s.dr.cwiseAbs().maxCoeff(), s.du.cwiseAbs().maxCoeff()}); }

void expect_central_differences(const Problem& problem, const Vec& r, const ParameterDerivatives& parameters,
                                const Sensitivity& s) {
  const double h = 1e-5 / size(s);
  const auto up = solved_at(problem, parameters, h, r);
  const auto down = solved_at(problem, parameters, -h, r);
  if (!up || !down) return;
  EXPECT_LE((s.dr.col(0) - (up->r - down->r) / (2 * h)).lpNorm<Eigen::Infinity>(), 2e-6 * size(s));
  EXPECT_LE((s.du.col(0) - (up->u - down->u) / (2 * h)).lpNorm<Eigen::Infinity>(), 2e-6 * size(s));
}

/// One-sided ones of second order.
void expect_one_sided_differences(const Problem& problem, const Vec& r, const ParameterDerivatives& parameters,
                                  const Sensitivity& s) {
  const double h = 1e-4 / size(s);
  const Vec u = velocities(problem, r);
  const auto half = solved_at(problem, parameters, h / 2, r);
  const auto whole = solved_at(problem, parameters, h, r);
  if (!half || !whole) return;
  const Vec dr = (4 * half->r - whole->r - 3 * r) / h;
  const Vec du = (4 * half->u - whole->u - 3 * u) / h;
  EXPECT_LE((s.dr.col(0) - dr).lpNorm<Eigen::Infinity>(), 1e-5 * size(s));
  EXPECT_LE((s.du.col(0) - du).lpNorm<Eigen::Infinity>(), 1e-5 * size(s));
}

constexpr std::array smooth{Region::Open, Region::Stick, Region::Slip};

// More than 1,000 contacts in each region without a kink, alone and up to 9 together, in 2D and 3D, W symmetric or not:
// the derivative in a random direction of q, mu and W. Catches wrong signs, a forgotten turn of slip, transposed W.
TEST(ContactSensitivity, MatchesCentralDifferencesInEveryRegion) {
  Random random(11);
  std::map<Region, int> contacts;
  for (const int d : {2, 3})
    for (int k = 0; k < 520; ++k) {
      std::vector<Region> regions;
      for (int a = 0; a < (k % 2 == 0 ? 1 : 2 + k % 8); ++a)
        regions.push_back(smooth[static_cast<std::size_t>(random.uniform(0, 3))]);
      const auto [problem, r, expected] = planted(d, regions, random, k % 3 == 0);
      const ParameterDerivatives parameters = random_parameters(problem, random);
      const Sensitivity s = sensitivity(problem, r, parameters);
      ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
      EXPECT_EQ(s.regions, expected);
      EXPECT_TRUE(s.strongly_regular && s.degenerate.empty());
      expect_central_differences(problem, r, parameters, s);
      for (const Region region : regions) ++contacts[region];
    }
  for (const Region region : smooth) EXPECT_GE(contacts[region], 1000);
}

constexpr std::array every_region{Region::Open, Region::Stick, Region::Slip, Region::Touching, Region::Edge};

// More than 1,000 contacts at each kink, alone and beside others, up to 6 together, in 2D and 3D, from both sides.
// Catches a wrong critical cone, S with a wrong sign, and a one-sided derivative that is called a derivative. Known
// must be nine of ten at least: friction is moderate.
TEST(ContactSensitivity, MatchesOneSidedDifferencesAtKinks) {
  Random random(13);
  std::map<Region, int> contacts;
  int known = 0;
  int asked = 0;
  for (const int d : {2, 3})
    for (int k = 0; k < 640; ++k) {
      std::vector<Region> regions{k % 4 < 2 ? Region::Touching : Region::Edge};
      for (int a = 1; a < (k % 2 == 0 ? 1 : 2 + k % 5); ++a)
        regions.push_back(every_region[static_cast<std::size_t>(random.uniform(0, 5))]);
      const auto [problem, r, expected] = planted(d, regions, random, k % 5 == 0);
      const ParameterDerivatives parameters = random_parameters(problem, random);
      EXPECT_EQ(sensitivity(problem, r, parameters).status, SensitivityStatus::Degenerate);
      for (const double side : {1.0, -1.0}) {
        const Sensitivity s = sensitivity(problem, r, parameters, vec({side}));
        EXPECT_EQ(s.regions, expected);
        EXPECT_FALSE(s.degenerate.empty());
        ++asked;
        if (!s.known()) continue;
        ++known;
        EXPECT_EQ(s.status, SensitivityStatus::Directional);
        ParameterDerivatives sided = parameters;
        sided.dq *= side;
        sided.dmu *= side;
        sided.dW[0] *= side;
        expect_one_sided_differences(problem, r, sided, s);
      }
      for (const Region region : regions) ++contacts[region];
    }
  EXPECT_EQ(known, asked);
  EXPECT_GE(contacts[Region::Touching], 1000);
  EXPECT_GE(contacts[Region::Edge], 1000);
}

// As above, with a second disk of rolling friction in a region of its own, 5 entries a contact in 3D and 3 in 2D.
// Catches disks that are mixed up, and mu_r that is taken for mu.
TEST(ContactSensitivity, RollingMatchesDifferences) {
  Random random(17);
  int smooth_ones = 0;
  int kinks = 0;
  for (const int d : {3, 5})
    for (int k = 0; k < 40; ++k) {
      std::vector<Region> regions;
      for (int a = 0; a < 1 + k % 3; ++a)
        regions.push_back(k % 2 == 0 ? smooth[static_cast<std::size_t>(random.uniform(0, 3))]
                                     : every_region[static_cast<std::size_t>(random.uniform(0, 5))]);
      const auto [problem, r, expected] = planted(d, regions, random, false, true);
      const ParameterDerivatives parameters = random_parameters(problem, random);
      const Sensitivity s = sensitivity(problem, r, parameters, vec({1}));
      if (!s.known()) continue;
      if (s.status == SensitivityStatus::Differentiable) {
        expect_central_differences(problem, r, parameters, s);
        ++smooth_ones;
      } else {
        expect_one_sided_differences(problem, r, parameters, s);
        ++kinks;
      }
    }
  EXPECT_GE(smooth_ones, 40);
  EXPECT_GE(kinks, 15);
}

/// One contact with the 2 x 2 or 3 x 3 W of these rows.
Problem contact(std::initializer_list<std::initializer_list<double>> W, const Vec& q, double mu) {
  Problem out{.dimension = static_cast<int>(q.size()), .W = support::matrix(W), .q = q, .mu = vec({mu})};
  return out;
}

// A block of 2 kg arrives with -3 m/s and slides with u_T: r_N = 6, and with mu = 0.1, in closed form,
// r_T = -0.6 t, u_T = q_T - 0.3 t, along q_T = (3, 4) / 5 * 1.5. A change of q_N by 1 changes r_N by -2, and the slip
// along t by mu; one of mu the slip by -3; one across t turns the impulse by 0.6 / 1.5. Catches any missing term.
TEST(ContactSensitivity, SlidingBlockIsTheClosedForm) {
  const Problem problem = contact({{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}, vec({-3, 0.9, 1.2}), 0.1);
  const Vec t = vec({0.6, 0.8});
  const Vec n = vec({-0.8, 0.6});
  const Vec r = vec({6, -0.36, -0.48});
  const Sensitivity s = sensitivity(problem, r, by_q_and_mu(problem));
  ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
  EXPECT_EQ(s.regions, std::vector<Region>{Region::Slip});
  EXPECT_LE((s.dr.col(0) - vec({-2, 0.2 * 0.6, 0.2 * 0.8})).norm(), 1e-12);
  EXPECT_LE((s.du.col(0) - vec({0, 0.1 * 0.6, 0.1 * 0.8})).norm(), 1e-12);
  EXPECT_LE((s.dr.col(3) - vec({0, -3.6, -4.8})).norm(), 1e-12);  // r_N = 6, along t
  EXPECT_LE((s.du.col(3) - vec({0, -1.8, -2.4})).norm(), 1e-12);
  EXPECT_LE(((s.dr.bottomRightCorner(2, 3).leftCols(2) * t)).norm(), 1e-12);
  EXPECT_LE((s.dr.bottomRightCorner(2, 3).leftCols(2) * n + 0.6 / 1.5 * n).norm(), 1e-12);
}

// mu = 1e8: it slips, with an impulse that presses 1e-8 of the one that brakes. Would catch a normal impulse that is
// measured by friction and taken for none.
TEST(ContactSensitivity, LargeFrictionPressesLittle) {
  const Problem problem = contact({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, vec({-1e-7, 11, 0}), 1e8);
  const Sensitivity s = sensitivity(problem, vec({1e-7, -10, 0}), by_q_and_mu(problem));
  ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
  EXPECT_EQ(s.regions, std::vector<Region>{Region::Slip});
  EXPECT_LE((s.dr.col(0) - vec({-1, 1e8, 0})).norm(), 1e-4);
}

// u_N = max(q_N, 0), r_N = max(-q_N, 0) / W_NN of a contact that touches and slips; and without slip, at the cone's
// point, where the derivative is Coulomb's law itself: a push below mu sticks, one above slips.
TEST(ContactSensitivity, TouchingContactsInClosedForm) {
  const Problem slips = contact({{0.5, 0}, {0, 1}}, vec({0, 1}), 0.5);
  const ParameterDerivatives by_q{.dq = sparse(Dense::Identity(2, 2))};
  const Sensitivity both = sensitivity(slips, vec({0, 0}), by_q);
  EXPECT_EQ(both.status, SensitivityStatus::Degenerate);
  EXPECT_THAT(both.message, HasSubstr("contact 0 is at a kink"));
  EXPECT_EQ(both.dr.size(), 0);
  const Sensitivity closes = sensitivity(slips, vec({0, 0}), by_q, vec({-1, 0}));
  ASSERT_EQ(closes.status, SensitivityStatus::Directional) << closes.message;
  EXPECT_LE((closes.dr.col(0) - vec({2, -1})).norm(), 1e-12);
  EXPECT_LE((closes.du.col(0) - vec({0, -1})).norm(), 1e-12);
  const Sensitivity opens = sensitivity(slips, vec({0, 0}), by_q, vec({1, 0}));
  EXPECT_LE(opens.dr.norm(), 1e-12);
  EXPECT_LE((opens.du.col(0) - vec({1, 0})).norm(), 1e-12);
  const Problem rests = contact({{1, 0}, {0, 1}}, vec({0, 0}), 0.5);
  const Sensitivity sticks = sensitivity(rests, vec({0, 0}), by_q, vec({-1, 0.3}));
  ASSERT_EQ(sticks.status, SensitivityStatus::Directional) << sticks.message;
  EXPECT_LE((sticks.dr.col(0) - vec({1, -0.3})).norm(), 1e-9);
  const Sensitivity slides = sensitivity(rests, vec({0, 0}), by_q, vec({-1, 0.9}));
  EXPECT_LE((slides.du.col(0) - vec({0, 0.4})).norm(), 1e-9);
}

// mu = 0. Where it slips, r_T = -dmu r_N t. Where it rests, q does not see the friction that is not there; friction
// that grows holds a push as large as dmu r_N, and slips under more, in 2D and 3D; it cannot fall. Catches 0 / 0, and a
// cone whose edge is at its axis.
TEST(ContactSensitivity, WithoutFriction) {
  Random random(19);
  for (const int d : {2, 3}) {
    Vec q = Vec::Zero(d);
    q[0] = -2;
    Problem problem{.dimension = d, .W = sparse(Dense::Identity(d, d)), .q = q, .mu = vec({0})};
    Vec r = Vec::Zero(d);
    r[0] = 2;
    const Sensitivity by_q = sensitivity(problem, r, {.dq = sparse(Dense::Identity(d, d))});
    ASSERT_EQ(by_q.status, SensitivityStatus::Differentiable) << by_q.message;
    EXPECT_DOUBLE_EQ(by_q.dr(0, 0), -1);
    EXPECT_DOUBLE_EQ(by_q.du(1, 1), 1);
    EXPECT_EQ(sensitivity(problem, r, by_q_and_mu(problem)).status, SensitivityStatus::Degenerate);
    for (const double push : {1.0, 3.0}) {
      Vec dp = Vec::Zero(d + 1);
      dp[1] = push;
      dp[d] = 1;
      const Sensitivity grows = sensitivity(problem, r, by_q_and_mu(problem), dp);
      ASSERT_EQ(grows.status, SensitivityStatus::Directional) << grows.message;
      EXPECT_NEAR(grows.dr(1, 0), -std::min(push, 2.0), 1e-9);
      EXPECT_NEAR(grows.du(1, 0), push - std::min(push, 2.0), 1e-9);
      EXPECT_THROW(sensitivity(problem, r, by_q_and_mu(problem), -dp), std::invalid_argument);
    }
    problem.q[d - 1] = -1.5;
    const Sensitivity slips = sensitivity(problem, r, by_q_and_mu(problem));
    ASSERT_EQ(slips.status, SensitivityStatus::Differentiable) << slips.message;
    EXPECT_DOUBLE_EQ(slips.dr(d - 1, d), 2);
    EXPECT_EQ(slips.regions, std::vector<Region>{Region::Slip});
  }
}

// A box on four feet: one of four normal impulses is not determined. Catches numbers from a singular W; the message
// names the feet, and not the fifth contact, of another body.
TEST(ContactSensitivity, RefusesImpulsesThatAreNotUniqueWithNames) {
  RigidBodies bodies;
  const auto box = bodies.add({.mass = 2, .inertia = RigidBodies::box_inertia(2, {1, 1, 1}), .centre = {0, 0, 0.5}});
  const auto ball = bodies.add({.mass = 1, .inertia = RigidBodies::sphere_inertia(1, 0.5), .centre = {5, 0, 0.5}});
  bodies.touch({.a = ball, .point = {5, 0, 0}});
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5}) bodies.touch({.a = box, .point = {x, y, 0}});
  const Problem problem = condense(bodies.global(0.01, {0, 0, -9.81}), bodies.mu());
  const Result solved = solve(problem);
  ASSERT_TRUE(solved.solved());
  const Sensitivity s = sensitivity(problem, solved.solution.r, by_q_and_mu(problem));
  EXPECT_EQ(s.status, SensitivityStatus::Singular);
  EXPECT_THAT(s.message, HasSubstr("contacts 1, 2, 3 and 4 can change together"));
  EXPECT_EQ(s.dr.size(), 0);
}

// Painleve's contact: W_NT so large that r_N of a contact that slips presses it down, S = W_NN - mu W_NT = -0.5. There
// are two solutions one way and none the other. And at rest, where friction is too large for a proof.
TEST(ContactSensitivity, RefusesWherePathsBranchOrEnd) {
  const Problem slips = contact({{1, 1}, {1, 2}}, vec({0, 1}), 1.5);
  const ParameterDerivatives by_q{.dq = sparse(Dense::Identity(2, 2))};
  const Sensitivity opens = sensitivity(slips, vec({0, 0}), by_q, vec({1, 0}));
  EXPECT_EQ(opens.status, SensitivityStatus::Degenerate);
  EXPECT_THAT(opens.message, HasSubstr("2 solutions"));
  const Sensitivity closes = sensitivity(slips, vec({0, 0}), by_q, vec({-1, 0}));
  EXPECT_EQ(closes.status, SensitivityStatus::Degenerate);
  EXPECT_THAT(closes.message, HasSubstr("vanish or jump"));
  const Problem rests = contact({{1, 1}, {1, 2}}, vec({0, 0}), 1.5);
  const Sensitivity s = sensitivity(rests, vec({0, 0}), by_q, vec({-1, 0}));
  EXPECT_EQ(s.status, SensitivityStatus::Degenerate);
  EXPECT_THAT(s.message, HasSubstr("too large"));
  EXPECT_FALSE(s.strongly_regular);
}

// One contact at rest with W = I has one derivative for mu < 2; two with W_NN = (1 0.9; 0.9 1), W_TT = I by the same
// inequality for mu < c / 5 = 0.459, c^2 = 1 / 0.19: the least eigenvalue of W_NN is 0.1. Catches a proof that takes
// more than the inequality gives, in slip or in the normal parts.
TEST(ContactSensitivity, ClaimsOneDerivativeAtRestNoFartherThanItIsProven) {
  for (const double mu : {1.99, 2.01}) {
    const Problem one = contact({{1, 0}, {0, 1}}, vec({0, 0}), mu);
    const Sensitivity s = sensitivity(one, vec({0, 0}), {.dq = sparse(Dense::Identity(2, 2))}, vec({-1, 0.3}));
    EXPECT_EQ(s.strongly_regular, mu < 2) << mu;
    EXPECT_EQ(s.known(), mu < 2) << mu;
  }
  for (const double mu : {0.45, 0.47}) {
    Problem two = contact({{1, 0, 0.9, 0}, {0, 1, 0, 0}, {0.9, 0, 1, 0}, {0, 0, 0, 1}}, Vec::Zero(4), mu);
    two.dimension = 2;
    two.mu = vec({mu, mu});
    const Sensitivity s =
        sensitivity(two, Vec::Zero(4), {.dq = sparse(Dense::Identity(4, 4))}, vec({-1, 0.3, -0.5, 0.1}));
    EXPECT_EQ(s.strongly_regular, mu < 0.459) << mu;
    EXPECT_EQ(s.known(), mu < 0.459) << mu;
  }
}

// Thirty pairs of balls that touch each other and a floor, with random velocities: W by its parts, M and H. The whole
// Jacobian by q and mu, beside central differences in a direction of both. Catches what small dense W hide: an order of
// contacts, and a W that nobody formed.
TEST(ContactSensitivity, PairsOfBallsByQAndMu) {
  Random random(23);
  RigidBodies bodies;
  for (int k = 0; k < 30; ++k) {
    const auto ball = [&](double x) {
      return bodies.add({.mass = 1,
                         .inertia = RigidBodies::sphere_inertia(1, 0.5),
                         .centre = {x, 0, 0.5},
                         .velocity = random.normals(3),
                         .spin = random.normals(3)});
    };
    const double x = 3.0 * k;
    const Index left = ball(x);
    const Index right = ball(x + 1);
    bodies.touch({.a = left, .point = {x, 0, 0}, .mu = 0.3});
    bodies.touch({.a = right, .point = {x + 1, 0, 0}, .mu = 0.3});
    bodies.touch({.a = right, .b = left, .point = {x + 0.5, 0, 0.5}, .normal = Vec3::UnitX(), .mu = 0.3});
  }
  const Problem problem = condense(bodies.global(0.01, {0, 0, -9.81}), bodies.mu());
  const Result solved = solve(problem, {.tol = 1e-12});
  ASSERT_TRUE(solved.solved()) << solved.message;
  const Vec& r = solved.solution.r;
  const Sensitivity s = sensitivity(problem, r, by_q_and_mu(problem));
  ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
  for (const Region region : smooth) EXPECT_GE(std::ranges::count(s.regions, region), 5);
  const Vec dp = random.normals(s.dr.cols());
  const ParameterDerivatives parameters{.dq = sparse(dp.head(problem.q.size())),
                                        .dmu = sparse(0.1 * dp.tail(problem.contacts()))};
  Vec direction_of_p = dp;
  direction_of_p.tail(problem.contacts()) *= 0.1;
  Sensitivity along = s;
  along.dr = s.dr * direction_of_p;
  along.du = s.du * direction_of_p;
  expect_central_differences(problem, r, parameters, along);
}

TEST(ContactSensitivity, RefusesWhatIsNoSolutionAndMalformedInput) {
  const Problem problem = contact({{1, 0}, {0, 1}}, vec({-1, 0.1}), 0.5);
  const Vec r = vec({1, -0.1});
  const Sensitivity s = sensitivity(problem, vec({2, 0}), by_q_and_mu(problem));
  EXPECT_EQ(s.status, SensitivityStatus::NotASolution);
  EXPECT_THAT(s.message, HasSubstr("worst at contact 0"));
  EXPECT_TRUE(s.regions.empty());
  const auto refused = [&](const ParameterDerivatives& p, const SensitivityOptions& o, const char* why) {
    EXPECT_THAT(test::refusal_of([&] { sensitivity(problem, r, p, o); }), HasSubstr(why));
  };
  const SpMat dq = sparse(Dense::Identity(2, 2));
  refused({}, {}, "no parameters");
  refused({.dq = sparse(Dense::Ones(3, 1))}, {}, "dq has 3 rows");
  refused({.dq = dq, .dmu = sparse(Dense::Ones(1, 1))}, {}, "dmu is of 1 parameters");
  refused({.dW = {sparse(Dense::Ones(1, 1))}}, {}, "dW is 1 x 1");
  refused({.dq = sparse(Dense::Constant(2, 1, support::nan))}, {}, "dq(0, 0) is nan");
  refused({.dq = dq}, {.residual_tol = 0}, "residual_tol is 0");
  refused({.dq = dq}, {.degenerate_tol = -1}, "degenerate_tol is -1");
  refused({.dq = dq}, {.singular_rcond = 1}, "singular_rcond is 1");
  EXPECT_THROW(sensitivity(problem, vec({1}), {.dq = dq}), std::invalid_argument);
  EXPECT_THROW(sensitivity(problem, r, {.dq = dq}, vec({1})), std::invalid_argument);
  const Problem touching = contact({{1, 0}, {0, 1}}, vec({0, 0}), 0.5);
  EXPECT_EQ(sensitivity(touching, vec({0, 0}), {.dq = dq}, vec({1, 0}), {.max_degenerate = 1}).status,
            SensitivityStatus::TooLarge);
}

}  // namespace
}  // namespace perp::contact
