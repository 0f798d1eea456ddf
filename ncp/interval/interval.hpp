// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Intervals of real numbers, with ends that are rounded outward: for every operation f and all a in A, b in B where f
/// is defined, f(a, b) lies in f(A, B). Sums and products are rounded by their exact errors (Knuth's two-sum, and the
/// fused multiply-add), the elementary functions by MPFI. No rounding mode is changed, so any compiler's code is right.
/// Reference: Moore, Kearfott & Cloud, Introduction to Interval Analysis (SIAM 2009), chapters 2 to 5.
#include <limits>

namespace perp::ncp {

/// {x : lower <= x <= upper}; an end of -inf or +inf is no member. Empty where an end is NaN.
struct Interval {
  double lower = 0;
  double upper = 0;

  constexpr Interval() = default;
  constexpr Interval(double x) : lower(x), upper(x) {}  // NOLINT(google-explicit-constructor): numbers are intervals
  constexpr Interval(double from, double to) : lower(from), upper(to) {}
  static constexpr Interval all() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  static constexpr Interval empty() {
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  }

  bool is_empty() const { return !(lower <= upper); }
  bool is_point() const { return lower == upper; }
  bool bounded() const { return lower - lower == 0 && upper - upper == 0; }
  bool contains(double x) const { return lower <= x && x <= upper; }
  bool within(const Interval& other) const { return other.lower <= lower && upper <= other.upper; }
  /// Within, and with none of its ends.
  bool inside(const Interval& other) const { return other.lower < lower && upper < other.upper; }
  /// max |x|, not rounded: it is one of the ends.
  double magnitude() const;
  friend bool operator==(const Interval&, const Interval&) = default;
};

/// The smallest interval that holds both; the other one where one is empty.
Interval hull(const Interval& a, const Interval& b);
Interval intersection(const Interval& a, const Interval& b);

Interval operator-(const Interval& a);
Interval operator+(const Interval& a, const Interval& b);
Interval operator-(const Interval& a, const Interval& b);
Interval operator*(const Interval& a, const Interval& b);
/// All where 0 is inside of b; b = 0: empty.
Interval operator/(const Interval& a, const Interval& b);
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }

Interval square(const Interval& a);
/// a^b, for a > 0, and for a = 0 <= b, with 0^0 = 1; for every a where b is an integer.
Interval power(const Interval& a, const Interval& b);
Interval minimum(const Interval& a, const Interval& b);
Interval maximum(const Interval& a, const Interval& b);
Interval absolute(const Interval& a);
Interval floor(const Interval& a);
Interval ceil(const Interval& a);

// Of the part of a on which the function is defined; empty if there is none.
Interval sqrt(const Interval& a);
Interval exp(const Interval& a);
Interval log(const Interval& a);
Interval log10(const Interval& a);
Interval sin(const Interval& a);
Interval cos(const Interval& a);
Interval tan(const Interval& a);
Interval asin(const Interval& a);
Interval acos(const Interval& a);
Interval atan(const Interval& a);
Interval sinh(const Interval& a);
Interval cosh(const Interval& a);
Interval tanh(const Interval& a);
Interval asinh(const Interval& a);
Interval acosh(const Interval& a);
Interval atanh(const Interval& a);
/// [-pi, pi] where the half line y = 0 >= x is met: whichever sign 0 has, it is held.
Interval atan2(const Interval& y, const Interval& x);

}  // namespace perp::ncp
