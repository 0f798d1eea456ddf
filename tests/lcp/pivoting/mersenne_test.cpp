// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/mersenne.hpp"

#include <gtest/gtest.h>

#include <random>

namespace perp::lcp {
namespace {

// Against the standard library's, beyond the first round of all words.
TEST(Mersenne, GivesTheNumbersOfTheStandardsEngine) {
  for (const unsigned seed : {0U, 1U, 5489U, 4294967295U}) {
    std::mt19937 standard(seed);
    Mersenne ours(seed);
    for (int k = 0; k < 2000; ++k) ASSERT_EQ(ours(), standard()) << seed << ' ' << k;
    for (int k = 0; k < 1000; ++k)
      ASSERT_EQ(0.5 + ours.uniform(), std::uniform_real_distribution<double>(0.5, 1.5)(standard)) << seed << ' ' << k;
  }
}

}  // namespace
}  // namespace perp::lcp
