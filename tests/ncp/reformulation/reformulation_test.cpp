// SPDX-License-Identifier: Apache-2.0
// Billups' composition of C-functions over boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "cfunction_cases.hpp"

namespace perp::ncp {
namespace {

using cases::direction;
using cases::functions;
using cases::huge;
using cases::tiny;
using support::Random;
using support::vec;

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
  /// x - mid(l, x - F, u), without the rounding of x - F.
  double natural() const { return l == u ? x - l : std::max(x - u, std::min(F, x - l)); }
  /// ncp/problem/mcp.hpp's definition.
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
      {-infinity, infinity}, {0, infinity},  {-2, infinity}, {-infinity, 0}, {-infinity, 3}, {-2, 3}, {0, 1e-6}, {1, 1},
      {-1e308, infinity},    {-1e308, 1e308}};
  return all;
}

// Billups 1995, section 3.2: Phi_i = 0 exactly where the sign conditions hold, and its sign is that of mid(x - u, F, x
// - l) everywhere (cfunction.hpp: all that the composition needs of phi). Every kind of row at its bounds, beside them,
// inside and outside, where x - l overflows, with F of both signs and sizes down to the least: solutions and
// non-solutions. Catches an extra minus in the composition, which accepts x = u with F > 0, swapped bounds, products
// that underflow to zero, and rows lost in rounding.
TEST(Reformulation, IsZeroExactlyAtSolutions) {
  int solutions = 0;
  int others = 0;
  const auto sign = [](double v) { return (v > 0) - (v < 0); };
  for (const CFunction& c : functions())
    for (const auto& [l, u] : kinds()) {
      std::vector<double> xs{-huge, -1e308, -1e8, -1.0, 0.0, 0.25, 5e-7, 1.0, 1e8, 1e308, huge};
      for (const double bound : {l, u})
        if (std::isfinite(bound))
          for (const double d : {-1.0, -0x1p-40, 0.0, 0x1p-40, 1.0}) xs.push_back(bound + d);
      for (const double x : xs)
        for (const double F :
             {-huge, -1e300, -1.0, -1e-17, -1e-300, -tiny, -0.0, 0.0, tiny, 1e-300, 1e-17, 1.0, 1e300, huge}) {
          const Row row{l, u, x, F};
          ++(row.solves() ? solutions : others);
          ASSERT_EQ(row.phi(c) == 0, row.solves()) << c.name << ": " << row << ", Phi = " << row.phi(c);
          ASSERT_EQ(sign(row.phi(c)), sign(row.natural())) << c.name << ": " << row << ", Phi = " << row.phi(c);
          const CValue v = row.at(c);
          ASSERT_EQ(row.phi(c), v.phi) << c.name << ": " << row;
          ASSERT_TRUE(std::isfinite(v.phi) && std::isfinite(v.da) && std::isfinite(v.db)) << c.name << ": " << row;
          ASSERT_TRUE(c.name == "evtushenko-purtov" || (v.da >= 0 && v.db >= 0)) << c.name << ": " << row;
        }
    }
  EXPECT_GT(solutions, 1000);
  EXPECT_GT(others, 10000);
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
  EXPECT_EQ((Row{-1, 6, 2, 3}.phi(evtushenko_purtov())), 36);                     // phi(3, -phi(4, -3)) = 3 * 12
  EXPECT_EQ((Row{-1, 6, 2, 3}.phi(luo_tseng())), 12);                             // phi(3, -phi_FB(4, -3)) = 3 * 4
  EXPECT_EQ((Row{1, infinity, 4, 4}.phi(penalised_fischer_burmeister(0.5))), 7);  // (2 + 12) / 2
  EXPECT_EQ((Row{1, infinity, 4, 4}.phi(min_rho_b(0.5))), 2);
  EXPECT_EQ((Row{1, infinity, 4, 4}.phi(min_rho_a(0.5))), 1.5);
}

// Da and Db by differences in x and in F, in every kind of row. Catches a chain rule that drops the inner partial or
// its sign.
TEST(Reformulation, DiagonalsMatchDifferences) {
  Random random(5);
  int compared = 0;
  for (const CFunction& c : functions())
    for (const auto& [l, u] : kinds())
      for (int k = 0; k < 300 && std::abs(l) != 1e308; ++k) {
        const Row row{l, u, 2 * random.normal(), 2 * random.normal()};
        const double h = 1e-6;
        const CValue v = row.at(c);
        const CValue before = Row{l, u, row.x - h, row.F - h}.at(c);
        const CValue after = Row{l, u, row.x + h, row.F + h}.at(c);
        // A kink between the two points, or curvature that differences of this size do not see.
        if (std::abs(before.da - after.da) + std::abs(before.db - after.db) > 1e-4 * (std::abs(v.da) + std::abs(v.db)))
          continue;
        const auto phi = [&c, row](double x, double F) { return Row{row.l, row.u, x, F}.phi(c); };
        const double room = 1e-6 * (1 + std::abs(v.phi) + std::abs(v.da) + std::abs(v.db));
        ASSERT_NEAR(v.da, (phi(row.x + h, row.F) - phi(row.x - h, row.F)) / (2 * h), room) << c.name << ": " << row;
        ASSERT_NEAR(v.db, (phi(row.x, row.F + h) - phi(row.x, row.F - h)) / (2 * h), room) << c.name << ": " << row;
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
      if (u - l < 1 || std::abs(l) == 1e308) continue;  // beside one kink would be beside the other
      for (int k = 0; k < 500; ++k) {
        const auto [hx, hF] = direction(random);
        Row row{l, u, 0, 0};
        row.x = std::isfinite(u) && (!std::isfinite(l) || random.chance(0.5)) ? u : std::isfinite(l) ? l : 1;
        if (c.name == "min" && random.chance(0.5)) {  // a tie inside the box
          row.F = row.x == u ? -1 : 1;
          row.x += row.x == u ? -1 : 1;
        }
        const CValue at = row.at(c, hx, hF);
        const double s = 0x1p-25;
        const Row beside{l, u, row.x + s * hx, row.F + s * hF};
        const CValue near = beside.at(c, hx, hF);
        const double room = 1e-4 * (1 + at.da + at.db);
        ASSERT_NEAR(at.da, near.da, room) << c.name << ": " << row << " along " << hx << ", " << hF;
        ASSERT_NEAR(at.db, near.db, room) << c.name << ": " << row << " along " << hx << ", " << hF;
        ASSERT_NEAR(at.da * hx + at.db * hF, (near.phi - at.phi) / s, room) << c.name << ": " << row;
      }
    }
}

// A fixed variable's row is x - l, whatever F (ncp/problem/mcp.hpp: F is free there); an infinite bound does not act.
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
