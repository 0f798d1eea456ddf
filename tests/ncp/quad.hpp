// SPDX-License-Identifier: Apache-2.0
#pragma once
/// 113 bits and 15 bits of exponent for references: squares of doubles are exact and neither over- nor underflow.
#include <cmath>
#include <limits>

namespace perp::ncp::cases {

#ifdef __SIZEOF_FLOAT128__
__extension__ using Quad = __float128;
inline constexpr bool has_quad = true;
#else
using Quad = long double;
inline constexpr bool has_quad = std::numeric_limits<long double>::digits >= 113;
#endif

inline Quad root(Quad x) {
  if (x <= 0) return 0;
  Quad y = static_cast<Quad>(std::sqrt(static_cast<long double>(x)));
  for (int k = 0; k < 2; ++k) y = (y + x / y) / 2;  // Heron; the first y has at least 53 bits
  return y;
}
inline Quad magnitude(Quad x) { return x < 0 ? -x : x; }

/// A C-function, or a smoothing of one, and its partials.
struct Exact {
  Quad phi, da, db, dmu = 0;
};

/// 1 - x / r,  r^2 = x^2 + rest: a difference that would cancel is multiplied by its conjugate,
///     x - sqrt(x^2 + y) = -y / (x + sqrt(x^2 + y)),  x > 0.
inline Quad one_minus_ratio(Quad x, Quad rest, Quad r) { return x > 0 ? rest / (r * (r + x)) : (r - x) / r; }

/// |value - exact| / |exact|; denormals are spaced by 4.9e-324 whatever their size, and what lies beyond the range
/// comes out as its end (ncp/reformulation/cfunction.hpp).
inline double relative_error(double value, Quad exact) {
  const Quad end = std::numeric_limits<double>::max();
  if (exact > end) exact = end;
  if (exact < -end) exact = -end;
  const Quad room = magnitude(exact) + static_cast<Quad>(std::numeric_limits<double>::denorm_min()) /
                                           static_cast<Quad>(std::numeric_limits<double>::epsilon());
  return static_cast<double>(magnitude(static_cast<Quad>(value) - exact) / room);
}

}  // namespace perp::ncp::cases
