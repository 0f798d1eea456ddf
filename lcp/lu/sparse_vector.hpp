// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A vector of R^n with the list of its nonzeros, for results that have few of them. Past n/5 of them the list is given
/// up: then any entry may be nonzero, and full() is true.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

class SparseVector {
 public:
  explicit SparseVector(Index n = 0) : values_(Vec::Zero(n)), listed_(static_cast<std::size_t>(n), false) {
    places_.reserve(static_cast<std::size_t>(std::min(n / 5 + 1, most_at_once)));
  }

  Index size() const { return values_.size(); }
  const Vec& values() const { return values_; }
  double operator[](Index i) const { return values_[i]; }
  bool full() const { return full_; }
  /// The places that may be nonzero, each once, in any order. Pre: not full().
  const std::vector<int>& places() const { return places_; }

  void clear() {  // O(places)
    if (full_) {
      values_.setZero();
      std::fill(listed_.begin(), listed_.end(), false);
    } else {
      for (const int i : places_) {
        values_[i] = 0;
        listed_[static_cast<std::size_t>(i)] = false;
      }
    }
    places_.clear();
    full_ = false;
  }
  void add(Index i, double v) {
    values_[i] += v;
    list(i);
  }
  void set(Index i, double v) {
    values_[i] = v;
    list(i);
  }
  /// Adds i to the places.
  void list(Index i) {
    if (full_ || listed_[static_cast<std::size_t>(i)]) return;
    listed_[static_cast<std::size_t>(i)] = true;
    places_.push_back(static_cast<int>(i));
    if (5 * static_cast<Index>(places_.size()) > size()) full_ = true;
  }
  bool listed(Index i) const { return listed_[static_cast<std::size_t>(i)]; }
  void set_full() { full_ = true; }
  /// The numbers, for code that writes them in place and lists what it writes.
  double* data() { return values_.data(); }

  void assign(In b) {
    clear();
    values_ = b;
    full_ = true;
  }

  /// The largest size of an entry; NaN or infinite if some entry is.
  double largest() const {
    double found = 0;
    if (full_) {
      if (values_.size() == 0) return 0;
      found = values_.cwiseAbs().maxCoeff();
      const bool finite = std::isfinite(values_.sum()) || values_.allFinite();  // the sum may overflow
      return finite ? found : std::numeric_limits<double>::quiet_NaN();
    }
    for (const int i : places_) {
      if (!std::isfinite(values_[i])) return std::numeric_limits<double>::quiet_NaN();
      found = std::max(found, std::abs(values_[i]));
    }
    return found;
  }

  /// f(i, value) for every place that may be nonzero.
  template <class F>
  void for_each(F f) const {
    if (full_) {
      for (Index i = 0; i < size(); ++i)
        if (values_[i] != 0) f(i, values_[i]);
    } else {
      for (const int i : places_) f(Index{i}, values_[i]);
    }
  }

 private:
  static constexpr Index most_at_once = 1000;  // places made room for in advance

  Vec values_;
  std::vector<int> places_;
  std::vector<char> listed_;
  bool full_ = false;
};

}  // namespace perp::lcp
