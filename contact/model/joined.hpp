// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Things that are joined two by two, and the sets they come to. Private to contact/.
#include <algorithm>
#include <numeric>
#include <vector>

#include "lcp/types.hpp"

namespace perp::contact {

class Joined {
 public:
  explicit Joined(lcp::Index things) : parent_(lcp::at(things)) { std::iota(parent_.begin(), parent_.end(), 0); }

  void join(lcp::Index a, lcp::Index b) {
    const int of_a = root(static_cast<int>(a));
    const int of_b = root(static_cast<int>(b));
    parent_[lcp::at(std::max(of_a, of_b))] = std::min(of_a, of_b);
  }
  /// A number for each, that of its set, from 0 in the order of their first members.
  std::vector<int> numbers() {
    std::vector<int> number(parent_.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      const int r = root(static_cast<int>(i));
      if (number[lcp::at(r)] < 0) number[lcp::at(r)] = count++;
      number[i] = number[lcp::at(r)];
    }
    return number;
  }

 private:
  int root(int i) {
    while (parent_[lcp::at(i)] != i) i = parent_[lcp::at(i)] = parent_[lcp::at(parent_[lcp::at(i)])];
    return i;
  }
  std::vector<int> parent_;
};

}  // namespace perp::contact
