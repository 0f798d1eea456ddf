// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What searches remember of the merits they have met. Private to Perp.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

/// The reference values of a non-monotone line search: the last merits, so many of them.
class Memory {
 public:
  explicit Memory(int size) : size_(static_cast<std::size_t>(std::max(1, size))) {}
  void push(double merit) {
    if (last_.size() == size_) last_.erase(last_.begin());
    last_.push_back(merit);
  }
  void reset(double merit) { last_.assign(1, merit); }
  double reference() const { return *std::max_element(last_.begin(), last_.end()); }

 private:
  std::size_t size_;
  std::vector<double> last_;
};

/// Tells a run that gets nowhere: the best merit has not come down to `factor` of what it was within `window`
/// iterations; `first`: before them.
class Stall {
 public:
  explicit Stall(int window = 60, double factor = 0.99, double first = infinity)
      : window_(window), factor_(factor), best_(first), mark_(first) {}
  bool stalled(double merit) { return stalled(merit, window_); }
  /// With another window.
  bool stalled(double merit, int window) {
    best_ = std::min(best_, merit);
    if (best_ < factor_ * mark_) {
      mark_ = best_;
      since_ = 0;
    }
    return ++since_ > window;
  }

 private:
  int window_;
  double factor_;
  double best_;
  double mark_;  // best_ at the begin of the window
  int since_ = 0;
};

}  // namespace perp::lcp
