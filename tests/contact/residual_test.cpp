#include "contact/residual.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "contact/contact_support.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;
using testing::HasSubstr;

constexpr double rounding = 4e-15;

/// One point mass of 2 kg: W = 1/2, e_N and e_T independent.
Problem point(const Vec& q, double mu) {
  Problem p;
  p.dimension = static_cast<int>(q.size());
  p.W = sparse(0.5 * Dense::Identity(q.size(), q.size()));
  p.q = q;
  p.mu = vec({mu});
  return p;
}

/// W = B B' of rank `rank`, q such that a solution exists: q = -W r0 + something in K*.
Problem random_problem(Random& random, int d, Index n) {
  const Dense B = random.normals(d * n, random.integer(1, static_cast<int>(d * n)));
  Problem p;
  p.dimension = d;
  p.W = sparse(B * B.transpose());
  p.q = random.normals(d * n);
  p.mu = random.normals(n).cwiseAbs();
  return p;
}

State state(const Problem& p, const Vec& r) { return states(p, r).at(0).state; }

void expect_solution(const Problem& p, const Vec& r) {
  const Residual e = residual(p, r);
  EXPECT_LE(e.natural, rounding);
  EXPECT_LE(e.scaled, rounding);
  EXPECT_LE(e.cone, rounding);
  EXPECT_LE(e.normal, rounding);
  EXPECT_LE(e.slip, rounding);
}

// --- closed forms: the 2 kg mass arrives with q ----------------------------------------------------------------------

// It leaves: r = 0. Catches a missing mu |u_T| (then the normal part would still vanish, but the tangential not).
TEST(Residual, Open) {
  const Problem p = point(vec({1, 2, -3}), 0.4);
  expect_solution(p, Vec::Zero(3));
  EXPECT_EQ(state(p, Vec::Zero(3)), State::Open);
  EXPECT_EQ(states(p, Vec::Zero(3))[0].margin, 1);
}

// r = -2 q stops it; |r_T| = 2 <= mu r_N = 2.4. The margin is what friction has left.
TEST(Residual, Stick) {
  const Problem p = point(vec({-3, 0.6, -0.8}), 0.4);
  const Vec r = vec({6, -1.2, 1.6});
  expect_solution(p, r);
  EXPECT_EQ(state(p, r), State::Stick);
  EXPECT_NEAR(states(p, r)[0].margin, 0.4, 1e-15);
}

// r_N = 6, r_T = -mu r_N q_T / |q_T|, u_T = q_T + r_T / 2 = (1 - 0.1 * 6 / 2 / 5) q_T. Catches an associated law, for
// which u_N would be mu |u_T|.
TEST(Residual, Slip) {
  const Problem p = point(vec({-3, 3, -4}), 0.1);
  const Vec r = vec({6, -0.36, 0.48});
  expect_solution(p, r);
  EXPECT_EQ(state(p, r), State::Slip);
  EXPECT_NEAR(states(p, r)[0].margin, 5 - 0.3, 1e-15);
}

TEST(Residual, TwoDimensions) {
  expect_solution(point(vec({1, 2}), 0.4), vec({0, 0}));
  expect_solution(point(vec({-3, 1}), 0.4), vec({6, -2}));
  const Problem slips = point(vec({-3, -4}), 0.1);
  expect_solution(slips, vec({6, 0.6}));
  EXPECT_EQ(state(slips, vec({6, 0.6})), State::Slip);
  EXPECT_GT(residual(slips, vec({6, -0.6})).scaled, 0.1);  // friction that pushes
}

// mu = 0: friction is nothing, and sliding costs nothing.
TEST(Residual, Frictionless) {
  const Problem p = point(vec({-3, 3, -4}), 0);
  expect_solution(p, vec({6, 0, 0}));
  EXPECT_EQ(state(p, vec({6, 0, 0})), State::Slip);
  EXPECT_GT(residual(p, vec({6, 0.1, 0})).cone, 0.09);
}

// --- points that are no solutions, each wrong in one thing -----------------------------------------------------------

// Each is what a solver without the last step of the law would return; each part of the judge must see its own.
TEST(Residual, NonSolutions) {
  const Problem slip = point(vec({-3, 3, -4}), 0.1);
  // The maximal friction, but not opposite to the slip: only `slip` sees it.
  const Residual turned = residual(slip, vec({6, -0.48, 0.36}));
  EXPECT_LE(turned.cone, 1e-15);
  EXPECT_LE(turned.normal, 1e-15);
  EXPECT_GT(turned.slip, 0.05);
  EXPECT_GT(turned.natural, 0.05);
  // Too little friction.
  EXPECT_GT(residual(slip, vec({6, -0.18, 0.24})).slip, 0.1);
  EXPECT_GT(residual(slip, vec({6, -0.18, 0.24})).scaled, 0.01);
  // The associated (convex) law: r_N larger, so that u_N = mu |u_T|.
  const Residual associated = residual(slip, vec({7, -0.42, 0.56}));
  EXPECT_NEAR(associated.normal, 1, 1e-15);
  EXPECT_GT(associated.scaled, 0.05);
  // A pull.
  const Residual pull = residual(point(vec({1, 2, -3}), 0.4), vec({-2, 0, 0}));
  EXPECT_EQ(pull.cone, 2);
  EXPECT_GT(pull.scaled, 0.1);
  // Penetration.
  EXPECT_GT(residual(slip, Vec::Zero(3)).scaled, 0.1);
}

/// The law as it is written, row by row.
bool keeps_the_law(const Problem& p, const Vec& r, double tol) {
  const Vec u = p.W * r + p.q;
  for (Index a = 0; a < p.contacts(); ++a) {
    const Vec ra = r.segment(p.dimension * a, p.dimension);
    const Vec ua = u.segment(p.dimension * a, p.dimension);
    const double slip = ua.tail(p.dimension - 1).norm();
    if (ra.tail(p.dimension - 1).norm() > p.mu[a] * ra[0] + tol || ra[0] < -tol || ua[0] < -tol ||
        std::abs(ra[0] * ua[0]) > tol ||
        std::abs(ra.tail(p.dimension - 1).dot(ua.tail(p.dimension - 1)) + p.mu[a] * ra[0] * slip) > tol)
      return false;
  }
  return true;
}

// The residual vanishes where the law holds and only there. Catches a map with other zeros, e.g. of the convex law.
TEST(Residual, VanishesWhereTheLawHolds) {
  Random random(5);
  int solutions = 0;
  for (int k = 0; k < 2000; ++k) {
    const Problem p = random_problem(random, random.chance(0.5) ? 2 : 3, random.integer(1, 3));
    const Index d = p.dimension;
    Vec r = random.normals(p.q.size());
    if (random.chance(0.7))
      for (Index a = 0; a < p.contacts(); ++a)
        project_onto_cone(Vec(r.segment(d * a, d)), p.mu[a], r.segment(d * a, d));
    const Residual e = residual(p, r);
    if (keeps_the_law(p, r, 1e-9)) {  // everything open, by chance
      ++solutions;
      EXPECT_LE(e.natural, 1e-7);
    } else {
      EXPECT_GT(e.natural, 1e-11);
      EXPECT_GT(e.scaled, 1e-13);
      EXPECT_GT(e.cone + e.normal + e.slip, 1e-11);
    }
  }
  EXPECT_GT(solutions, 20);
  EXPECT_LT(solutions, 1000);
}

// The worst contact is the one moved away from a solution of three independent masses.
TEST(Residual, NamesTheWorstContact) {
  Problem p;
  p.W = sparse(Dense::Identity(9, 9));
  p.q = vec({-1, 0, 0, -1, 0, 0, -1, 0, 0});
  p.mu = vec({0.5, 0.5, 0.5});
  Vec r = vec({1, 0, 0, 1, 0, 0, 1, 0, 0});
  r[3] += 0.2;
  r[6] += 0.1;
  EXPECT_EQ(residual(p, r).worst, 1);
  p.W = SpMat(0, 0);
  p.q = p.mu = Vec(0);
  EXPECT_EQ(residual(p, Vec(0)).worst, -1);
  EXPECT_EQ(residual(p, Vec(0)).siconos, 0);
}

// In other units of impulse and velocity (r -> a r, u -> b u) `scaled` is the same to rounding at any point. siconos is
// not, which is why there is scaled: 1000 times the mass can hide a wrong point behind rho = 1.
TEST(Residual, ScaledIsFreeOfUnits) {
  Random random(6);
  for (int k = 0; k < 200; ++k) {
    const Problem p = random_problem(random, random.chance(0.5) ? 2 : 3, random.integer(1, 4));
    const Vec r = random.normals(p.q.size());
    const double a = std::exp(random.uniform(-20, 20));
    const double b = std::exp(random.uniform(-20, 20));
    Problem other = p;
    other.W = p.W * (b / a);
    other.q = p.q * b;
    const Residual e = residual(p, r);
    const Residual f = residual(other, a * r);
    EXPECT_NEAR(f.scaled, e.scaled, 1e-12 * e.scaled);
    EXPECT_EQ(f.worst, e.worst);
    EXPECT_NEAR(f.cone, a * e.cone, 1e-12 * a * e.cone);
    EXPECT_NEAR(f.normal, a * e.normal, 1e-12 * a * e.normal);
  }
}

// Numbers whose squares overflow, and what overflows itself, are never taken for a solution.
TEST(Residual, LargeNumbers) {
  Problem p = point(vec({-3e200, 3e200, -4e200}), 0.1);
  EXPECT_LE(residual(p, vec({6e200, -0.36e200, 0.48e200})).siconos, 1e-15);
  EXPECT_GT(residual(p, vec({6e200, 0.36e200, 0.48e200})).siconos, 0.01);
  p.W = sparse(Dense::Constant(3, 3, 1e300));
  const Residual e = residual(p, vec({1e300, -1e300, 0}));
  EXPECT_EQ(e.natural, lcp::infinity);
  EXPECT_EQ(e.siconos, lcp::infinity);
  EXPECT_EQ(e.scaled, lcp::infinity);
}

TEST(Residual, RefusesBadImpulses) {
  const Problem p = point(vec({1, 2, -3}), 0.4);
  EXPECT_THAT(
      [&] {
        residual(p, vec({1, 2}));
      },
      testing::ThrowsMessage<std::invalid_argument>(HasSubstr("r has 2 entries, not 3")));
  EXPECT_THAT(
      [&] {
        residual(p, vec({1, NAN, 0}));
      },
      testing::ThrowsMessage<std::invalid_argument>(HasSubstr("r[1] is nan")));
  EXPECT_THAT(
      [&] {
        states(p, vec({1, 0, INFINITY}));
      },
      testing::ThrowsMessage<std::invalid_argument>(HasSubstr("r[2] is inf")));
}

// --- the projection --------------------------------------------------------------------------------------------------

double half_line_distance(const Vec& y, const Vec& p) { return (y - p).norm(); }

/// Points of K, from the axis to the boundary.
Vec cone_point(Random& random, int d, double mu, double size) {
  Vec v(d);
  v[0] = size * random.uniform(0, 1);
  Vec direction = random.normals(d - 1);
  v.tail(d - 1) = direction.normalized() * mu * v[0] * (random.chance(0.3) ? 1 : random.uniform(0, 1));
  return v;
}

// Moreau (1962): y = P_K(y) + P_K°(y), orthogonal; P_K is idempotent, nonexpansive, positively homogeneous, and nearest
// among points of K (the variational inequality (y - p).(v - p) <= 0). Catches wrong cases at the edge of the polar
// cone and a wrong factor 1 + mu^2.
TEST(Projection, Laws) {
  Random random(7);
  for (int k = 0; k < 5000; ++k) {
    const int d = random.chance(0.3) ? 2 : 3;
    const double mu = random.chance(0.1) ? 0 : std::exp(random.uniform(-6, 4));
    const Vec y = random.normals(d) * std::exp(random.uniform(-3, 3));
    Vec p(d);
    project_onto_cone(y, mu, p);
    const double eps = 1e-14 * y.norm();
    EXPECT_LE(p.tail(d - 1).norm(), mu * p[0] + eps * (1 + mu));
    EXPECT_GE(p[0], 0);
    const Vec rest = y - p;
    EXPECT_NEAR(p.dot(rest), 0, 1e-13 * y.squaredNorm());
    EXPECT_LE(mu * rest.tail(d - 1).norm(), -rest[0] + eps * (1 + mu));  // in the polar cone
    Vec again(d);
    project_onto_cone(p, mu, again);
    EXPECT_LE((again - p).norm(), eps);
    project_onto_cone(Vec(3.5 * y), mu, again);
    EXPECT_LE((again - 3.5 * p).norm(), 4 * eps);
    const Vec z = random.normals(d);
    project_onto_cone(z, mu, again);
    EXPECT_LE((again - p).norm(), (y - z).norm() * (1 + 1e-14));
    const Vec v = cone_point(random, d, mu, 3 * y.norm());
    EXPECT_GE(half_line_distance(y, v), half_line_distance(y, p) * (1 - 1e-13));
  }
}

// Inside, in the polar cone, at the tip, on the axis, mu = 0, and sizes whose squares leave the doubles.
TEST(Projection, Cases) {
  const auto project = [](const Vec& y, double mu) {
    Vec p(y.size());
    project_onto_cone(y, mu, p);
    return p;
  };
  EXPECT_EQ(project(vec({2, 1, 0}), 0.5), vec({2, 1, 0}));
  EXPECT_EQ(project(vec({-2, 1, 0}), 0.5), vec({0, 0, 0}));
  EXPECT_EQ(project(vec({-1, 2, 0}), 0.5), vec({0, 0, 0}));  // on the edge of the polar cone
  EXPECT_EQ(project(vec({0, 0, 0}), 0.5), vec({0, 0, 0}));
  EXPECT_EQ(project(vec({3, 4, -5}), 0), vec({3, 0, 0}));
  EXPECT_EQ(project(vec({-3, 4, -5}), 0), vec({0, 0, 0}));
  EXPECT_TRUE(project(vec({0, 3, 4}), 1).isApprox(vec({2.5, 1.5, 2}), 1e-15));
  EXPECT_TRUE(project(vec({0, -2}), 1).isApprox(vec({1, -1}), 1e-15));
  EXPECT_TRUE(project(vec({0, 3e250, 4e250}), 1).isApprox(vec({2.5e250, 1.5e250, 2e250}), 1e-15));
  const Vec flat = project(vec({-1, 2, 0}), 1e200);  // K is nearly the half space y_N >= 0
  EXPECT_NEAR(flat[1], 2, 1e-15);
  EXPECT_NEAR(flat[0], 0, 1e-15);
}

}  // namespace
}  // namespace perp::contact
