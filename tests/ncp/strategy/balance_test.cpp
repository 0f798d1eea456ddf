// SPDX-License-Identifier: Apache-2.0
/// Solutions that are so by the smallness of the model's units.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/matrices.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::matrix;
using support::vec;
using ::testing::HasSubstr;

// 0 <= s (M z + c q) _|_ z >= 0 has the solution c x of M x + q at c = 1, whatever the units s and c: an obstacle's LCP
// with x = (2, 0, 1). Catches z = 0, whose residual s c |q| is below every tolerance.
TEST(Balance, SmallUnitsDoNotPassForASolution) {
  const SpMat M = matrix({{2, -1, 0}, {-1, 2, -1}, {0, -1, 2}});
  const Vec q = vec({-4, 4, -2}), x = vec({2, 0, 1});
  for (const char* name : {"auto", "path", "lemke", "semismooth", "interior"})
    for (const double s : {1.0, 1e-12, 1e-20, 1e-41})
      for (const double c : {1.0, 1e-3, 1e3, 1e12}) {
        if (s == 1 ? c < 1 : s * c > 1e-9) continue;  // the tolerance sees these
        const auto mcp = make_affine_mcp({s * M, s * c * q, Box::nonnegative(3)}, "small");
        const Method method = std::string(name) == "lemke" ? Method(Affine{.method = lcp::Lemke{}}) : method_of(name);
        const Result result = solve(*mcp, Vec::Zero(3), method);
        ASSERT_TRUE(result.solved()) << name << " s = " << s << " c = " << c << ": " << result;
        EXPECT_LE((result.x / c - x).lpNorm<Eigen::Infinity>(), 1e-6)
            << name << " s = " << s << " c = " << c << ": " << result.x.transpose() / c << " " << result;
      }
}

// A nonlinear one: s (exp(z) - 2) = 0 and s (w^3 + w - z) = 0.
TEST(Balance, OfNonlinearProblems) {
  for (const double s : {1e-12, 1e-30}) {
    Functions f;
    f.box = Box::free(2);
    f.F = [s](In z, Out F) {
      F << s * (std::exp(z[0]) - 2), s * (z[1] * z[1] * z[1] + z[1] - z[0]);
      return true;
    };
    f.pattern = dense_pattern(2);
    f.J = [s](In z, SpMat& J) {
      J.coeffRef(0, 0) = s * std::exp(z[0]);
      J.coeffRef(0, 1) = 0;
      J.coeffRef(1, 0) = -s;
      J.coeffRef(1, 1) = s * (3 * z[1] * z[1] + 1);
      return true;
    };
    const auto mcp = make_mcp(std::move(f));
    const Result result = solve(*mcp, vec({0, 0}), automatic());
    ASSERT_TRUE(result.solved()) << result;
    EXPECT_NEAR(result.x[0], std::log(2), 1e-6) << s;
    EXPECT_NEAR(std::pow(result.x[1], 3) + result.x[1], std::log(2), 1e-6) << s;
    EXPECT_LE(result.relative, 1e-3);
  }
}

// s (z^2 + 1) = 0 has no solution in any units: what stays out of balance is said, and the run ends.
TEST(Balance, WhatStaysSoIsSaid) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double z) { return 1e-20 * (z * z + 1); }, [](double z) { return 2e-20 * z; }));
  const Result result = solve(*mcp, vec({3}), automatic());
  EXPECT_TRUE(result.solved());
  ASSERT_FALSE(result.notes.empty());
  EXPECT_THAT(result.notes.front(), HasSubstr("balanced to"));
}

}  // namespace
}  // namespace perp::ncp
