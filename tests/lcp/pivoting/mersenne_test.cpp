// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/mersenne.hpp"

#include <gtest/gtest.h>

#include <random>

namespace perp::lcp {
namespace {

// Catches a wrong recurrence, an unseeded word, a wrong turn from one round of 624 numbers to the next.
TEST(Mersenne, MakesTheNumbersOfTheStandardLibrary) {
  for (const unsigned seed : {0U, 1U, 5489U, 0xFFFFFFFFU}) {
    std::mt19937 expected(seed);
    Mersenne random(seed);
    for (int k = 0; k < 2000; ++k) ASSERT_EQ(random(), expected()) << "seed " << seed << ", number " << k;
    EXPECT_EQ(std::uniform_real_distribution<double>(0.5, 1.5)(random),
              std::uniform_real_distribution<double>(0.5, 1.5)(expected));
  }
}

}  // namespace
}  // namespace perp::lcp
