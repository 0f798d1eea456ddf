// SPDX-License-Identifier: Apache-2.0
#include "lcp/fischer_burmeister.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace perp::lcp {
namespace {

// phi(1e-12, 1e3) = 1e-12 (1 - 5e-16); the plain formula is 2 % wrong. phi(1e-17, 1) = 1e-17, the plain formula 0.
TEST(FischerBurmeister, NoCancellation) {
  EXPECT_NEAR(fischer_burmeister(1e-12, 1e3, 0, 0).phi, 1e-12, 1e-26);
  EXPECT_NEAR(fischer_burmeister(1e-17, 1, 0, 0).phi, 1e-17, 1e-32);
  EXPECT_NEAR(fischer_burmeister(1e3, 1e-12, 0, 0).db, 1, 1e-14);
  EXPECT_NEAR(fischer_burmeister(1e8, 1, 0, 0).da, 5e-17, 1e-30);
  EXPECT_EQ(fischer_burmeister(3, 4, 0, 0).phi, 2);
  EXPECT_NEAR(fischer_burmeister(1e200, 1e200, 0, 0).phi / 1e200, 2 - std::sqrt(2), 1e-15);
  EXPECT_EQ(fischer_burmeister(-3, 4, 0, 0).phi, -4);
  EXPECT_TRUE(std::isnan(fischer_burmeister(1, std::nan(""), 0, 0).phi)) << "a search would take the point";
  EXPECT_TRUE(std::isnan(fischer_burmeister(std::nan(""), 1, 0, 0).phi));
  const CValue kink = fischer_burmeister(0, 0, 3, 4);
  EXPECT_NEAR(kink.da, 0.4, 1e-15);
  EXPECT_NEAR(kink.db, 0.2, 1e-15);
}

}  // namespace
}  // namespace perp::lcp
