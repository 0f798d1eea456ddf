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
  }
}

// 64 bits of two words, the low one first. The library's own distributions differ from one to another.
TEST(Mersenne, UniformNumbersAreOfTwoWords) {
  std::mt19937 standard(1);
  Mersenne ours(1);
  for (int k = 0; k < 1000; ++k) {
    const auto low = static_cast<double>(standard());
    const auto high = static_cast<double>(standard());
    ASSERT_EQ(ours.uniform(), (low + 4294967296.0 * high) / 18446744073709551616.0) << k;
  }
}

}  // namespace
}  // namespace perp::lcp
