// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Arithmetic that neither overflows to an infinity nor underflows to zero.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace perp::lcp {

inline constexpr double largest = std::numeric_limits<double>::max();
inline constexpr double least_positive = std::numeric_limits<double>::denorm_min();

/// +-inf becomes +-1.8e308.
inline double saturated(double x) { return std::clamp(x, -largest, largest); }

/// m 2^e, the largest or smallest double of its sign where it leaves the range.
inline double wide_ldexp(double m, int e) {
  const double x = std::ldexp(m, e);
  return x == 0 && m != 0 ? std::copysign(least_positive, m) : saturated(x);
}

/// m 2^e with 1/2 <= |m| < 1, or m = 0.
struct Wide {
  double m = 0;
  int e = 0;
  double value() const { return wide_ldexp(m, e); }
};

/// Of finite factors, with a rounding each.
inline Wide wide_product(std::initializer_list<double> factors) {
  Wide p{.m = 1, .e = 0};
  for (const double f : factors) {
    int of_factor = 0;
    int carry = 0;
    const double m = p.m * std::frexp(f, &of_factor);
    p.m = std::frexp(m, &carry);
    p.e += of_factor + carry;
  }
  return p;
}

inline double product(std::initializer_list<double> factors) { return wide_product(factors).value(); }

}  // namespace perp::lcp
