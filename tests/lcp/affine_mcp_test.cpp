// SPDX-License-Identifier: Apache-2.0
#include "lcp/affine_mcp.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::matrix;
using support::nan;
using support::Random;
using support::vec;
using testing::HasSubstr;

/// One unknown with F = slope z + q in [l, u].
AffineMcp scalar(double slope, double q, double l, double u) {
  return {matrix({{slope}}), vec({q}), {vec({l}), vec({u})}};
}

/// The definition at the head of affine_mcp.hpp, case by case, on values of F that are exact.
bool sign_conditions(double z, double F, double l, double u) {
  if (z < l || z > u) return false;
  if (l == u) return true;
  if (z == l) return F >= 0;
  if (z == u) return F <= 0;
  return F == 0;
}

// Solutions by hand: M = [2 1; 1 2], q = (-5, -6) has z = (4/3, 7/3); with q = (1, 1) it is 0 (Cottle, Pang & Stone
// 1992, chapter 1). Catches a residual of the wrong sign.
TEST(NaturalResidual, VanishesAtSolutions) {
  const SpMat M = matrix({{2, 1}, {1, 2}});
  EXPECT_LT(natural_residual(standard_lcp(M, vec({-5, -6})), vec({4.0 / 3, 7.0 / 3})), 1e-15);
  EXPECT_EQ(natural_residual(standard_lcp(M, vec({1, 1})), vec({0, 0})), 0);
  EXPECT_EQ(natural_residual(scalar(0, -3, 0, 2), vec({2})), 0) << "at the upper bound F < 0 is right";
  EXPECT_EQ(natural_residual(scalar(0, 3, 0, 2), vec({0})), 0);
  EXPECT_EQ(natural_residual(scalar(0, -3, 2, 2), vec({2})), 0) << "F is free where the variable is fixed";
  EXPECT_EQ(natural_residual(scalar(2, -6, -infinity, infinity), vec({3})), 0);
  EXPECT_EQ(natural_residual(AffineMcp{SpMat(0, 0), Vec(0), Box::free(0)}, Vec(0)), 0);
}

// The worst bug there is: a residual that accepts a non-solution. The values are |z - mid(l, z - F, u)| by hand.
TEST(NaturalResidual, RefusesNonSolutions) {
  EXPECT_EQ(natural_residual(scalar(0, 3, 0, 2), vec({2})), 2) << "at the upper bound F > 0 is wrong";
  EXPECT_EQ(natural_residual(scalar(0, 1, 0, 2), vec({2})), 1);
  EXPECT_EQ(natural_residual(scalar(0, -3, 0, 2), vec({0})), 2);
  EXPECT_EQ(natural_residual(scalar(0, -3, 0, infinity), vec({0})), 3);
  EXPECT_EQ(natural_residual(scalar(0, 3, -infinity, 0), vec({0})), 3);
  EXPECT_EQ(natural_residual(scalar(0, 0.5, 0, 2), vec({1})), 0.5);
  EXPECT_EQ(natural_residual(scalar(0, 0.5, -infinity, infinity), vec({1})), 0.5);
  EXPECT_EQ(natural_residual(scalar(0, 0, 0, 2), vec({2.5})), 0.5) << "outside the box";
  EXPECT_EQ(natural_residual(scalar(0, 7, 0, 2), vec({-0.5})), 0.5) << "outside, though F has the sign of the bound";
  EXPECT_EQ(natural_residual(scalar(0, 0, 2, 2), vec({2.5})), 0.5) << "off its fixed value";
  const SpMat M = matrix({{2, 1}, {1, 2}});
  EXPECT_NEAR(natural_residual(standard_lcp(M, vec({-5, -6})), vec({7.0 / 3, 4.0 / 3})), 1, 1e-15);
  EXPECT_EQ(natural_residual(standard_lcp(M, vec({-5, -6})), vec({2.5, 0})), 3.5);
}

// z - mid(l, z - F, u) computed as it stands loses F where |z| > 2^53 |F|: 1e17 - (1e17 - 1) = 0.
TEST(NaturalResidual, SeesAResidualBesideALargeUnknown) {
  EXPECT_EQ(natural_residual(scalar(0, 1, -infinity, infinity), vec({1e17})), 1);
  EXPECT_EQ(natural_residual(scalar(0, -1, 0, infinity), vec({1e17})), 1);
  EXPECT_EQ(natural_residual(scalar(0, 1e-20, 0, 2), vec({1})), 1e-20);
  EXPECT_EQ(natural_residual(scalar(0, 1, 1e17, infinity), vec({1e17})), 0);
}

// A NaN compares false with everything, an infinity projects to a bound: both may look like a solution.
TEST(NaturalResidual, IsInfiniteWhereFOrZIsNotFinite) {
  for (const double bad : {nan, infinity, -infinity})
    for (const auto& [l, u] :
         {std::pair{0.0, 2.0}, {0.0, infinity}, {-infinity, 2.0}, {-infinity, infinity}, {1.0, 1.0}}) {
      EXPECT_EQ(natural_residual(scalar(0, bad, l, u), vec({std::isinf(l) ? 0 : l})), infinity) << bad << ' ' << l;
      EXPECT_EQ(natural_residual(scalar(0, bad, l, u), vec({std::isinf(u) ? 1 : u})), infinity) << bad << ' ' << l;
      EXPECT_EQ(natural_residual(scalar(1, 0, l, u), vec({bad})), infinity) << bad << ' ' << l;
      EXPECT_EQ(natural_residual({SpMat(1, 1), vec({0}), {vec({l}), vec({u})}}, vec({bad})), infinity)
          << bad << ' ' << l;
    }
  EXPECT_EQ(natural_residual(scalar(1e308, 0, 0, 1e10), vec({100})), infinity) << "M z overflows";
  // A NaN before, and after, a component that is right or wrong.
  const AffineMcp three{SpMat(3, 3), vec({5, nan, 5}), Box::nonnegative(3)};
  EXPECT_EQ(natural_residual(three, vec({0, 0, 0})), infinity);
  EXPECT_EQ(natural_residual(three, vec({1, 0, 1})), infinity);
}

TEST(NaturalResidual, RefusesAPointOfAnotherSize) {
  const AffineMcp p = standard_lcp(matrix({{2, 1}, {1, 2}}), vec({1, 1}));
  EXPECT_THROW((void)natural_residual(p, vec({0})), std::invalid_argument);
  EXPECT_THROW((void)natural_residual(p, vec({0, 0, 0})), std::invalid_argument);
}

// Zero exactly at the solutions, over every kind of bound and every place of z, with values where rounding, overflow
// and underflow are near. M is zero, so that F = q is exact.
TEST(NaturalResidual, IsZeroIffTheSignConditionsHold) {
  const double values[] = {0,  -0.0,      5e-324, -5e-324, 1e-300, -1e-300, 1e-17, -1e-17, 0.1,   -0.1,  1,
                           -1, 1 + 1e-15, 2,      -2,      1e8,    -1e8,    1e17,  -1e17,  1e308, -1e308};
  std::vector<double> bounds(std::begin(values), std::end(values));
  bounds.push_back(infinity);
  bounds.push_back(-infinity);
  int solutions = 0;
  for (const double l : bounds)
    for (const double u : bounds) {
      AffineMcp p = scalar(0, 0, l, u);
      if (p.invalid()) continue;
      for (const double z : values)
        for (const double F : values) {
          p.q[0] = F;
          const bool solution = sign_conditions(z, F, l, u);
          solutions += solution;
          ASSERT_EQ(natural_residual(p, vec({z})) == 0, solution) << "z " << z << " F " << F << " in " << l << ' ' << u;
        }
    }
  EXPECT_GT(solutions, 1000);
}

// The same on random problems, against the sign conditions in extended precision: the residual is between the violation
// and its size (it is the violation, but for rounding).
TEST(NaturalResidual, EqualsTheViolationOfTheSignConditions) {
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const Index n = random.integer(1, 6);
    AffineMcp p{support::sparse(random.normals(n, n)), random.normals(n), support::mixed_box(n, random)};
    Vec z = random.normals(n);
    for (Index i = 0; i < n; ++i) {  // many components at a bound
      const int where = random.integer(0, 3);
      if (where == 1 && std::isfinite(p.box.lower[i])) z[i] = p.box.lower[i];
      if (where == 2 && std::isfinite(p.box.upper[i])) z[i] = p.box.upper[i];
    }
    if (random.chance(0.5)) {  // make z a solution by the choice of q
      z = project(p.box, z);
      p.q = -(p.M * z);
      for (Index i = 0; i < n; ++i) {
        if (z[i] == p.box.lower[i]) p.q[i] += random.uniform(0, 1);
        if (z[i] == p.box.upper[i]) p.q[i] -= random.uniform(0, 1);
      }
      ASSERT_LT(natural_residual(p, z), 1e-13);
    }
    ASSERT_NEAR(natural_residual(p, z), support::violation(p, z), 1e-13);
  }
}

TEST(AffineMcp, SaysWhatIsMalformed) {
  const AffineMcp good = standard_lcp(matrix({{2, 1}, {1, 2}}), vec({1, 1}));
  EXPECT_EQ(good.invalid(), std::nullopt);
  const auto why = [&](auto&& spoil) {
    AffineMcp p = good;
    spoil(p);
    return p.invalid().value_or("nothing");
  };
  EXPECT_THAT(why([](auto& p) { p.M = matrix({{1, 2, 3}, {4, 5, 6}}); }), HasSubstr("M is 2 x 3"));
  EXPECT_THAT(why([](auto& p) { p.M = SpMat(3, 3); }), HasSubstr("M is 3 x 3"));
  EXPECT_THAT(why([](auto& p) { p.q = Vec::Zero(3); }), HasSubstr("q has 3"));
  EXPECT_THAT(why([](auto& p) { p.box = Box::free(1); }), HasSubstr("the box has 1"));
  EXPECT_THAT(why([](auto& p) { p.box.upper.resize(5); }), HasSubstr("5 upper bounds"));
  EXPECT_THAT(why([](auto& p) { p.box.upper[1] = -1; }), HasSubstr("index 1 is [0, -1]"));
  EXPECT_THAT(why([](auto& p) { p.box.lower[0] = nan; }), HasSubstr("index 0 is [nan, inf]"));
  EXPECT_THAT(why([](auto& p) { p.q[1] = nan; }), HasSubstr("q of index 1 is nan"));
  EXPECT_THAT(why([](auto& p) { p.q[0] = -infinity; }), HasSubstr("q of index 0 is -inf"));
  EXPECT_THAT(why([](auto& p) { p.M.coeffRef(1, 0) = infinity; }), HasSubstr("row 1, column 0 is inf"));
  EXPECT_THAT(why([](auto& p) { p.M.coeffRef(0, 1) = nan; }), HasSubstr("row 0, column 1 is nan"));
  EXPECT_EQ((AffineMcp{SpMat(0, 0), Vec(0), Box::free(0)}.invalid()), std::nullopt);
}

TEST(AffineMcp, StandardLcpHasTheNonnegativeBox) {
  const AffineMcp p = standard_lcp(matrix({{2, 1}, {1, 2}}), vec({1, -1}));
  EXPECT_EQ(p.size(), 2);
  EXPECT_EQ(p.q, vec({1, -1}));
  EXPECT_EQ(p.box.lower, vec({0, 0}));
  EXPECT_EQ(p.box.upper, vec({infinity, infinity}));
}

}  // namespace
}  // namespace perp::lcp
