// SPDX-License-Identifier: Apache-2.0
#pragma once
/// std::mt19937 for a few numbers: it fills and twists all of its 624 words before the first one, which takes longer
/// than a short path. Here a word is made when it is needed (Matsumoto & Nishimura, ACM TOMACS 8 (1998) 3). Private to
/// lcp/pivoting/.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace perp::lcp {

class Mersenne {
 public:
  explicit Mersenne(std::uint32_t seed) { word_[0] = seed; }

  /// The numbers of std::mt19937 with this seed.
  std::uint32_t operator()() {
    seed_to(next_ + ahead);
    const std::size_t following = next_ + 1 == words ? 0 : next_ + 1;
    const std::size_t other = next_ + ahead < words ? next_ + ahead : next_ + ahead - words;
    const std::uint32_t mixed = (word_[next_] & 0x80000000U) | (word_[following] & 0x7fffffffU);
    std::uint32_t y = word_[next_] = word_[other] ^ (mixed >> 1U) ^ ((mixed & 1U) != 0 ? 0x9908b0dfU : 0U);
    next_ = following;
    y ^= y >> 11U;
    y ^= (y << 7U) & 0x9d2c5680U;
    y ^= (y << 15U) & 0xefc60000U;
    return y ^ (y >> 18U);
  }
  /// That of std::generate_canonical for doubles: uniform in [0, 1).
  double uniform() {
    const double low = (*this)();
    return std::min((low + 0x1p32 * (*this)()) * 0x1p-64, 1 - 0x1p-53);
  }

 private:
  static constexpr std::size_t words = 624;
  static constexpr std::size_t ahead = 397;

  void seed_to(std::size_t last) {
    for (; seeded_ <= last && seeded_ < words; ++seeded_) {
      const std::uint32_t before = word_[seeded_ - 1];
      word_[seeded_] = 1812433253U * (before ^ (before >> 30U)) + static_cast<std::uint32_t>(seeded_);
    }
  }

  std::array<std::uint32_t, words> word_;  // the first seeded_ of them
  std::size_t seeded_ = 1;
  std::size_t next_ = 0;
};

}  // namespace perp::lcp
