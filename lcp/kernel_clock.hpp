// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One call into a library that factors looks at no clock. It is begun only if it fits what is left of the time, by its
/// own estimate of the arithmetic and the rate at which the calls before came to theirs.
#include <chrono>
#include <stdexcept>

#include "lcp/types.hpp"

namespace perp::lcp {

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr Deadline no_deadline = Deadline::max();
/// After that time from `begin`, or never where it is longer than the clock counts.
Deadline deadline_after(std::chrono::duration<double> time, Deadline begin = std::chrono::steady_clock::now());

/// What a numeric factorization takes, estimated from the analysis of the pattern; 0 where nothing is known.
struct KernelCost {
  double flops = 0;
  double bytes = 0;
};

/// A call was not begun: "a factorization of 10000 rows takes about 34 s, 3.2 s are left".
class KernelTooLong : public std::runtime_error {
 public:
  KernelTooLong(Index rows, double seconds, double left);
};

class KernelClock {
 public:
  explicit KernelClock(Deadline deadline = no_deadline) : deadline_(deadline) {}
  /// For the calls from now on; the rate stays known.
  void set_deadline(Deadline deadline) { deadline_ = deadline; }
  /// Throws KernelTooLong if the call would end after the deadline, NotEnoughMemory if it does not fit in memory.
  void before(Index rows, const KernelCost& cost);
  /// It has come back. Its rate is the next one's: what the estimates are off by cancels.
  void after(const KernelCost& cost);
  /// The longest call so far [s].
  double longest() const { return longest_; }

 private:
  Deadline deadline_;
  Deadline begin_{};
  double rate_ = 0;  // flops of estimates per second; 0: not met yet
  double longest_ = 0;
};

}  // namespace perp::lcp
