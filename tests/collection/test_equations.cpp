// SPDX-License-Identifier: Apache-2.0
// More, Garbow & Hillstrom's systems: F at simple points by hand, starts, and what is known of the solutions. The
// complementarity problems made of them: the planted points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "collection/collection.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp::collection {
namespace {

Vec F_of(std::string_view name, const Vec& x) {
  Vec F(x.size());
  EXPECT_TRUE(find(name)->make().mcp->eval(x, F)) << name;
  return F;
}

void expect_F(std::string_view name, const Vec& x, const Vec& expected) {
  EXPECT_LT((F_of(name, x) - expected).lpNorm<Eigen::Infinity>(), 1e-12 * (1 + expected.lpNorm<Eigen::Infinity>()))
      << name << ": " << F_of(name, x).transpose();
}

// Catches: wrong coefficients of terms that vanish at the solution.
TEST(Equations, ValuesByHand) {
  expect_F("rosenbrock", Vec({{2, 1}}), Vec({{-30, -1}}));
  expect_F("powell-singular", Vec({{1, 2, 3, 4}}), Vec({{21, -std::sqrt(5.0), 16, 9 * std::sqrt(10.0)}}));
  expect_F("powell-badly-scaled", Vec({{0, 1}}), Vec({{-1, std::exp(-1) - 1e-4}}));
  expect_F("helical-valley", Vec({{-1, 0, 0}}), Vec({{-50, 0, 0}}));
  expect_F("wood", Vec({{0, 1, 0, 2}}), Vec({{-1, 109.9, -1, 190.1}}));
  expect_F("broyden-tridiagonal", Vec::Ones(10), Vec({{0, -1, -1, -1, -1, -1, -1, -1, -1, 1}}));
  // i = 1: one neighbour; i = 6..9: six; i = 10: five.
  expect_F("broyden-banded", Vec::Ones(10), Vec({{6, 4, 2, 0, -2, -4, -4, -4, -4, -2}}));
  expect_F("brown-almost-linear", Vec::Constant(10, 2), Vec({{11, 11, 11, 11, 11, 11, 11, 11, 11, 1023}}));
  Vec F(10);
  for (Index i = 0; i < 10; ++i) F[i] = 10 + static_cast<double>(i + 1) - 1;  // cos = 0, sin = 1
  expect_F("trigonometric", Vec::Constant(10, std::numbers::pi / 2), F);
  for (Index i = 0; i < 10; ++i) F[i] = 1 + 55 * (1 + 2 * 55.0 * 55.0) * static_cast<double>(i + 1);
  expect_F("variably-dimensioned", Vec::Constant(10, 2), F);
  // T_i(1) = 1 for the shifted polynomials at x = 1; the integrals are 0 and -1 / (i^2 - 1).
  expect_F("chebyquad", Vec::Ones(7), Vec({{1, 4. / 3, 1, 16. / 15, 1, 36. / 35, 1}}));
}

// The angle in turns on its four sides and at the axes. Catches: a branch cut elsewhere than at x1 = 0, x2 < 0.
TEST(Equations, HelicalValleysAngle) {
  const auto theta = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return -F_of("helical-valley", Vec({{std::cos(angle), std::sin(angle), 0}}))[0] / 100;
  };
  for (const double degrees : {-89.0, -46.0, -44.0, 0.0, 30.0, 60.0, 90.0, 100.0, 170.0, 190.0, 260.0})
    EXPECT_NEAR(theta(degrees), degrees / 360, 1e-12) << degrees;
}

// The equations of Brown's function on its line of symmetry; Chebyshev's nodes (Abramowitz & Stegun 1964, table 25.5);
// the boundary value and the integral equation have one solution (More, Garbow & Hillstrom 1981, after Kelley).
TEST(Equations, SolutionsAreThoseKnown) {
  const double a = find("brown-almost-linear")->make().solutions.at(1).x[0];
  EXPECT_NEAR(10 * std::pow(a, 10) - 11 * std::pow(a, 9) + 1, 0, 1e-14);
  Vec nodes = find("chebyquad")->make().solutions.at(0).x;
  std::sort(nodes.begin(), nodes.end());
  const double table[] = {-0.883861700758, -0.529656775285, -0.323911810519, 0,
                          0.323911810519,  0.529656775285,  0.883861700758};
  for (Index i = 0; i < 7; ++i) EXPECT_NEAR(2 * nodes[i] - 1, table[i], 1e-11);
  EXPECT_LT((find("discrete-boundary-value")->make().solutions.at(0).x -
             find("discrete-integral-equation")->make().solutions.at(0).x)
                .lpNorm<Eigen::Infinity>(),
            1e-14);
  const Vec x = find("powell-badly-scaled")->make().solutions.at(0).x;
  EXPECT_NEAR(x[0], 1.098e-5, 1e-8);  // as the source prints it
  EXPECT_NEAR(x[1], 9.106, 1e-3);
}

// sum_j x_j / n = (2 / c) (1 - sqrt(1 - c)) (Chandrasekhar 1960, chapter V; by symmetry of the kernel also for the
// midpoint rule). Catches: a wrong weight.
TEST(Equations, ChandrasekharsIntegral) {
  Vec x = Vec::Ones(50);
  for (int k = 0; k < 400; ++k) x -= F_of("chandrasekhar", x);  // converges for c < 1
  EXPECT_LT(residual(*find("chandrasekhar")->make().mcp, x).natural, 1e-12);
  EXPECT_NEAR(x.mean(), 2 / 0.9 * (1 - std::sqrt(0.1)), 1e-12);
}

// Catches: a planted point without the degenerate indices it is there for.
TEST(Equations, PlantedPointsAreDegenerate) {
  for (const char* name : {"broyden-ncp-own", "trigonometric-ncp-own"}) {
    const Problem problem = find(name)->make();
    const Vec& x = problem.solutions.at(0).x;
    const Vec F = F_of(name, x);
    Index both = 0;
    for (Index i = 0; i < x.size(); ++i) both += x[i] == 0 && F[i] == 0;
    EXPECT_EQ(both, x.size() / 4) << name;
    EXPECT_EQ(F.maxCoeff(), 1) << name;
  }
}

// x0, 10 x0 and 100 x0. Catches: starts in another order or with another factor.
TEST(Equations, StartsAreThePublishedOnes) {
  EXPECT_EQ(find("rosenbrock")->make().starts[2], Vec({{-120, 100}}));
  EXPECT_EQ(find("wood")->make().starts[1], Vec({{-30, -10, -30, -10}}));
  EXPECT_EQ(find("powell-singular")->make().starts[0], Vec({{3, -1, 0, 1}}));
  EXPECT_NEAR(find("discrete-boundary-value")->make().starts[0][0], -10. / 121, 1e-16);
}

}  // namespace
}  // namespace perp::ncp::collection
