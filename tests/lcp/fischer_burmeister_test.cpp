// SPDX-License-Identifier: Apache-2.0
#include "lcp/fischer_burmeister.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

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

// The value alone is the same double as the value with its partials, so that a merit that falls by one falls by the
// other. Catches a branch that only one of the two has.
TEST(FischerBurmeister, ValueAloneIsTheSame) {
  const double huge = std::numeric_limits<double>::max();
  const double tiny = std::numeric_limits<double>::denorm_min();
  for (const double a : {0.0, -0.0, tiny, 1e-200, 1e-12, 0.3, 1.0, 7e5, huge, infinity})
    for (const double b : {0.0, -0.0, tiny, 1e-200, 1e-12, 0.3, 1.0, 7e5, huge, infinity})
      for (const double x : {a, -a})
        for (const double F : {b, -b}) {
          const auto phi = [](double p, double q, double hp, double hq) { return fischer_burmeister(p, q, hp, hq); };
          EXPECT_EQ(fischer_burmeister_value(x, F), fischer_burmeister(x, F, 1, 1).phi) << x << " " << F;
          if (!std::isfinite(x) || !std::isfinite(F)) continue;
          for (const auto& [l, u] :
               {std::pair{0.0, infinity}, {-infinity, 1.0}, {-1.0, 2.0}, {-infinity, infinity}, std::pair{0.5, 0.5}})
            EXPECT_EQ(box_value(fischer_burmeister_value, l, u, x, F), box_row(phi, l, u, x, F, 1, 1).phi)
                << l << " " << u << " " << x << " " << F;
        }
}

}  // namespace
}  // namespace perp::lcp
