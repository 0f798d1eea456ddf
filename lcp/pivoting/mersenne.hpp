// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The numbers of std::mt19937 (Matsumoto & Nishimura, ACM Trans. Model. Comput. Simul. 8 (1998) 3), each made when it
/// is asked for: short paths want a few of the 624 that the standard library makes at a time. Private to lcp/.
#include <array>
#include <cstddef>
#include <cstdint>

namespace perp::lcp {

class Mersenne {
 public:
  using result_type = std::uint32_t;
  explicit Mersenne(result_type seed) { state_[0] = seed; }
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xFFFFFFFFU; }

  result_type operator()() {
    const std::size_t i = next_;
    next_ = i + 1 < n ? i + 1 : 0;
    const std::size_t far = i + m < n ? i + m : i + m - n;
    seed_up_to(i + m < n ? far : n - 1);
    const result_type y = (state_[i] & 0x80000000U) | (state_[next_] & 0x7FFFFFFFU);
    state_[i] = state_[far] ^ (y >> 1U) ^ ((y & 1U) != 0 ? 0x9908B0DFU : 0U);
    result_type z = state_[i];
    z ^= z >> 11U;
    z ^= (z << 7U) & 0x9D2C5680U;
    z ^= (z << 15U) & 0xEFC60000U;
    return z ^ (z >> 18U);
  }

 private:
  static constexpr std::size_t n = 624;
  static constexpr std::size_t m = 397;

  /// Only the first round finds something left to seed.
  void seed_up_to(std::size_t last) {
    for (; seeded_ <= last; ++seeded_) {
      const result_type before = state_[seeded_ - 1];
      state_[seeded_] = 1812433253U * (before ^ (before >> 30U)) + static_cast<result_type>(seeded_);
    }
  }

  std::array<result_type, n> state_;  ///< the first seeded_
  std::size_t seeded_ = 1;
  std::size_t next_ = 0;
};

}  // namespace perp::lcp
