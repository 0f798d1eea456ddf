#include "ncp/cfunction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "support/matrices.hpp"

namespace perp::ncp {
namespace {

using support::Random;
using support::vec;

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double tiny = std::numeric_limits<double>::denorm_min();
constexpr double huge = std::numeric_limits<double>::max();

/// Values at which formulas with squares and differences break: the ends of the range, where squares under- and
/// overflow, where 1 + a is 1, neighbours.
std::vector<double> adversarial() {
  std::vector<double> values{0, -0.0};
  for (const double v :
       {tiny, 1e-310, 1e-300, 1e-160, 1e-17, 1e-12, 1e-8, 1.0, 1 + eps, 1e3, 1e8, 1e160, 1e300, 1e308, huge}) {
    values.push_back(v);
    values.push_back(-v);
  }
  return values;
}

/// Random signs and magnitudes over the whole range.
double anywhere(Random& random) {
  const double sign = random.chance(0.5) ? 1 : -1;
  return sign * std::pow(10, random.chance(0.5) ? random.uniform(-307, 307) : random.uniform(-3, 3));
}

std::vector<std::pair<double, double>> places() {
  std::vector<std::pair<double, double>> all;
  for (const double a : adversarial())
    for (const double b : adversarial()) all.emplace_back(a, b);
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const double a = anywhere(random);
    all.emplace_back(a, random.chance(0.1) ? a : random.chance(0.1) ? -a : anywhere(random));
  }
  return all;
}

std::vector<CFunction> functions() { return {fischer_burmeister(), natural_min()}; }

/// Long double has x86's 64 bits and squares all doubles; a reference with 53 would test nothing.
constexpr bool has_reference = std::numeric_limits<long double>::digits >= 64;

/// a + b - sqrt(a^2 + b^2) = 2ab / (a + b + r) where a + b > 0, which has no cancellation but in the exact a + b.
long double exact_phi(double x, double y) {
  const long double a = x;
  const long double b = y;
  const long double r = std::sqrt(a * a + b * b);
  return a + b > 0 ? 2 * a * b / (a + b + r) : a + b - r;
}

/// 1 - a / r = b^2 / (r (r + a)).
long double exact_da(double x, double y) {
  const long double a = x;
  const long double b = y;
  const long double r = std::sqrt(a * a + b * b);
  return a > 0 ? b * b / (r * (r + a)) : (r - a) / r;
}

double relative_error(double value, long double exact) {
  // Denormals are spaced by `tiny`, whatever their size.
  const long double room = std::abs(exact) + static_cast<long double>(tiny) / eps;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / room);
}

// The definition (cfunction.hpp): zero exactly on the axes' nonnegative halves, positive inside the orthant, negative
// outside. Catches cancellation to 0 and squares that under- or overflow: a method then calls non-solutions solved, or
// walks off with an infinite merit.
TEST(CFunction, SignLawsHoldOverTheDoubleRange) {
  for (const CFunction& c : functions())
    for (const auto& [a, b] : places()) {
      const double phi = c.at(a, b, 1, 1).phi;
      const int sign = a < 0 || b < 0 ? -1 : a > 0 && b > 0 ? 1 : 0;
      ASSERT_EQ((phi > 0) - (phi < 0), sign) << c.name << " at " << a << ", " << b << " is " << phi;
      ASSERT_LT(phi, infinity) << c.name << " at " << a << ", " << b;
    }
}

// phi is symmetric, and so are its partials. Catches formulas that branch on one argument.
TEST(CFunction, ExchangedArgumentsExchangePartials) {
  for (const CFunction& c : functions())
    for (const auto& [a, b] : places()) {
      const CValue v = c.at(a, b, 1, 2);
      const CValue w = c.at(b, a, 2, 1);
      ASSERT_EQ(v.phi, w.phi) << c.name << " at " << a << ", " << b;
      ASSERT_EQ(v.da, w.db) << c.name << " at " << a << ", " << b;
      ASSERT_EQ(v.db, w.da) << c.name << " at " << a << ", " << b;
    }
}

// Pythagorean triples, where phi and its partials are rationals. Catches a sign or a factor, in the code and in the
// reference below. The sign is the minimum's (cfunction.hpp): the lecture's function is -phi.
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
  if (has_reference) {
    EXPECT_EQ(exact_phi(3, 4), 2);
    EXPECT_EQ(exact_phi(-3, -4), -12);
    EXPECT_NEAR(static_cast<double>(exact_da(3, 4)), 0.4, 1e-18);
  }
}

// Against extended precision. Catches the plain formula, which at (1e-12, 1e3) is 2.3 % wrong, at (1e-17, 1) and
// (1e300, 1e300) answers 0 and -inf, and lesser cancellations of the same kind.
TEST(FischerBurmeister, ValuesAndPartialsHaveFullPrecision) {
  if (!has_reference) GTEST_SKIP() << "long double is no wider than double";
  const auto fb = fischer_burmeister();
  std::vector<std::pair<double, double>> all = places();
  for (const auto& named : {std::pair{1e-12, 1e3},
                            {1e-17, 1.0},
                            {1e300, 1e300},
                            {1e-310, 1e-310},
                            {-1e-12, 1e3},
                            {1e308, 1e308},
                            {-4e307, huge}})
    all.push_back(named);
  for (const auto& [a, b] : all) {
    if (a == 0 && b == 0) continue;
    const CValue v = fb.at(a, b, 1, 1);
    const long double phi = exact_phi(a, b);
    const bool overflows = phi < -static_cast<long double>(huge);
    ASSERT_LE(overflows ? v.phi > -infinity : relative_error(v.phi, phi), 4 * eps) << "phi at " << a << ", " << b;
    ASSERT_LE(relative_error(v.da, exact_da(a, b)), 8 * eps) << "da at " << a << ", " << b;
    ASSERT_LE(relative_error(v.db, exact_da(b, a)), 8 * eps) << "db at " << a << ", " << b;
  }
}

// Central differences at moderate points away from kinks. Catches partials of another function than phi.
TEST(CFunction, PartialsMatchDifferences) {
  Random random(2);
  for (const CFunction& c : functions())
    for (int k = 0; k < 2000; ++k) {
      const double a = random.normal();
      const double b = random.normal();
      if (std::hypot(a, b) < 0.1 || std::abs(a - b) < 1e-3) continue;
      const double h = 1e-6;
      const auto phi = [&](double x, double y) { return c.at(x, y, 1, 1).phi; };
      const CValue v = c.at(a, b, 1, 1);
      ASSERT_NEAR(v.da, (phi(a + h, b) - phi(a - h, b)) / (2 * h), 1e-8) << c.name << " at " << a << ", " << b;
      ASSERT_NEAR(v.db, (phi(a, b + h) - phi(a, b - h)) / (2 * h), 1e-8) << c.name << " at " << a << ", " << b;
    }
}

/// A direction, at times along an axis or the diagonal.
std::pair<double, double> direction(Random& random) {
  switch (random.integer(0, 9)) {
    case 0:
      return {1, 0};
    case 1:
      return {0, -1};
    case 2:
      return {-1, -1};
    default:
      return {random.normal(), random.normal()};
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

// CFunction::at: the partials at a kink are the limit of those at (a, b) + s h. Catches a direction with the wrong
// sign or order. Ties of min are its kinks, the origin is Fischer-Burmeister's.
TEST(CFunction, PartialsAtKinksAreLimitsAlongTheDirection) {
  Random random(4);
  for (const CFunction& c : functions())
    for (int k = 0; k < 2000; ++k) {
      const auto [ha, hb] = direction(random);
      const double tie = c.smooth_merit ? 0 : random.normal();
      const CValue at = c.at(tie, tie, ha, hb);
      const CValue near = c.at(tie + 1e-9 * ha, tie + 1e-9 * hb, ha, hb);
      ASSERT_NEAR(at.da, near.da, 1e-14) << c.name << " at " << tie << " along " << ha << ", " << hb;
      ASSERT_NEAR(at.db, near.db, 1e-14) << c.name << " at " << tie << " along " << ha << ", " << hb;
    }
}

// B-subdifferential of the minimum: (1, 0) or (0, 1), at ties too. Catches convex combinations like (1/2, 1/2).
TEST(NaturalMin, PartialsAreUnitVectors) {
  const auto min = natural_min();
  for (const auto& [a, b] : places()) {
    const CValue v = min.at(a, b, 1, 1);
    ASSERT_EQ(v.phi, a < b ? a : b);
    ASSERT_TRUE((v.da == 1 && v.db == 0) || (v.da == 0 && v.db == 1));
    ASSERT_EQ(v.da == 1 ? a : b, v.phi);
  }
}

/// One row of the reformulation.
struct Row {
  double l, u, x, F;
  double phi(const CFunction& c) const {
    Vec Phi(1);
    reformulate(c, {vec({l}), vec({u})}, vec({x}), vec({F}), Phi);
    return Phi[0];
  }
  CValue at(const CFunction& c, double hx = 1, double hF = 1) const {
    Reformulation out;
    reformulate(c, {vec({l}), vec({u})}, vec({x}), vec({F}), vec({hx}), vec({hF}), out);
    return {out.Phi[0], out.Da[0], out.Db[0]};
  }
  /// mcp.hpp's definition.
  bool solves() const {
    if (!(l <= x && x <= u)) return false;
    if (l == u) return true;
    return x == l ? F >= 0 : x == u ? F <= 0 : F == 0;
  }
};
std::ostream& operator<<(std::ostream& out, const Row& r) {
  return out << "[" << r.l << ", " << r.u << "], x = " << r.x << ", F = " << r.F;
}

/// Bounds of the five kinds of row.
const std::vector<std::pair<double, double>>& kinds() {
  static const std::vector<std::pair<double, double>> all{
      {-infinity, infinity}, {0, infinity}, {-2, infinity}, {-infinity, 0}, {-infinity, 3}, {-2, 3}, {0, 1e-6}, {1, 1}};
  return all;
}

// Billups 1995, section 3.2: Phi_i = 0 exactly where the sign conditions hold. Every kind of row at its bounds, beside
// them, inside and outside, with F of both signs and sizes down to 1e-300: solutions and non-solutions. Catches an
// extra minus in the composition, which accepts x = u with F > 0, swapped bounds, and rows lost in rounding.
TEST(Reformulation, IsZeroExactlyAtSolutions) {
  int solutions = 0;
  int others = 0;
  for (const CFunction& c : functions())
    for (const auto& [l, u] : kinds()) {
      std::vector<double> xs{-1e8, -1.0, 0.0, 0.25, 5e-7, 1.0, 1e8};
      for (const double bound : {l, u})
        if (std::isfinite(bound))
          for (const double d : {-1.0, -0x1p-40, 0.0, 0x1p-40, 1.0}) xs.push_back(bound + d);
      for (const double x : xs)
        for (const double F : {-1e300, -1.0, -1e-17, -1e-300, -tiny, -0.0, 0.0, tiny, 1e-300, 1e-17, 1.0, 1e300}) {
          const Row row{l, u, x, F};
          ++(row.solves() ? solutions : others);
          ASSERT_EQ(row.phi(c) == 0, row.solves()) << c.name << ": " << row << ", Phi = " << row.phi(c);
          ASSERT_EQ(row.phi(c), row.at(c).phi) << c.name << ": " << row;
        }
    }
  EXPECT_GT(solutions, 100);
  EXPECT_GT(others, 1000);
}

// The composition at Pythagorean triples, by hand. Catches what zeros cannot show: the sign of a row, and the order in
// which the bounds are composed.
TEST(Reformulation, RowsByHand) {
  const auto fb = fischer_burmeister();
  EXPECT_EQ((Row{-infinity, infinity, 7, -5}.phi(fb)), -5);
  EXPECT_EQ((Row{1, infinity, 4, 4}.phi(fb)), 2);       // phi(3, 4)
  EXPECT_EQ((Row{-infinity, 5, 2, -4}.phi(fb)), -2);    // -phi(3, 4)
  EXPECT_EQ((Row{-infinity, 5, 2, 4}.phi(fb)), 6);      // -phi(3, -4)
  EXPECT_EQ((Row{0.5, 5, 2, -4}.phi(fb)), -3);          // phi(1.5, -2)
  EXPECT_EQ((Row{-1, 6, 2, 3}.phi(fb)), 2);             // phi(3, 4)
  EXPECT_EQ((Row{2, 2, 5, 4}.phi(fb)), 3);              // x - l
  EXPECT_EQ((Row{-1, 5, 2, 4}.phi(natural_min())), 3);  // min(3, max(4, -3))
  EXPECT_EQ((Row{-1, 5, 2, -4}.phi(natural_min())), -3);
}

// Da and Db by differences in x and in F, in every kind of row. Catches a chain rule that drops the inner partial or
// its sign.
TEST(Reformulation, DiagonalsMatchDifferences) {
  Random random(5);
  int compared = 0;
  for (const CFunction& c : functions())
    for (const auto& [l, u] : kinds())
      for (int k = 0; k < 300; ++k) {
        const Row row{l, u, 2 * random.normal(), 2 * random.normal()};
        const double h = 1e-6;
        const CValue v = row.at(c);
        const CValue before = Row{l, u, row.x - h, row.F - h}.at(c);
        const CValue after = Row{l, u, row.x + h, row.F + h}.at(c);
        // A kink between the two points, or curvature that differences of this size do not see.
        if (std::abs(before.da - after.da) + std::abs(before.db - after.db) > 1e-4) continue;
        const auto phi = [&c, row](double x, double F) { return Row{row.l, row.u, x, F}.phi(c); };
        ASSERT_NEAR(v.da, (phi(row.x + h, row.F) - phi(row.x - h, row.F)) / (2 * h), 1e-7) << c.name << ": " << row;
        ASSERT_NEAR(v.db, (phi(row.x, row.F + h) - phi(row.x, row.F - h)) / (2 * h), 1e-7) << c.name << ": " << row;
        ++compared;
      }
  EXPECT_GT(compared, 3000);
}

// At kinks (Da, Db) is the limit along the direction, so that Da hx + Db hF is the directional derivative. At l, u and
// in between, with F = 0. Catches a direction that is not turned round for the inner function of an upper bound: the
// element is then one of no gradient nearby, and Newton's method with it no longer superlinear.
TEST(Reformulation, KinksTakeTheElementAlongTheDirection) {
  Random random(6);
  for (const CFunction& c : functions())
    for (const auto& [l, u] : kinds()) {
      if (u - l < 1) continue;  // beside one kink would be beside the other
      for (int k = 0; k < 500; ++k) {
        const auto [hx, hF] = direction(random);
        Row row{l, u, 0, 0};
        row.x = std::isfinite(u) && (!std::isfinite(l) || random.chance(0.5)) ? u : std::isfinite(l) ? l : 1;
        if (!c.smooth_merit && random.chance(0.5)) {  // a tie of min inside the box
          row.F = row.x == u ? -1 : 1;
          row.x += row.x == u ? -1 : 1;
        }
        const CValue at = row.at(c, hx, hF);
        const double s = 0x1p-20;
        const Row beside{l, u, row.x + s * hx, row.F + s * hF};
        const CValue near = beside.at(c, hx, hF);
        ASSERT_NEAR(at.da, near.da, 1e-5) << c.name << ": " << row << " along " << hx << ", " << hF;
        ASSERT_NEAR(at.db, near.db, 1e-5) << c.name << ": " << row << " along " << hx << ", " << hF;
        ASSERT_NEAR(at.da * hx + at.db * hF, (near.phi - at.phi) / s, 1e-5) << c.name << ": " << row;
      }
    }
}

// x - l overflows where bounds are far apart. phi(inf, b) = b, the limit. Catches inf - inf, a NaN in the merit.
TEST(CFunction, AnInfiniteArgumentDoesNotAct) {
  for (const CFunction& c : functions())
    for (const double b : {-3.0, 0.0, 2.0, 1e300}) {
      const CValue v = c.at(infinity, b, 1, 1);
      EXPECT_EQ(v.phi, b) << c.name;
      EXPECT_EQ(v.da, 0) << c.name;
      EXPECT_EQ(v.db, 1) << c.name;
    }
}

// A fixed variable's row is x - l, whatever F (mcp.hpp: F is free there); an infinite bound does not act.
TEST(Reformulation, FixedAndFreeRowsHaveTheirOwnPartials) {
  for (const CFunction& c : functions()) {
    const CValue fixed = Row{1, 1, 1, 1e300}.at(c);
    EXPECT_EQ(fixed.phi, 0);
    EXPECT_EQ(fixed.da, 1);
    EXPECT_EQ(fixed.db, 0);
    const CValue free = Row{-infinity, infinity, 1e300, -2}.at(c);
    EXPECT_EQ(free.phi, -2);
    EXPECT_EQ(free.da, 0);
    EXPECT_EQ(free.db, 1);
  }
}

}  // namespace
}  // namespace perp::ncp
