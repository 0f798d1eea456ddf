// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random numbers that are the same everywhere: the standard fixes the engine std::mt19937, but not its distributions.
#include <random>

namespace perp::contact {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  /// Uniform in [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }

 private:
  std::mt19937 engine_;
};

}  // namespace perp::contact
