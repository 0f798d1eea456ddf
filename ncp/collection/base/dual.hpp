// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Dual numbers (ncp/problem/dual.hpp), with what the collection's functions need beside them. Private to the
/// collection.
#include "ncp/problem/dual.hpp"

namespace perp::ncp::collection {

/// The value alone, for domain tests and scalings that must not be differentiated.
inline double value(double u) { return u; }
inline double value(const Dual& u) { return u.v; }

}  // namespace perp::ncp::collection
