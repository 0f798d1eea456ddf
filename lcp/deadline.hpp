// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Limits of time. They are looked at between two factorizations: a call into a library that factors ends when it ends.
#include <chrono>

namespace perp::lcp {

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr Deadline no_deadline = Deadline::max();

/// Returns begin + time, or no_deadline where that is longer than the clock counts.
inline Deadline deadline_after(std::chrono::duration<double> time, Deadline begin = std::chrono::steady_clock::now()) {
  const std::chrono::duration<double> longest = no_deadline - begin;
  if (!(time < longest)) return no_deadline;
  return begin + std::chrono::duration_cast<Deadline::duration>(time);
}

}  // namespace perp::lcp
