// SPDX-License-Identifier: Apache-2.0
// Scaling: one to one, exact, undoes bad units, and keeps off where units are fine.
#include "ncp/transforms/scaling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Random;
using support::vec;
using testing::HasSubstr;
using testing::ThrowsMessage;

SpMat jacobian(const Mcp& mcp, const Vec& x) {
  SpMat J = mcp.jacobian_pattern();
  EXPECT_TRUE(mcp.jacobian(x, J));
  return J;
}

/// R and C of 10^[-range, range], in powers of two.
Scaling units(Index n, double range, Random& random) {
  const auto factor = [&] { return std::exp2(std::round(random.uniform(-range, range) * std::log2(10))); };
  return {.rows = Vec::NullaryExpr(n, factor), .columns = Vec::NullaryExpr(n, factor)};
}

// A bad model of 2 x 2 by hand: entries 2^20 2^r_i 2^c_j; any spread of that form can be taken out completely. Would
// catch R and C exchanged, and factors that are no powers of two.
TEST(Scaling, TakesOutUnitsCompletely) {
  support::AffineMcp problem{support::matrix({{1 << 20, 1 << 4}, {1 << 30, 1 << 14}}), vec({1, 1}),
                             Box::nonnegative(2)};
  const auto mcp = make_mcp(support::affine(problem));
  const Scaling s = scaling(*mcp, problem.M);
  EXPECT_EQ(s.before, std::exp2(26));
  EXPECT_EQ(s.after, 1);
  EXPECT_TRUE(s.helps());
  const ScaledMcp scaled(*mcp, s);
  EXPECT_EQ(Eigen::MatrixXd(jacobian(scaled, Vec::Zero(2))), Eigen::MatrixXd::Ones(2, 2));
  EXPECT_EQ(s.columns.prod(), 1) << "lengths keep their meaning on the whole";
  for (const Vec* factors : {&s.rows, &s.columns})
    for (const double f : *factors) EXPECT_EQ(std::exp2(std::round(std::log2(f))), f);
}

// An entry that is tiny at the start by chance (here x1 - 1 near 1) says nothing about units.
TEST(Scaling, IgnoresEntriesThatAreTinyByChance) {
  support::AffineMcp problem{support::matrix({{1e-14, 1}, {1, 2}}), vec({1, 1}), Box::nonnegative(2)};
  const Scaling s = scaling(*make_mcp(support::affine(problem)), problem.M);
  EXPECT_EQ(s.before, 2);
}

// There and back without rounding, bounds and signs kept, derivatives right, and the tolerance safe: over all kinds of
// bounds. Would catch factors on the wrong side.
TEST(Scaling, IsOneToOne) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Index n = random.integer(1, 6);
    const auto mcp = make_mcp(
        support::affine({support::random_sparse(n, 2, random), random.normals(n), support::mixed_box(n, random)}));
    const Scaling s = units(n, 3, random);
    const ScaledMcp scaled(*mcp, s);
    ASSERT_FALSE(scaled.box().first_invalid());
    const Vec x = random.normals(n), xs = scaled.to_scaled(x);
    EXPECT_EQ(scaled.to_original(xs), x);
    Vec F(n), Fs(n);
    ASSERT_TRUE(mcp->eval(x, F) && scaled.eval(xs, Fs));
    EXPECT_EQ(Fs, Vec(s.rows.cwiseProduct(F)));
    EXPECT_EQ(describe(scaled, check_jacobian(scaled, xs)), "");
    for (Index i = 0; i < n; ++i) EXPECT_EQ(scaled.box().lower[i] * s.columns[i], mcp->box().lower[i]);
    const Vec inside = lcp::project(mcp->box(), x);
    const double original = residual(*mcp, inside).natural;
    const double there = residual(scaled, scaled.to_scaled(inside)).natural;
    EXPECT_LE(scaled.tolerance(original), there * (1 + 1e-12)) << "or a worse point would pass";
  }
}

// The solutions of Kojima & Shindo's problem in units spoilt over twelve orders of magnitude, found after scaling
// without knowing those units, from the start in the same units.
TEST(Scaling, RestoresSpoiltUnits) {
  const auto mcp = make_mcp(support::kojima_shindo(true));
  Random random(4);
  int solved = 0, plain = 0, advised = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const ScaledMcp spoilt(*mcp, units(4, 3, random));
    const Vec start = spoilt.to_scaled(Vec::Ones(4));
    const Scaling s = scaling(spoilt, jacobian(spoilt, start));
    EXPECT_LE(s.after, 10);
    advised += s.helps() ? 1 : 0;
    const ScaledMcp scaled(spoilt, s);
    const auto run = [&](const Mcp& problem, const Vec& x0) {
      return solve(problem, x0, SemismoothNewton{.stop = {.tol = 1e-9, .max_iterations = 200}});
    };
    const Result r = run(scaled, scaled.to_scaled(start));
    solved += residual(*mcp, spoilt.to_original(scaled.to_original(r.x))).natural <= 1e-4 ? 1 : 0;
    plain += residual(*mcp, spoilt.to_original(run(spoilt, start).x)).natural <= 1e-4 ? 1 : 0;
  }
  EXPECT_GE(advised, 10);
  EXPECT_GE(solved, 18);
  EXPECT_GT(solved, plain);
}

TEST(Scaling, LeavesFixedVariablesOut) {
  support::AffineMcp problem{support::matrix({{1e12, 1e12}, {1e-12, 1}}), vec({1, 1}), {vec({2, 0}), vec({2, 9})}};
  const Scaling s = scaling(*make_mcp(support::affine(problem)), problem.M);
  EXPECT_EQ(s.before, 1);
  EXPECT_EQ(s.rows[0], 1);
  EXPECT_EQ(s.columns[0], 1);
}

// 1e-300 / 2^40 is denormal: the bound would not come back.
TEST(Scaling, KeepsOffWhereABoundWouldBeLost) {
  support::AffineMcp problem{
      support::matrix({{1e-30, 1}, {1, 1e30}}), vec({1, 1}), {vec({1e-310, 3e-310}), vec({1, 1})}};
  const Scaling s = scaling(*make_mcp(support::affine(problem)), problem.M);
  EXPECT_EQ(s.columns, Vec::Ones(2));
  EXPECT_EQ(s.before, s.after);
  EXPECT_FALSE(s.helps());
}

TEST(Scaling, RefusesBadInput) {
  const auto mcp = make_mcp(support::kojima_shindo());
  EXPECT_THROW((void)scaling(*mcp, SpMat(3, 4)), std::invalid_argument);
  SpMat J = mcp->jacobian_pattern();
  J.coeffRef(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { (void)scaling(*mcp, J); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("equation F[3] with respect to variable x[2] is nan")));
  EXPECT_THAT([&] { const ScaledMcp s(*mcp, {.rows = Vec::Ones(3), .columns = Vec::Ones(4)}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("3 row factors for 4")));
  EXPECT_THAT(
      [&] {
        const ScaledMcp s(*mcp, {.rows = Vec::Ones(4), .columns = vec({1, 1, -2, 1})});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("column factor 3 is -2")));
}

}  // namespace
}  // namespace perp::ncp
