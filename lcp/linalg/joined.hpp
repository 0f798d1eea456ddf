// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Things that are joined two by two, and the sets they come to (union-find: Tarjan, J. ACM 22 (1975) 215).
#include <algorithm>
#include <numeric>
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

class Joined {
 public:
  explicit Joined(Index things) : parent_(at(things)) { std::iota(parent_.begin(), parent_.end(), 0); }

  void join(Index a, Index b) {
    const int of_a = root(static_cast<int>(a));
    const int of_b = root(static_cast<int>(b));
    parent_[at(std::max(of_a, of_b))] = std::min(of_a, of_b);
  }
  /// A number for each, that of its set, from 0 in the order of their first members.
  std::vector<int> numbers() {
    std::vector<int> number(parent_.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      const int r = root(static_cast<int>(i));
      if (number[at(r)] < 0) number[at(r)] = count++;
      number[i] = number[at(r)];
    }
    return number;
  }

 private:
  int root(int i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }
  std::vector<int> parent_;
};

/// Which unknowns a square matrix couples by entries that are not 0, however indirectly: a number for each, the same
/// for these, from 0.
inline std::vector<int> coupled_by(const SpMat& A) {
  Joined unknowns(A.rows());
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (it.value() != 0) unknowns.join(it.row(), j);
  return unknowns.numbers();
}

}  // namespace perp::lcp
