// SPDX-License-Identifier: Apache-2.0
#pragma once
// Checks of a problem's structure that several families share.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp::test {

inline SpMat jacobian(const Mcp& mcp, const Vec& x) {
  SpMat J = mcp.jacobian_pattern();
  EXPECT_TRUE(mcp.jacobian(x, J));
  return J;
}

inline Vec values(const Mcp& mcp, const Vec& x) {
  Vec F(x.size());
  EXPECT_TRUE(mcp.eval(x, F));
  return F;
}

inline Vec random_point(Index n, std::mt19937& engine, double low, double high) {
  std::uniform_real_distribution<double> uniform(low, high);
  return Vec::NullaryExpr(n, [&] { return uniform(engine); });
}

// Catches: an entry said to be constant that is not, which presolve would rely on; flags in another order than J's.
inline void expect_constant_entries(const Mcp& mcp) {
  std::mt19937 engine(3);
  const SpMat one = jacobian(mcp, random_point(mcp.size(), engine, 0.1, 2));
  const SpMat other = jacobian(mcp, random_point(mcp.size(), engine, 0.1, 2));
  const std::vector<bool> linear = mcp.linear_entries();
  ASSERT_EQ(static_cast<Index>(linear.size()), one.nonZeros());
  Index constant = 0;
  for (Index k = 0; k < one.nonZeros(); ++k)
    if (linear[static_cast<std::size_t>(k)]) {
      EXPECT_EQ(one.valuePtr()[k], other.valuePtr()[k]) << k;
      ++constant;
    }
  EXPECT_GT(constant, 0);
}

// (F(z) - F(w))'(z - w) >= least |z - w|^2 at random pairs in [0, high]. Catches: a coupling whose sign is wrong.
inline void expect_monotone(const Mcp& mcp, double high, double least = 0) {
  std::mt19937 engine(7);
  for (int k = 0; k < 50; ++k) {
    const Vec z = random_point(mcp.size(), engine, 0, high);
    const Vec w = random_point(mcp.size(), engine, 0, high);
    const double product = (values(mcp, z) - values(mcp, w)).dot(z - w);
    EXPECT_GE(product, least * (z - w).squaredNorm() - 1e-9 * std::abs(product));
  }
}

}  // namespace perp::ncp::test
