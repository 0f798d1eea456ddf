// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Vectors of about twice the working precision. Private to the libraries.
#include <utility>

#include "lcp/exact_sum.hpp"
#include "lcp/types.hpp"

namespace perp::lcp {

/// value + rest, |rest| <= eps |value| entry by entry.
struct TwoPartVector {
  TwoPartVector() = default;
  explicit TwoPartVector(Vec v) : value(std::move(v)), rest(Vec::Zero(value.size())) {}

  Index size() const { return value.size(); }
  void add(Index i, double a) {
    const TwoParts low = two_sum(rest[i], a);
    const TwoParts sum = two_sum(value[i], low.value);
    value[i] = sum.value;
    rest[i] = sum.error + low.error;
  }
  void add_product(Index i, double a, double b) {
    const TwoParts product = two_product(a, b);
    add(i, product.value);
    add(i, product.error);
  }
  /// + A x
  void add_product(const SpMat& A, const TwoPartVector& x) {
    for (Index j = 0; j < A.cols(); ++j) {
      if (x.value[j] == 0) continue;
      for (SpMat::InnerIterator it(A, j); it; ++it) {
        add_product(it.row(), it.value(), x.value[j]);
        if (x.rest[j] != 0) add_product(it.row(), it.value(), x.rest[j]);
      }
    }
  }
  /// + A' x
  void add_transposed_product(const SpMat& A, const TwoPartVector& x) {
    for (Index j = 0; j < A.cols(); ++j)
      for (SpMat::InnerIterator it(A, j); it; ++it) {
        add_product(j, it.value(), x.value[it.row()]);
        add_product(j, it.value(), x.rest[it.row()]);
      }
  }

  Vec value;
  Vec rest;
};

}  // namespace perp::lcp
