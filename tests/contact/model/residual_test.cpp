// SPDX-License-Identifier: Apache-2.0
#include "contact/model/residual.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <optional>

#include "contact/contact_support.hpp"
#include "contact/model/unit_cone.hpp"
#include "contact/refusal.hpp"

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

// Each is what a solver without the last step of the law would return; each part of the judge, in units and as a share,
// must see its own.
TEST(Residual, NonSolutions) {
  const Problem slip = point(vec({-3, 3, -4}), 0.1);
  EXPECT_LE(residual(slip, vec({6, -0.36, 0.48})).largest(), 1e-15);
  // The maximal friction, but not opposite to the slip: only `slip` sees it.
  const Residual turned = residual(slip, vec({6, -0.48, 0.36}));
  EXPECT_LE(std::max({turned.cone, turned.normal, turned.cone_share, turned.normal_share}), 1e-15);
  EXPECT_GT(turned.slip, 0.05);
  EXPECT_GT(turned.slip_share, 0.01);
  EXPECT_GT(turned.natural, 0.05);
  // Too little friction, and too much.
  const Residual little = residual(slip, vec({6, -0.18, 0.24}));
  EXPECT_GT(little.slip, 0.1);
  EXPECT_GT(std::min(little.slip_share, little.scaled), 0.01);
  EXPECT_GT(residual(slip, vec({6, -0.72, 0.96})).cone_share, 0.05);
  // The associated (convex) law: r_N larger, so that u_N = mu |u_T|.
  const Residual associated = residual(slip, vec({7, -0.42, 0.56}));
  EXPECT_NEAR(associated.normal, 1, 1e-15);
  EXPECT_GT(std::min(associated.normal_share, associated.scaled), 0.05);
  // A pull, 2 N s of 2 |q|.
  const Residual pull = residual(point(vec({1, 2, -3}), 0.4), vec({-2, 0, 0}));
  EXPECT_EQ(pull.cone, 2);
  EXPECT_GT(pull.cone_share, 0.2);
  EXPECT_GT(pull.scaled, 0.1);
  // Penetration.
  EXPECT_GT(residual(slip, Vec::Zero(3)).scaled, 0.1);
  EXPECT_EQ(residual(point(vec({0, 0, 0}), 0.4), vec({0, 0, 0})).largest(), 0);
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
    for (Index a = 0; random.chance(0.7) && a < p.contacts(); ++a) {  // into the cone
      auto r_T = r.segment(d * a + 1, d - 1);
      r[d * a] = random.chance(0.5) ? 0 : std::abs(r[d * a]);
      r_T *= std::min(1.0, p.mu[a] * r[d * a] / r_T.norm());
    }
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
    other.W = p.W.matrix() * (b / a);
    other.q = p.q * b;
    const Residual e = residual(p, r);
    const Residual f = residual(other, a * r);
    EXPECT_NEAR(f.scaled, e.scaled, 1e-12 * e.scaled);
    EXPECT_EQ(f.worst, e.worst);
    EXPECT_NEAR(f.cone, a * e.cone, 1e-12 * a * e.cone);
    EXPECT_NEAR(f.normal, a * e.normal, 1e-12 * a * e.normal);
  }
}

// --- accepted --------------------------------------------------------------------------------------------------------

// W = 0, q_N < 0: no impulse is a solution, however large. Catches r - P_K(r - uhat) by subtraction, which loses u_N
// = -1 beside r_N = 1e33, and a metric relative to the largest impulse alone.
TEST(Accepted, HugeImpulsesBuyNothing) {
  Problem p = point(vec({-1, 0.5, 0}), 0.3);
  p.W = SpMat(3, 3);
  for (const double size : {0.0, 1.0, 1e8, 1e16, 1.2e33, 1e200})
    for (const double friction : {0.0, -0.2, -0.3}) {
      const Residual e = residual(p, vec({size, friction * size, 0}));
      EXPECT_FALSE(accepted(e, 0.1)) << size;
      EXPECT_GE(e.rr9118, 0.5) << size;
    }
}

// A body of 1 kg squeezed between two walls that both come towards it, W = (1, -1; -1, 1) in the normal rows: no
// solution, but r = s (1, 1) has W r = 0. Beside a free contact with |q| = 1e12 both published metrics are small.
TEST(Accepted, SqueezedBesideAFastOne) {
  Dense W = Dense::Zero(9, 9);
  W(0, 0) = W(3, 3) = 1;
  W(0, 3) = W(3, 0) = -1;
  for (const Index i : {1, 2, 4, 5, 6, 7, 8}) W(i, i) = 1;
  Problem p;
  p.W = sparse(W);
  p.mu = vec({0.5, 0.5, 0.5});
  p.q = vec({-1, 0, 0, -1, 0, 0, -1e12, 0, 0});
  for (const double s : {0.0, 1.0, 1e10, 1e20, 1e40}) {
    const Residual e = residual(p, vec({s, 0, 0, s, 0, 0, 1e12, 0, 0}));
    EXPECT_LE(std::max(e.siconos, e.rr9118), 2e-12) << s;
    EXPECT_GE(e.normal_share, 0.1) << s;
    EXPECT_FALSE(accepted(e, 1e-3)) << s;
  }
}

// Two blocks of 1 kg, one upon the other, on the ground: the joint has q = 0, and u = 0 only to rounding. Catches
// shares that ask for more than doubles have.
TEST(Accepted, RoundingOfWhatCancels) {
  Dense W = Dense::Zero(4, 4);
  W(0, 0) = 1 / 0.3;
  W(2, 2) = 1 / 0.3 + 1 / 0.7;
  W(0, 2) = W(2, 0) = -1 / 0.3;
  W(1, 1) = W(3, 3) = 1;
  Problem p;
  p.dimension = 2;
  p.W = sparse(W);
  p.mu = vec({0.5, 0.5});
  p.q = vec({-0.0981, 0, 0, 0});
  const double above = 0.7 * 0.0981;
  const Vec r = vec({0.3 * 0.0981 + above, 0, above, 0});
  EXPECT_TRUE(accepted(residual(p, r), 1e-14)) << residual(p, r).largest();
  Vec wrong = r;
  wrong[2] *= 1.0001;
  EXPECT_FALSE(accepted(residual(p, wrong), 1e-6));
}

// A contact that slips at 3e-5 of its velocities with friction 1e-5 inside its cone, beside a body of 1e6 N s: neither
// is slip nor stick. Catches products of the two, 3e-10, and metrics that divide by the body.
TEST(Accepted, NoSlipInsideTheCone) {
  const double inside = 0.3 * (1 - 1e-5);
  Problem p;
  p.W = sparse(Dense::Identity(6, 6));
  p.mu = vec({0.3, 0.3});
  p.q = vec({-1, inside + 3e-5, 0, -1e6, 0, 0});
  const Residual e = residual(p, vec({1, -inside, 0, 1e6, 0, 0}));
  EXPECT_LE(std::max({e.siconos, e.rr9118, e.cone_share, e.normal_share}), 1e-10);
  EXPECT_NEAR(e.slip_share, 1e-5 * 0.3 / std::hypot(1, 0.3), 1e-7);
  EXPECT_FALSE(accepted(e, 1e-8));
}

// Kilograms or tonnes, seconds or days: solutions stay solutions and others do not become any, although the published
// metrics compare impulses with velocities (with 1e12 kg the rounding of r alone is more than 1e-8 |q|). In small units
// of impulse they take any r for a solution of an open contact.
TEST(Accepted, DoesNotDependOnUnits) {
  const Vec stick = vec({6, -1.2, 1.6});
  const Problem sticks = point(vec({-3, 0.6, -0.8}), 0.4);
  const Problem slips = point(vec({-3, 3, -4}), 0.1);
  const Problem open = point(vec({1, 2, -3}), 0.4);
  for (const double mass : {1e-12, 1e-6, 1.0, 1e3, 1e6})
    for (const double time : {1e-6, 1.0, 1e6}) {
      const auto verdict = [&](Problem p, const Vec& r) {
        p.W.given() /= mass;
        p.q *= time;
        return accepted(residual(p, mass * time * r), 1e-8);
      };
      SCOPED_TRACE(std::to_string(mass) + ", " + std::to_string(time));
      EXPECT_TRUE(verdict(sticks, stick));
      EXPECT_TRUE(verdict(slips, vec({6, -0.36, 0.48})));
      EXPECT_TRUE(verdict(open, Vec::Zero(3)));
      EXPECT_FALSE(verdict(sticks, 1.01 * stick));
      EXPECT_FALSE(verdict(slips, vec({6, -0.48, 0.36})));
      EXPECT_FALSE(verdict(slips, vec({6, -0.36, 0.4801})));
      EXPECT_FALSE(verdict(slips, vec({7, -0.42, 0.56})));
      EXPECT_FALSE(verdict(open, vec({0.1, 0, 0})));
      EXPECT_FALSE(verdict(open, vec({-0.1, 0, 0})));
    }
}

// u = W r + q where W r is 1e60 and cancels but for one unit: integers times powers of two, so that the sum is exact.
// Catches sums in double, and in twice its precision.
TEST(Velocities, AreThoseOfTheGivenDoubles) {
  Random random(12);
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(2, 12);
    Dense W = Dense::Zero(3 * n, 3 * n);
    Vec r(3 * n);
    Vec expected(3 * n);
    const int high = random.integer(0, 200);
    for (Index j = 0; j < 3 * n; ++j) r[j] = std::ldexp(random.integer(1, 1 << 20), high);
    Problem p{.dimension = 3, .W = {}, .q = Vec(3 * n), .mu = Vec::Ones(n)};
    for (Index i = 0; i < 3 * n; ++i) {
      // a r_j - b r_k + q with a r_j = b r_k
      const Index j = random.integer(0, static_cast<int>(3 * n) - 1);
      const Index l = (j + 1) % (3 * n);
      W(i, j) = std::ldexp(r[l], -high);
      W(i, l) = -std::ldexp(r[j], -high);
      p.q[i] = expected[i] = random.normal();
    }
    p.W = sparse(W);
    EXPECT_EQ(velocities(p, r), expected);
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

// What is refused in working precision has the metrics of the exact judge, a random solution moved by less than the
// tolerance is never refused so, and beside huge impulses that cancel nothing is known so. Catches a point that is
// refused by rounding.
TEST(Judge, FarPointsHaveTheExactMetrics) {
  Random random(31);
  constexpr double tol = 1e-8;
  int refused = 0;
  for (int k = 0; k < 200; ++k) {
    const int d = 2 + k % 2;
    const Index n = 1 + k % 5;
    Problem p = random_problem(random, d, n);
    const Judge judge(p);
    const Vec r = random.normals(d * n) * std::pow(10, random.uniform(-3, 3));
    const std::optional<Residual> far = judge.far(r, tol);
    if (far) {
      const Residual exact = judge(r);
      EXPECT_FALSE(accepted(exact, tol));
      EXPECT_NEAR(far->natural, exact.natural, 1e-6 * exact.natural);
      EXPECT_NEAR(far->siconos, exact.siconos, 1e-6 * exact.siconos);
      EXPECT_NEAR(far->rr9118, exact.rr9118, 1e-6 * exact.rr9118);
      ++refused;
    }
    // Sticks: u = 0.
    Vec stuck = Vec::Zero(d * n);
    for (Index a = 0; a < n; ++a) stuck[d * a] = random.uniform(0.1, 1);
    p.q = -(p.W * stuck);
    const Judge of_solution(p);
    EXPECT_FALSE(of_solution.far(stuck + 1e-12 * random.normals(d * n), tol));
  }
  EXPECT_GE(refused, 150);
  // u_N is what is left of two times 5e16, and u_T = 1 is less than a unit in their last place.
  Problem huge = point(vec({0, 1, 0}), 0.5);
  const Vec impulse = vec({1e17, 0, 0});
  huge.q[0] = -0.5e17;
  EXPECT_FALSE(Judge(huge).far(impulse, tol));
}

TEST(Residual, RefusesBadImpulses) {
  const Problem p = point(vec({1, 2, -3}), 0.4);
  EXPECT_THAT(test::refusal_of([&] { residual(p, vec({1, 2})); }), HasSubstr("r has 2 entries, not 3"));
  EXPECT_THAT(test::refusal_of([&] { residual(p, vec({1, NAN, 0})); }), HasSubstr("r[1] is nan"));
  EXPECT_THAT(test::refusal_of([&] { states(p, vec({1, 0, INFINITY})); }), HasSubstr("r[2] is inf"));
  EXPECT_THAT(test::refusal_of([&] {
                states(p, {.r = vec({1, 0, 0}), .u = vec({1, 0})});
              }),
              HasSubstr("u has 2 entries, not 3"));
}

// --- the projection --------------------------------------------------------------------------------------------------

/// A point of K, from the axis to the boundary.
template <int Size>
ContactVector<Size> cone_point(Random& random, double size) {
  ContactVector<Size> v = ContactVector<Size>::Zero();
  v[0] = size * random.uniform(0, 1);
  for (int j = 0; j < disks<Size>; ++j)
    set_disk<Size>(v, j, 2,
                   Vec(random.normals(2)).normalized() * v[0] * (random.chance(0.3) ? 1 : random.uniform(0, 1)));
  return v;
}

template <int Size>
void expect_projection() {
  Random random(7);
  for (int k = 0; k < 5000; ++k) {
    const ContactVector<Size> y = random.normals(Size) * std::exp(random.uniform(-3, 3));
    const ContactVector<Size> p = project_onto_unit_cone<Size>(y, 2);
    const ContactVector<Size> rest = y - p;
    const double eps = 1e-14 * y.norm();
    double polar = rest[0];
    for (int j = 0; j < disks<Size>; ++j) {
      EXPECT_LE(disk<Size>(p, j, 2).norm(), p[0] + eps);
      polar += disk<Size>(rest, j, 2).norm();
    }
    EXPECT_GE(p[0], 0);
    EXPECT_LE(polar, 2 * eps);
    EXPECT_NEAR(p.dot(rest), 0, 1e-13 * y.squaredNorm());
    EXPECT_LE((project_onto_unit_cone<Size>(p, 2) - p).norm(), eps);
    EXPECT_LE((project_onto_unit_cone<Size>(3.5 * y, 2) - 3.5 * p).norm(), 4 * eps);
    const ContactVector<Size> z = random.normals(Size);
    EXPECT_LE((project_onto_unit_cone<Size>(z, 2) - p).norm(), (y - z).norm() * (1 + 1e-14));
    EXPECT_GE((y - cone_point<Size>(random, 3 * y.norm())).norm(), rest.norm() * (1 - 1e-13));
  }
}

// Moreau (1962): y = P_K(y) + P_K°(y), orthogonal; P_K is idempotent, nonexpansive, positively homogeneous, and nearest
// among points of K. Catches wrong cases at the edge of the polar cone, and of two disks a wrong share of each.
TEST(Projection, Laws) {
  expect_projection<3>();
  expect_projection<5>();
}

}  // namespace
}  // namespace perp::contact
