// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Dual numbers (ncp/problem/dual.hpp) and expressions (ncp/interval/expression.hpp), with what the collection's
/// functions need beside them. Private to the collection.
#include <Eigen/Core>

#include "ncp/interval/expression.hpp"
#include "ncp/problem/dual.hpp"

namespace perp::ncp::collection {

/// The value alone, for scalings that must not be differentiated and change nothing: of an expression, which has none,
/// 0.
inline double value(double u) { return u; }
inline double value(const Dual& u) { return u.v; }
inline double value(const Expression&) { return 0; }

/// Tests of the domain. An expression is defined where its operations are, and passes.
template <class T>
bool above(const T& u, double bound) {
  return value(u) > bound;
}
inline bool above(const Expression&, double) { return true; }
template <class T>
bool not_below(const T& u, double bound) {
  return value(u) >= bound;
}
inline bool not_below(const Expression&, double) { return true; }

}  // namespace perp::ncp::collection

/// Vectors and small matrices of expressions.
template <>
struct Eigen::NumTraits<perp::ncp::Expression> : Eigen::GenericNumTraits<perp::ncp::Expression> {
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
