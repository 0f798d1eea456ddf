// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/smoothing_function.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "cfunction_cases.hpp"
#include "ncp/quad.hpp"

namespace perp::ncp {
namespace {

using cases::eps;
using cases::Exact;
using cases::has_quad;
using cases::one_minus_ratio;
using cases::Quad;
using cases::Random;
using cases::relative_error;
using cases::root;
using support::vec;
using testing::HasSubstr;

struct Place {
  double a, b, mu;
};
std::ostream& operator<<(std::ostream& out, const Place& p) {
  return out << "a = " << p.a << ", b = " << p.b << ", mu = " << p.mu;
}

/// 1e5 places: all signs and sizes within 1e-140 .. 1e140 of each other, a = b, a = -b, close to ab = mu^2, mu far
/// below and above.
std::vector<Place> smoothing_places() {
  Random random(1);
  std::vector<Place> all;
  for (int k = 0; k < 100000; ++k) {
    const double scale = std::pow(10, random.uniform(-150, 150));
    const double wide = random.chance(0.5) ? 3 : 70;
    const auto any = [&] { return scale * (random.chance(0.3) ? -1 : 1) * std::pow(10, random.uniform(-wide, wide)); };
    Place p{any(), any(), std::abs(any())};
    if (random.chance(0.1)) p.b = random.chance(0.5) ? p.a : -p.a;
    if (random.chance(0.1)) p.b = p.a * (1 + std::pow(10, random.uniform(-16, -1)));
    if (random.chance(0.2)) p.b = p.mu / p.a * p.mu * (1 + std::pow(10, random.uniform(-17, -1)));
    if (random.chance(0.05)) p.a = 0;
    if (!std::isfinite(p.b)) continue;
    all.push_back(p);
  }
  return all;
}

Exact exact(const SmoothingFunction& s, const Place& p) {
  const Quad a = p.a;
  const Quad b = p.b;
  const Quad mu = p.mu;
  if (s.name == "chks") {
    const Quad R = root((a - b) * (a - b) + 4 * mu * mu);
    const Quad phi = a + b > 0 ? 2 * (a * b - mu * mu) / (a + b + R) : (a + b - R) / 2;
    return {phi, one_minus_ratio(a - b, 4 * mu * mu, R) / 2, one_minus_ratio(b - a, 4 * mu * mu, R) / 2, -2 * mu / R};
  }
  const Quad R = root(a * a + b * b + 2 * mu * mu);
  const Quad phi = a + b > 0 ? 2 * (a * b - mu * mu) / (a + b + R) : a + b - R;
  return {phi, one_minus_ratio(a, b * b + 2 * mu * mu, R), one_minus_ratio(b, a * a + 2 * mu * mu, R), -2 * mu / R};
}

// Against 113 bits, to the last digits. Catches the plain formulas, which for mu << a, b have no correct digit, and
// squares that under- or overflow.
TEST(SmoothingFunction, ValuesAndPartialsHaveFullPrecision) {
  if (!has_quad) GTEST_SKIP() << "no type with 113 bits";
  const std::vector<Place> all = smoothing_places();
  ASSERT_GT(all.size(), 90000U);
  for (const SmoothingFunction& s : {chks(), smoothed_fischer_burmeister()})
    for (const Place& p : all) {
      const SmoothValue v = s.at(p.a, p.b, p.mu);
      const Exact reference = exact(s, p);
      ASSERT_LE(relative_error(v.phi, reference.phi), 32 * eps) << s.name << " at " << p;
      ASSERT_LE(relative_error(v.da, reference.da), 32 * eps) << s.name << " da at " << p;
      ASSERT_LE(relative_error(v.db, reference.db), 32 * eps) << s.name << " db at " << p;
      ASSERT_LE(relative_error(v.dmu, reference.dmu), 32 * eps) << s.name << " dmu at " << p;
    }
}

// The neural function against -mu log(e^(-a/mu) + e^(-b/mu)) in long double where that does not overflow. Catches exp
// that overflows, and log(1 + e) of a small e.
TEST(Neural, AgreesWithTheLogarithmOfTheSumOfExponentials) {
  Random random(2);
  for (int k = 0; k < 100000; ++k) {
    const double mu = std::pow(10, random.uniform(-5, 5));
    const double a = mu * random.uniform(-700, 700);
    const double b = random.chance(0.5) ? a + mu * random.normal() : mu * random.uniform(-700, 700);
    const long double m = mu;
    const long double ea = std::exp(-a / m);
    const long double eb = std::exp(-b / m);
    const SmoothValue v = neural().at(a, b, mu);
    const auto near = [](double value, long double exact, long double size) {
      return std::abs(static_cast<long double>(value) - exact) <= 1e-13L * size + 1e-300L;  // and underflow
    };
    const long double phi = -m * std::log(ea + eb);
    ASSERT_TRUE(near(v.phi, phi, std::abs(std::min(a, b)) + mu)) << a << ", " << b << ", " << mu;
    // The partials are conditioned by (a - b) / mu.
    const long double size = 1 + std::abs(a - b) / mu;
    ASSERT_TRUE(near(v.da, ea / (ea + eb), size * ea / (ea + eb))) << a << ", " << b << ", " << mu;
    ASSERT_TRUE(near(v.db, eb / (ea + eb), size * eb / (ea + eb))) << a << ", " << b << ", " << mu;
    const long double dmu = (phi - a * ea / (ea + eb) - b * eb / (ea + eb)) / m;  // homogeneous of degree 1
    ASSERT_NEAR(v.dmu, static_cast<double>(dmu), 1e-12 * (1 + (std::abs(a) + std::abs(b)) / mu * 1e-4));
  }
}

// |phi_mu - phi_0| <= kappa mu, -kappa <= dmu <= 0, positive partials with the sum of phi_0's (1 for min), and at
// a = b = 0 the bound is met: kappa is the least. Catches a wrong kappa or sign of dmu.
TEST(SmoothingFunction, IsWithinKappaMuOfItsLimit) {
  for (const SmoothingFunction& s : smoothing_functions()) {
    for (const Place& p : smoothing_places()) {
      const SmoothValue v = s.at(p.a, p.b, p.mu);
      const double limit = s.limit.at(p.a, p.b, 1, 1).phi;
      const double room = 8 * eps * (std::abs(limit) + p.mu);
      ASSERT_LE(v.phi, limit + room) << s.name << " at " << p;
      ASSERT_GE(v.phi, limit - s.kappa * p.mu - room) << s.name << " at " << p;
      ASSERT_TRUE(-s.kappa * (1 + 4 * eps) <= v.dmu && v.dmu <= 0) << s.name << " at " << p;
      ASSERT_TRUE(v.da >= 0 && v.db >= 0) << s.name << " at " << p;
      if (s.limit.name == "min") {
        ASSERT_NEAR(v.da + v.db, 1, 8 * eps) << s.name << " at " << p;
      }
    }
    EXPECT_DOUBLE_EQ(s.at(0, 0, 3).phi, -3 * s.kappa) << s.name;
    EXPECT_DOUBLE_EQ(s.at(0, 0, 3).dmu, -s.kappa) << s.name;
  }
}

// Zero exactly on the central path ab = mu^2, a, b > 0, for the two of them: Pythagorean-like triples. Catches factors.
TEST(SmoothingFunction, VanishOnTheCentralPath) {
  for (const SmoothingFunction& s : {chks(), smoothed_fischer_burmeister()}) {
    EXPECT_EQ(s.at(2, 8, 4).phi, 0) << s.name;
    EXPECT_EQ(s.at(0x1p600, 0x1p-600, 1).phi, 0) << s.name;
    EXPECT_GT(s.at(2, 8.1, 4).phi, 0) << s.name;
    EXPECT_LT(s.at(-2, -8, 4).phi, 0) << s.name;
  }
  EXPECT_EQ(chks().at(1, 4, 2).phi, 0);
  EXPECT_EQ(chks().at(0, 3, 2).phi, -1);  // (3 - 5) / 2
  EXPECT_DOUBLE_EQ(neural().at(0, 0, 2).phi, -2 * std::log(2));
}

// Jacobian consistency and exact limits (Chen, Qi & Sun 1998): at mu = 0 the value is phi_0's, the partials are its
// gradient; at mu -> 0 they come to that from mu > 0, at kinks to an element of Clarke's subdifferential (the segment
// of min, the disc of Fischer-Burmeister). Catches 0 / 0 and limits that are not those of the function.
TEST(SmoothingFunction, LimitIsExactAndConsistent) {
  for (const SmoothingFunction& s : smoothing_functions()) {
    for (const Place& p : smoothing_places()) {
      const SmoothValue v = s.at(p.a, p.b, 0);
      const CValue limit = s.limit.at(p.a, p.b, 1, 1);
      ASSERT_LE(std::abs(v.phi - limit.phi), 8 * eps * std::abs(limit.phi)) << s.name << " at " << p;
      if (p.a == p.b) continue;
      ASSERT_NEAR(v.da, limit.da, 32 * eps) << s.name << " at " << p;
      ASSERT_NEAR(v.db, limit.db, 32 * eps) << s.name << " at " << p;
      const double size = std::max(std::abs(p.a), std::abs(p.b));
      if (std::abs(p.a - p.b) < 1e-3 * size) continue;
      const SmoothValue near = s.at(p.a, p.b, 1e-12 * size);
      ASSERT_NEAR(near.da, limit.da, 1e-5) << s.name << " at " << p;
      ASSERT_NEAR(near.db, limit.db, 1e-5) << s.name << " at " << p;
    }
    for (const double mu : {0.0, 1e-300, 1e-8}) {
      const SmoothValue v = s.at(0, 0, mu);
      const double radius = s.limit.name == "min" ? std::abs(v.da + v.db - 1) : std::hypot(1 - v.da, 1 - v.db) - 1;
      EXPECT_LE(radius, eps) << s.name;
      EXPECT_TRUE(std::isfinite(v.dmu)) << s.name;
    }
  }
}

// x - l overflows where bounds are far apart, values lie at the ends of the range. Catches NaN and infinities.
TEST(SmoothingFunction, IsFiniteEverywhere) {
  const std::vector<double> ends{-infinity,   -cases::huge, -1e308, -1.0,        -cases::tiny, 0.0,
                                 cases::tiny, 1.0,          1e308,  cases::huge, infinity};
  for (const SmoothingFunction& s : smoothing_functions())
    for (const double a : ends)
      for (const double b : ends)
        for (const double mu : {0.0, cases::tiny, 1e-160, 1.0, 1e160, 1e308}) {
          const SmoothValue v = s.at(a, b, mu);
          ASSERT_TRUE(std::isfinite(v.phi) && std::isfinite(v.da) && std::isfinite(v.db) && std::isfinite(v.dmu))
              << s.name << " at " << a << ", " << b << ", " << mu;
        }
}

// The rows of every kind of box: derivatives in x, F and mu by differences, the distance to the nonsmooth rows,
// positive partials. Catches a chain rule with a wrong sign for upper bounds, where mu comes in twice.
TEST(SmoothReformulation, DerivativesMatchDifferencesInEveryKindOfRow) {
  Random random(3);
  const std::vector<std::pair<double, double>> boxes{
      {-infinity, infinity}, {0, infinity}, {-infinity, 3}, {-2, 3}, {0, 1e-3}, {1, 1}};
  for (const SmoothingFunction& s : smoothing_functions())
    for (const auto& [l, u] : boxes)
      for (int k = 0; k < 500; ++k) {
        const Box box{vec({l}), vec({u})};
        const double x = 2 * random.normal();
        const double F = 2 * random.normal();
        const double mu = random.uniform(0.05, 1);
        const double h = 1e-6;
        const auto phi = [&](double dx, double dF, double dmu) {
          Vec Phi(1);
          reformulate(s, box, vec({x + dx}), vec({F + dF}), mu + dmu, Phi);
          return Phi[0];
        };
        SmoothReformulation at;
        reformulate(s, box, vec({x}), vec({F}), mu, at);
        ASSERT_EQ(at.Phi[0], phi(0, 0, 0));
        ASSERT_NEAR(at.Da[0], (phi(h, 0, 0) - phi(-h, 0, 0)) / (2 * h), 1e-7) << s.name;
        ASSERT_NEAR(at.Db[0], (phi(0, h, 0) - phi(0, -h, 0)) / (2 * h), 1e-7) << s.name;
        ASSERT_NEAR(at.Dmu[0], (phi(0, 0, h) - phi(0, 0, -h)) / (2 * h), 1e-7) << s.name;
        ASSERT_TRUE(at.Da[0] >= 0 && at.Db[0] >= 0);
        Vec limit(1);
        reformulate(s.limit, box, vec({x}), vec({F}), limit);
        ASSERT_LE(std::abs(at.Phi[0] - limit[0]), 3 * s.kappa * mu) << s.name;
        ASSERT_NEAR(phi(0, 0, -mu), limit[0], 1e-14 * (1 + std::abs(limit[0]))) << s.name;
      }
}

// By name; an unknown one is refused with the known ones.
TEST(SmoothingFunction, IsFoundByName) {
  for (const SmoothingFunction& s : smoothing_functions()) EXPECT_EQ(smoothing_function(s.name).formula, s.formula);
  try {
    (void)smoothing_function("soft");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("'soft'; known: neural chks smoothed-fischer-burmeister"));
  }
}

}  // namespace
}  // namespace perp::ncp
