// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random numbers that are the same on every platform (the distributions of <random> are not). Private to the
/// collection.
#include <random>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp::collection {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  /// In 0, ..., n - 1.
  Index below(Index n) { return static_cast<Index>(uniform(0, static_cast<double>(n))); }
  /// A permutation of 0, ..., n - 1.
  std::vector<Index> order(Index n) {
    std::vector<Index> made(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) {
      const Index j = below(i + 1);
      made[static_cast<std::size_t>(i)] = made[static_cast<std::size_t>(j)];
      made[static_cast<std::size_t>(j)] = i;
    }
    return made;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace perp::ncp::collection
