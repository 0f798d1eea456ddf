// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Eigen's sparse LU, made safe where memory ends: the only place that may include it. Private to lcp/lu/.
#include <Eigen/OrderingMethods>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "lcp/types.hpp"

namespace perp::lcp {
/// Not int: the factors may have more than 2^31 entries. Not Eigen's Index either, see below.
using LuIndex = long long;

}  // namespace perp::lcp

namespace Eigen::internal {

/// Eigen 3.4 resizes `vec` in place: where that fails it is left with freed memory, which the next attempt, or the
/// destructor, frees again. This specialization leaves it whole and throws std::bad_alloc. That no other part of a
/// program factors with this type of index keeps Eigen's own version out of the way.
template <>
template <typename VectorType>
Index SparseLUImpl<double, perp::lcp::LuIndex>::expand(VectorType& vec, Index& length, Index used, Index keep_length,
                                                       Index& expansions) {
  if (expansions == 0) vec.resize(0);  // of the factorization before
  const Index enough = expansions == 0 || keep_length ? length : std::max(length + 1, length + length / 2);
  VectorType longer(enough);
  longer.head(used) = vec.head(used);
  vec.swap(longer);
  length = enough;
  if (expansions > 0) ++expansions;
  return 0;
}

}  // namespace Eigen::internal
