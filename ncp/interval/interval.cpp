// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/interval.hpp"

#include <mpfi.h>

#include <algorithm>
#include <cmath>

namespace perp::ncp {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
/// Below, the error of a product is no double.
constexpr double least_exact_product = 0x1p-960;

double below(double x) { return std::nextafter(x, -inf); }

/// x + error rounded downward, where x is its nearest double. Near the largest double the error may be no number.
double downward(double x, double error) { return error >= 0 && error < inf ? x : below(x); }

/// Of an overflow: the largest double, unless a term was infinite itself.
double down_from_overflow(double x, bool exact) { return x > 0 && !exact ? std::numeric_limits<double>::max() : x; }

/// a + b - fl(a + b), exactly (Knuth); no finite number where a step overflows.
double error_of_sum(double a, double b, double sum) {
  const double b_there = sum - a;
  const double a_there = sum - b_there;
  return (a - a_there) + (b - b_there);
}

double sum_down(double a, double b) {
  const double sum = a + b;
  if (std::isinf(sum)) return down_from_overflow(sum, std::isinf(a) || std::isinf(b));
  return downward(sum, error_of_sum(a, b, sum));
}

double sum_up(double a, double b) { return -sum_down(-a, -b); }

/// 0 times infinity is 0: the infinity is an end, and no member.
double product_down(double a, double b) {
  if (a == 0 || b == 0) return 0;
  const double product = a * b;
  if (std::isinf(product)) return down_from_overflow(product, std::isinf(a) || std::isinf(b));
  if (std::abs(product) < least_exact_product) return below(product);
  return downward(product, std::fma(a, b, -product));
}

double product_up(double a, double b) { return -product_down(-a, b); }

/// Three numbers of 53 bits for the operations of a thread, so that none of them allocates. The end of the thread frees
/// them, and what MPFR keeps for it.
struct Scratch {
  Scratch() { mpfi_init2(a, 53), mpfi_init2(b, 53), mpfi_init2(result, 53); }
  ~Scratch() {
    mpfi_clear(a), mpfi_clear(b), mpfi_clear(result);
    mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  /// Empty where all there is of it is an infinity, as of atanh at 1.
  Interval value() const {
    const Interval range(mpfr_get_d(&result->left, MPFR_RNDD), mpfr_get_d(&result->right, MPFR_RNDU));
    return range.lower == inf || range.upper == -inf ? Interval::empty() : range;
  }
  mpfi_t a, b, result;
};

Scratch& scratch() {
  thread_local Scratch numbers;
  return numbers;
}

using Unary = int (*)(mpfi_ptr, mpfi_srcptr);
using Binary = int (*)(mpfi_ptr, mpfi_srcptr, mpfi_srcptr);

Interval by_mpfi(Unary function, const Interval& a) {
  if (a.is_empty()) return Interval::empty();
  Scratch& s = scratch();
  mpfi_interv_d(s.a, a.lower, a.upper);
  function(s.result, s.a);
  return s.value();
}

Interval by_mpfi(Binary function, const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty()) return Interval::empty();
  Scratch& s = scratch();
  mpfi_interv_d(s.a, a.lower, a.upper);
  mpfi_interv_d(s.b, b.lower, b.upper);
  function(s.result, s.a, s.b);
  return s.value();
}

/// x^n for x >= 0, rounded; n >= 0.
double integer_power(double x, unsigned long n, mpfr_rnd_t rounding) {
  Scratch& s = scratch();
  mpfr_ptr z = &s.result->left;
  mpfr_set_d(z, x, rounding);
  mpfr_pow_ui(z, z, n, rounding);
  return mpfr_get_d(z, rounding);
}

Interval integer_power(const Interval& a, unsigned long n) {
  const auto of_nonnegative = [n](double from, double to) {
    return Interval(integer_power(from, n, MPFR_RNDD), integer_power(to, n, MPFR_RNDU));
  };
  if (a.lower >= 0) return of_nonnegative(a.lower, a.upper);
  const bool even = n % 2 == 0;
  if (a.upper <= 0) return even ? of_nonnegative(-a.upper, -a.lower) : -of_nonnegative(-a.upper, -a.lower);
  const Interval negative = of_nonnegative(0, -a.lower), positive = of_nonnegative(0, a.upper);
  return even ? hull(negative, positive) : hull(-negative, positive);
}

bool is_integer(const Interval& b) {
  return b.is_point() && std::abs(b.lower) < 0x1p31 && std::rint(b.lower) == b.lower;
}

}  // namespace

double Interval::magnitude() const { return std::max(std::abs(lower), std::abs(upper)); }

Interval hull(const Interval& a, const Interval& b) {
  if (a.is_empty()) return b;
  if (b.is_empty()) return a;
  return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)};
}

Interval intersection(const Interval& a, const Interval& b) {
  const Interval both(std::max(a.lower, b.lower), std::min(a.upper, b.upper));
  return a.is_empty() || b.is_empty() || both.is_empty() ? Interval::empty() : both;
}

Interval operator-(const Interval& a) { return {-a.upper, -a.lower}; }

Interval operator+(const Interval& a, const Interval& b) {
  return {sum_down(a.lower, b.lower), sum_up(a.upper, b.upper)};
}

Interval operator-(const Interval& a, const Interval& b) {
  return {sum_down(a.lower, -b.upper), sum_up(a.upper, -b.lower)};
}

Interval operator*(const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty()) return Interval::empty();
  if (b.is_point() && !a.is_point()) return b * a;
  if (a.is_point() && a.lower >= 0) return {product_down(a.lower, b.lower), product_up(a.lower, b.upper)};
  if (a.is_point()) return {product_down(a.lower, b.upper), product_up(a.lower, b.lower)};
  return {std::min({product_down(a.lower, b.lower), product_down(a.lower, b.upper), product_down(a.upper, b.lower),
                    product_down(a.upper, b.upper)}),
          std::max({product_up(a.lower, b.lower), product_up(a.lower, b.upper), product_up(a.upper, b.lower),
                    product_up(a.upper, b.upper)})};
}

Interval operator/(const Interval& a, const Interval& b) {
  if (b == Interval(0)) return Interval::empty();
  return by_mpfi(mpfi_div, a, b);
}

Interval square(const Interval& a) {
  if (a.is_empty()) return a;
  const double far = a.magnitude();
  const double near = a.contains(0) ? 0 : std::min(std::abs(a.lower), std::abs(a.upper));
  return {std::max(0.0, product_down(near, near)), product_up(far, far)};
}

Interval power(const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty()) return Interval::empty();
  if (is_integer(b)) {
    const Interval p = integer_power(a, static_cast<unsigned long>(std::abs(b.lower)));
    return b.lower >= 0 ? p : Interval(1) / p;
  }
  const bool never_an_integer = b.is_point() && std::rint(b.lower) != b.lower;
  if (a.lower < 0 && !never_an_integer) return Interval::all();
  const Interval base = intersection(a, {0, inf});
  if (base.is_empty()) return base;
  Interval all = base.upper > 0 ? exp(b * log(base)) : Interval::empty();
  if (base.lower == 0 && b.upper > 0) all = hull(Interval(0), all);
  return base.lower == 0 && b.contains(0) ? hull(Interval(1), all) : all;
}

Interval minimum(const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty()) return Interval::empty();
  return {std::min(a.lower, b.lower), std::min(a.upper, b.upper)};
}

Interval maximum(const Interval& a, const Interval& b) { return -minimum(-a, -b); }

Interval absolute(const Interval& a) { return by_mpfi(mpfi_abs, a); }
Interval floor(const Interval& a) { return {std::floor(a.lower), std::floor(a.upper)}; }
Interval ceil(const Interval& a) { return {std::ceil(a.lower), std::ceil(a.upper)}; }

Interval sqrt(const Interval& a) { return by_mpfi(mpfi_sqrt, intersection(a, {0, inf})); }
Interval exp(const Interval& a) { return by_mpfi(mpfi_exp, a); }
Interval log(const Interval& a) {
  return a.upper > 0 ? by_mpfi(mpfi_log, intersection(a, {0, inf})) : Interval::empty();
}
Interval log10(const Interval& a) {
  return a.upper > 0 ? by_mpfi(mpfi_log10, intersection(a, {0, inf})) : Interval::empty();
}
Interval sin(const Interval& a) { return by_mpfi(mpfi_sin, a); }
Interval cos(const Interval& a) { return by_mpfi(mpfi_cos, a); }
Interval tan(const Interval& a) { return by_mpfi(mpfi_tan, a); }
Interval asin(const Interval& a) { return by_mpfi(mpfi_asin, intersection(a, {-1, 1})); }
Interval acos(const Interval& a) { return by_mpfi(mpfi_acos, intersection(a, {-1, 1})); }
Interval atan(const Interval& a) { return by_mpfi(mpfi_atan, a); }
Interval sinh(const Interval& a) { return by_mpfi(mpfi_sinh, a); }
Interval cosh(const Interval& a) { return by_mpfi(mpfi_cosh, a); }
Interval tanh(const Interval& a) { return by_mpfi(mpfi_tanh, a); }
Interval asinh(const Interval& a) { return by_mpfi(mpfi_asinh, a); }
Interval acosh(const Interval& a) { return by_mpfi(mpfi_acosh, intersection(a, {1, inf})); }
Interval atanh(const Interval& a) { return by_mpfi(mpfi_atanh, intersection(a, {-1, 1})); }
Interval atan2(const Interval& y, const Interval& x) {
  // MPFI leaves out pi, the value at y = 0 > x, where y ends at 0.
  constexpr double pi_up = 3.1415926535897936;
  if (y.contains(0) && x.lower <= 0 && !x.is_empty()) return {-pi_up, pi_up};
  return by_mpfi(mpfi_atan2, y, x);
}

}  // namespace perp::ncp
