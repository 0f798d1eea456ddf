// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the programs that time things share.
#include <algorithm>
#include <chrono>
#include <vector>

namespace perp::bench {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The least of up to three times of `what` [s]; what takes longer than 2 s is timed once.
template <class What>
double least_seconds(What what) {
  constexpr double long_enough = 2;
  double least = 0;
  for (int k = 0; k < 3 && (k == 0 || least < long_enough); ++k) {
    const auto begin = Clock::now();
    what();
    const double seconds = seconds_since(begin);
    least = k == 0 ? seconds : std::min(least, seconds);
  }
  return least;
}

/// Pre: there are values, none of them NaN.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace perp::bench
