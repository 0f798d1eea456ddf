// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/cfunction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "cfunction_cases.hpp"
#include "ncp/quad.hpp"

namespace perp::ncp {
namespace {

using cases::direction;
using cases::eps;
using cases::Exact;
using cases::functions;
using cases::has_quad;
using cases::huge;
using cases::one_minus_ratio;
using cases::places;
using cases::Quad;
using cases::Random;
using cases::relative_error;
using cases::root;
using testing::HasSubstr;

double parameter(const CFunction& c) { return c.parameter ? c.parameter->value : 1; }

/// a + b - r,  r^2 = (a - b)^2 + lambda ab.
Exact exact_root(Quad lambda, Quad a, Quad b) {
  const Quad r = root((a - b) * (a - b) + lambda * a * b);
  const Quad c = 1 - lambda / 2;
  const Quad rest = (1 - c * c);
  return {a + b > 0 ? (4 - lambda) * a * b / (a + b + r) : a + b - r, one_minus_ratio(a - c * b, rest * b * b, r),
          one_minus_ratio(b - c * a, rest * a * a, r)};
}

/// The textbook formulas, but for differences that would cancel. Pre: (a, b) is no kink.
Exact exact(const CFunction& c, double x, double y) {
  const Quad a = x;
  const Quad b = y;
  const Quad p = parameter(c);
  const bool inside = x > 0 && y > 0;
  const auto smaller = [](Quad wa, Quad ra, Quad wb, Quad rb) { return wa < wb ? Exact{wa, ra, 0} : Exact{wb, 0, rb}; };
  if (c.name == "min") return smaller(a, 1, b, 1);
  if (c.name == "min-rho-b") return smaller(a, 1, p * b, p);
  if (c.name == "min-rho-a") return smaller(p * a, p, b, 1);
  if (c.name == "kanzow-kleinmichel") return exact_root(p, a, b);
  if (c.name == "evtushenko-purtov") {
    if (a + b >= 0) return {a * b, b, a};
    return {-(a * a + b * b) / 2, -a, -b};
  }
  const Exact fb = exact_root(2, a, b);
  if (c.name == "fischer-burmeister") return fb;
  if (c.name == "penalised-fischer-burmeister") {
    const Quad q = 1 - p;
    if (inside) return {p * fb.phi + q * a * b, p * fb.da + q * b, p * fb.db + q * a};
    return {p * fb.phi, p * fb.da, p * fb.db};
  }
  if (c.name == "luo-tseng") {
    const Quad s = root(p);
    if (inside) return {s * a * b, s * b, s * a};
    if (x >= 0 || y >= 0) return fb;
    const Quad h = root(p * a * b * a * b + fb.phi * fb.phi);
    return {-h, -(p * a * b * b + fb.phi * fb.da) / h, -(p * a * b * a + fb.phi * fb.db) / h};
  }
  ADD_FAILURE() << "no reference for " << c.name;
  return {0, 0, 0};
}

/// Where the partials jump.
bool kink(const CFunction& c, double a, double b) {
  if (c.name == "min" || c.name == "min-rho-b" || c.name == "min-rho-a") {
    const Quad p = parameter(c);
    const Quad wa = c.name == "min-rho-a" ? p * static_cast<Quad>(a) : static_cast<Quad>(a);
    const Quad wb = c.name == "min-rho-b" ? p * static_cast<Quad>(b) : static_cast<Quad>(b);
    const Quad gap = cases::magnitude(wa - wb);  // or the rounding of rho b decides, or both are beyond the range
    return gap <= 4 * static_cast<Quad>(eps) * cases::magnitude(wa) + static_cast<Quad>(cases::tiny) ||
           (cases::magnitude(wa) >= static_cast<Quad>(huge) && cases::magnitude(wb) >= static_cast<Quad>(huge));
  }
  if (c.name == "penalised-fischer-burmeister" || c.name == "luo-tseng")
    return (a == 0 && b >= 0) || (b == 0 && a >= 0);
  return a == 0 && b == 0;
}

// The definition (cfunction.hpp): zero exactly on the axes' nonnegative halves, positive inside the orthant, negative
// outside. Catches cancellation to 0 and squares and products that under- or overflow: a method then calls
// non-solutions solved, or walks off with an infinite merit.
TEST(CFunction, SignLawsHoldOverTheDoubleRange) {
  const auto pairs = places();
  ASSERT_GT(pairs.size(), 100000U);
  for (const CFunction& c : functions())
    for (const auto& [a, b] : pairs) {
      const double phi = c.at(a, b, 1, 1).phi;
      const int sign = a < 0 || b < 0 ? -1 : a > 0 && b > 0 ? 1 : 0;
      ASSERT_EQ((phi > 0) - (phi < 0), sign) << c.name << " at " << a << ", " << b << " is " << phi;
      ASSERT_TRUE(std::isfinite(phi)) << c.name << " at " << a << ", " << b;
    }
}

// Against 113 bits: 1e-12 is what a reader may count on, a few units in the last place is what is there. Catches the
// plain formulas: Fischer-Burmeister's is 2.3 % wrong at (1e-12, 1e3) and answers 0 and -inf at (1e-17, 1) and (1e300,
// 1e300); Kanzow-Kleinmichel's loses all digits at a = b for lambda near 0 and at a = -b for lambda near 4.
TEST(CFunction, ValuesAndPartialsHaveFullPrecision) {
  if (!has_quad) GTEST_SKIP() << "no type with 113 bits";
  const auto pairs = places();
  for (const CFunction& c : functions())
    for (const auto& [a, b] : pairs) {
      const CValue v = c.at(a, b, 1, 1);
      if (a == 0 && b == 0) continue;
      const Exact reference = exact(c, a, b);
      ASSERT_LE(relative_error(v.phi, reference.phi), 16 * eps) << c.name << " at " << a << ", " << b;
      if (kink(c, a, b)) continue;
      ASSERT_LE(relative_error(v.da, reference.da), 32 * eps) << c.name << ": da at " << a << ", " << b;
      ASSERT_LE(relative_error(v.db, reference.db), 32 * eps) << c.name << ": db at " << a << ", " << b;
    }
}

// The reference itself, at moderate points: the formulas as CFunction::formula prints them, with all their
// cancellation, and differences of 113-bit values. Catches an error that the reference shares with the code, a partial
// of another function among them.
TEST(CFunction, TheReferenceIsTheFormula) {
  if (!has_quad) GTEST_SKIP() << "no type with 113 bits";
  Random random(2);
  const auto plain = [](const CFunction& c, Quad a, Quad b) -> Quad {
    const Quad p = parameter(c);
    const auto pos = [](Quad x) { return x > 0 ? x : 0; };
    const Quad fb = a + b - root(a * a + b * b);
    if (c.formula == "min(a, b)") return a < b ? a : b;
    if (c.formula == "a - max(0, a - rho b)") return a - pos(a - p * b);
    if (c.formula == "b - max(0, b - rho a)") return b - pos(b - p * a);
    if (c.formula == "a + b - sqrt(a^2 + b^2)") return fb;
    if (c.formula == "lambda (a + b - sqrt(a^2 + b^2)) + (1 - lambda) max(0, a) max(0, b)")
      return p * fb + (1 - p) * pos(a) * pos(b);
    if (c.formula == "ab - min(0, a + b)^2 / 2") return a * b - pos(-a - b) * pos(-a - b) / 2;
    if (c.formula == "a + b - sqrt((a - b)^2 + lambda ab)") return a + b - root((a - b) * (a - b) + p * a * b);
    if (c.formula == "sign(min(a, b)) sqrt(alpha max(0, ab)^2 + min(0, a + b - sqrt(a^2 + b^2))^2)")
      return (a < 0 || b < 0 ? -1 : 1) * root(p * pos(a * b) * pos(a * b) + pos(-fb) * pos(-fb));
    ADD_FAILURE() << "no formula for " << c.name;
    return 0;
  };
  const auto near = [](Quad x, Quad y, double tol) {
    return cases::magnitude(x - y) <= tol * (1 + cases::magnitude(y));
  };
  for (const CFunction& c : functions())
    for (int k = 0; k < 2000; ++k) {
      const double a = random.normal();
      const double b = random.normal();
      if (kink(c, a, b) || std::abs(a - b) < 1e-2 || std::abs(a + b) < 1e-2) continue;
      const Exact at = exact(c, a, b);
      ASSERT_TRUE(near(at.phi, plain(c, a, b), 1e-25)) << c.name << " at " << a << ", " << b;
      const Quad h = 1e-12;
      const Quad in_a = (plain(c, a + h, b) - plain(c, a - h, b)) / (2 * h);
      const Quad in_b = (plain(c, a, b + h) - plain(c, a, b - h)) / (2 * h);
      ASSERT_TRUE(near(at.da, in_a, 1e-12)) << c.name << ": da at " << a << ", " << b;
      ASSERT_TRUE(near(at.db, in_b, 1e-12)) << c.name << ": db at " << a << ", " << b;
    }
}

// All but (38b, c) are symmetric, and so are their partials. Catches formulas that branch on one argument.
TEST(CFunction, ExchangedArgumentsExchangePartials) {
  const auto pairs = places(20000);
  for (const CFunction& c : functions()) {
    if (c.name == "min-rho-b" || c.name == "min-rho-a") continue;
    for (const auto& [a, b] : pairs) {
      const CValue v = c.at(a, b, 1, 2);
      const CValue w = c.at(b, a, 2, 1);
      ASSERT_LE(std::abs(v.phi - w.phi), 8 * eps * std::abs(w.phi)) << c.name << " at " << a << ", " << b;
      ASSERT_LE(std::abs(v.da - w.db), 8 * eps * std::abs(w.db)) << c.name << " at " << a << ", " << b;
      ASSERT_LE(std::abs(v.db - w.da), 8 * eps * std::abs(w.da)) << c.name << " at " << a << ", " << b;
    }
  }
}

// Pythagorean triples, where phi and its partials are rationals. Catches a sign or a factor, in the code. The sign is
// the minimum's (cfunction.hpp): the lecture's function is -phi.
TEST(FischerBurmeister, PythagoreanTriples) {
  const auto fb = fischer_burmeister();
  for (const double s : {1.0, 0x1p-900, 0x1p900}) {
    EXPECT_EQ(fb.at(3 * s, 4 * s, 1, 1).phi, 2 * s);
    EXPECT_EQ(fb.at(5 * s, 12 * s, 1, 1).phi, 4 * s);
    EXPECT_EQ(fb.at(-3 * s, 4 * s, 1, 1).phi, -4 * s);
    EXPECT_EQ(fb.at(-3 * s, -4 * s, 1, 1).phi, -12 * s);
    EXPECT_DOUBLE_EQ(fb.at(3 * s, 4 * s, 1, 1).da, 0.4);
    EXPECT_DOUBLE_EQ(fb.at(3 * s, 4 * s, 1, 1).db, 0.2);
    EXPECT_DOUBLE_EQ(fb.at(-3 * s, 4 * s, 1, 1).da, 1.6);
  }
}

// The B-subdifferential of phi_FB is {(1 - c, 1 - s): c^2 + s^2 = 1} at the origin and lies on that circle everywhere
// (Facchinei & Pang 2003, proposition 9.1.4). Catches the midpoint (1, 1) of the circle, which is in Clarke's
// subdifferential only, and partials that lose accuracy.
TEST(FischerBurmeister, PartialsLieOnTheCircle) {
  const auto fb = fischer_burmeister();
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const auto [ha, hb] = direction(random);
    const CValue v = fb.at(0, 0, ha, hb);
    ASSERT_EQ(v.phi, 0);
    ASSERT_NEAR((1 - v.da) * (1 - v.da) + (1 - v.db) * (1 - v.db), 1, 8 * eps) << ha << ", " << hb;
  }
  for (const auto& [a, b] : places()) {
    const CValue v = fb.at(a, b, 1, 1);
    ASSERT_NEAR((1 - v.da) * (1 - v.da) + (1 - v.db) * (1 - v.db), 1, 16 * eps) << a << ", " << b;
  }
  const CValue v = fb.at(0, 0, 0, 0);  // no direction: still an element
  EXPECT_NEAR((1 - v.da) * (1 - v.da) + (1 - v.db) * (1 - v.db), 1, 8 * eps);
}

/// A place where the partials may jump: a tie of the minima, the axes, the origin.
std::pair<double, double> place_of_kinks(const CFunction& c, Random& random) {
  const double t = std::abs(random.normal());
  const double tie = random.chance(0.5) ? t : -t;
  if (c.name == "min-rho-b") return {parameter(c) * tie, tie};
  if (c.name == "min-rho-a") return {tie, parameter(c) * tie};
  switch (random.integer(0, 3)) {
    case 0:
      return {t, 0};
    case 1:
      return {0, t};
    case 2:
      return {tie, tie};
    default:
      return {0, 0};
  }
}

// CFunction::at: the partials at a kink are the limit of those at (a, b) + s h, and so elements of the
// B-subdifferential. Catches a direction with the wrong sign or order, averages of two limits, and the wrong side of an
// axis.
TEST(CFunction, PartialsAtKinksAreLimitsAlongTheDirection) {
  Random random(4);
  for (const CFunction& c : functions())
    for (int k = 0; k < 4000; ++k) {
      const auto [ha, hb] = direction(random);
      const auto [a, b] = place_of_kinks(c, random);
      const CValue at = c.at(a, b, ha, hb);
      const CValue near = c.at(a + 1e-10 * ha, b + 1e-10 * hb, ha, hb);
      const double room = 1e-4 * (1 + std::abs(at.da) + std::abs(at.db));  // kanzow-kleinmichel(1e-6) is sharply bent
      ASSERT_NEAR(at.da, near.da, room) << c.name << " at " << a << ", " << b << " along " << ha << ", " << hb;
      ASSERT_NEAR(at.db, near.db, room) << c.name << " at " << a << ", " << b << " along " << ha << ", " << hb;
    }
}

// At kinks without a direction there is an element too: of some direction's. Catches 0 / 0.
TEST(CFunction, ZeroDirectionsGiveAnElement) {
  Random random(5);
  for (const CFunction& c : functions())
    for (int k = 0; k < 100; ++k) {
      const auto [a, b] = place_of_kinks(c, random);
      const CValue v = c.at(a, b, 0, 0);
      double least = infinity;
      for (int angle = 0; angle < 4096; ++angle) {
        const CValue w =
            c.at(a, b, std::cos(angle * 6.283185307179586 / 4096), std::sin(angle * 6.283185307179586 / 4096));
        least = std::min(least, std::hypot(v.da - w.da, v.db - w.db) / (1 + std::hypot(v.da, v.db)));
      }
      ASSERT_LE(least, 3e-3) << c.name << " at " << a << ", " << b;
    }
}

// The piecewise linear ones have one nonzero partial, at ties too. Catches convex combinations like (1/2, 1/2).
TEST(NaturalMin, PartialsAreThoseOfOneArgument) {
  for (const CFunction& c : {natural_min(), min_rho_a(7), min_rho_b(7)})
    for (const auto& [a, b] : places(10000)) {
      const CValue v = c.at(a, b, 1, 1);
      const double ra = c.name == "min-rho-a" ? 7 : 1;
      const double rb = c.name == "min-rho-b" ? 7 : 1;
      ASSERT_TRUE((v.da == ra && v.db == 0) || (v.da == 0 && v.db == rb)) << c.name << " at " << a << ", " << b;
    }
}

// x - l overflows where bounds are far apart. phi(inf, b) is the limit for b fixed, the end of the range where that is
// infinite. Catches inf - inf and inf / inf, a NaN in the merit.
TEST(CFunction, InfiniteArgumentsAreLimits) {
  for (const CFunction& c : functions())
    for (const double b : {-huge, -3.0, -1e-300, 0.0, 2.0, 1e300, huge, infinity}) {
      for (const auto& [v, near] : {std::pair{c.at(infinity, b, 1, 1), c.at(huge, b, 1, 1)},
                                    std::pair{c.at(b, infinity, 1, 1), c.at(b, huge, 1, 1)},
                                    std::pair{c.at(-infinity, b, 1, 1), c.at(-huge, b, 1, 1)},
                                    std::pair{c.at(b, -infinity, 1, 1), c.at(b, -huge, 1, 1)}}) {
        ASSERT_TRUE(std::isfinite(v.phi) && std::isfinite(v.da) && std::isfinite(v.db)) << c.name << ", b = " << b;
        ASSERT_EQ((v.phi > 0) - (v.phi < 0), (near.phi > 0) - (near.phi < 0)) << c.name << ", b = " << b;
        if (std::abs(b) < 1e10) {
          ASSERT_NEAR(v.phi, near.phi, 1e-12 * std::abs(near.phi)) << c.name << ", b = " << b;
        }
      }
    }
  EXPECT_EQ(fischer_burmeister().at(infinity, -3, 1, 1).phi, -3);
  EXPECT_EQ(kanzow_kleinmichel(1).at(infinity, -3, 1, 1).phi, -4.5);
  EXPECT_EQ(evtushenko_purtov().at(infinity, 3, 1, 1).phi, huge);
}

// The catalogue by name. Catches names that do not find their function, a parameter that is not taken over, and
// defaults that differ.
TEST(Catalogue, FindsFunctionsByName) {
  std::set<std::string> names;
  for (const CFunction& c : cfunctions()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_EQ(cfunction(c.name).formula, c.formula);
    EXPECT_EQ(cfunction(c.name).at(2, 3, 1, 1).phi, c.at(2, 3, 1, 1).phi);
    for (const std::string& text : {c.formula, c.reference, c.properties.level_sets, c.properties.stationary_points})
      EXPECT_FALSE(text.empty()) << c.name;
    if (c.parameter) {
      const CFunction other = cfunction(c.name, 0.25);
      EXPECT_EQ(other.parameter->value, 0.25);
      EXPECT_NE(other.at(2, 3, 1, 1).phi, c.at(2, 3, 1, 1).phi) << c.name;
    }
  }
  EXPECT_EQ(names.size(), 8U);
}

std::string refusal(std::string_view name, std::optional<double> parameter) {
  try {
    (void)cfunction(name, parameter);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// Bad input is refused with name and value. Catches NaN, the ends of a range, and a parameter that goes unused.
TEST(Catalogue, RefusesWhatMakesNoSense) {
  EXPECT_THAT(refusal("fisher", {}), HasSubstr("fisher"));
  EXPECT_THAT(refusal("min", 2), HasSubstr("min has no parameter"));
  EXPECT_THAT(refusal("penalised-fischer-burmeister", 1), HasSubstr("lambda is 1; it must be in (0, 1)"));
  EXPECT_THAT(refusal("penalised-fischer-burmeister", 0), HasSubstr("lambda is 0"));
  EXPECT_THAT(refusal("kanzow-kleinmichel", 4), HasSubstr("lambda is 4; it must be in (0, 4)"));
  EXPECT_THAT(refusal("luo-tseng", -1), HasSubstr("alpha is -1; it must be greater than 0"));
  EXPECT_THAT(refusal("min-rho-a", infinity), HasSubstr("rho is inf"));
  EXPECT_THAT(refusal("min-rho-b", std::nan("")), HasSubstr("rho is nan"));
}

}  // namespace
}  // namespace perp::ncp
