// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sums of doubles and of products of two doubles without rounding: the value to the nearest double, and the sign.
///     a + b = s + e,  s = fl(a + b)      (two_sum; Knuth, TAOCP 2, 4.2.2)
///     a b   = p + e,  p = fl(a b)        (two_product, by a fused multiply-add; exact for |p| >= 2^-968 or p = 0 = e)
/// A sum is kept as an expansion, doubles whose digits do not overlap, added up exactly, smallest first. The sign of an
/// expansion is that of its largest entry. References: Shewchuk, Discrete Comput. Geom. 18 (1997) 305 (growing and
/// compressing expansions); Python's math.fsum (rounding the expansion). Private to the libraries.
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace perp::lcp {

struct TwoParts {
  double value;  ///< rounded
  double error;  ///< what the rounding took away
};

/// a + b without rounding; any order of sizes. Pre: a + b does not overflow.
inline TwoParts two_sum(double a, double b) {
  const double s = a + b;
  const double t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}

/// a b without rounding where |a b| >= 2^-968 or one of them is 0, and a b does not overflow.
inline TwoParts two_product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

/// A sum that is exact as long as exact() says so: nothing overflowed, and no product lost digits below the range.
class ExactSum {
 public:
  void add(double a) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const TwoParts sum = two_sum(a, parts_[i]);
      if (sum.error != 0) parts_[kept++] = sum.error;
      a = sum.value;
    }
    size_ = kept;
    if (!std::isfinite(a)) exact_ = false;
    if (a == 0) return;
    if (size_ == parts_.size()) compress();
    parts_[size_++] = a;
  }

  void add_product(double a, double b) {
    const TwoParts product = two_product(a, b);
    if (!(std::abs(product.value) >= 0x1p-968) && a != 0 && b != 0) exact_ = false;
    if (product.error != 0) add(product.error);
    add(product.value);
  }

  /// The sum, rounded to the nearest double, ties to even. Not a number to rely on if !exact().
  double value() const {
    if (size_ == 0) return 0;
    std::size_t i = size_ - 1;
    TwoParts sum{parts_[i], 0};
    while (i > 0 && sum.error == 0) sum = two_sum(sum.value, parts_[--i]);
    // A tie was rounded to even; what is left below decides on which side of it the sum is.
    const bool same_side = i > 0 && ((sum.error < 0) == (parts_[i - 1] < 0));
    const double twice = 2 * sum.error;
    const double moved = sum.value + twice;
    return same_side && moved - sum.value == twice ? moved : sum.value;
  }

  /// -1, 0 or 1: of the exact sum.
  int sign() const {
    if (size_ == 0) return 0;
    return parts_[size_ - 1] > 0 ? 1 : -1;
  }

  bool exact() const { return exact_; }

 private:
  /// The same sum in parts 52 digits apart: at most 41 of them cover all exponents, so there is always room.
  void compress() {
    std::size_t bottom = size_ - 1;
    double high = parts_[bottom];
    for (std::size_t i = size_ - 1; i-- > 0;) {
      const TwoParts sum = two_sum(high, parts_[i]);
      if (sum.error == 0) {
        high = sum.value;
        continue;
      }
      parts_[bottom--] = sum.value;
      high = sum.error;
    }
    std::size_t kept = 0;
    if (high != 0) parts_[kept++] = high;
    for (std::size_t i = bottom + 1; i < size_; ++i) parts_[kept++] = parts_[i];
    size_ = kept;
  }

  std::array<double, 64> parts_;  ///< the first size_: increasing, not overlapping, none 0
  std::size_t size_ = 0;
  bool exact_ = true;
};

/// The double that a sum in three doubles rounds to, and not 0 if it is not surely the one nearest to what the sum
/// approximates: `errors` is the sum of the sizes of what was added up in `low`, in `terms` + 1 steps.
struct Settled {
  double value;
  double doubt;
};
inline Settled settled(double sum, double middle, double low, double errors, int terms) {
  TwoParts rest = two_sum(middle, low);
  TwoParts high = two_sum(sum, rest.value);
  rest = two_sum(high.error, rest.error);
  high = two_sum(high.value, rest.value);
  const double value = high.value + 0.0;  // no -0
  // Rounding is monotone: the sum is between two numbers that both round to `value`.
  const double rounded = (terms + 1) * errors;  // the sum of what was rounded to 53 digits, low at every step
  const double off = (std::abs(rest.error) + 0x1p-51 * (rounded + std::abs(high.error))) * (1 + 0x1p-50);
  const double above = value + (high.error + off), below = value + (high.error - off);
  return {value, (std::abs(above - value) + std::abs(below - value)) * (1 + 0x1p-50)};
}

/// A sum in three doubles, without a branch a term, that knows what it may be off by: mostly little enough to say which
/// double is the nearest one, also where the terms cancel to their last digits.
class TripleSum {
 public:
  explicit TripleSum(double first) : sum_(first) {}

  void add_product(double a, double b) {
    const TwoParts product = two_product(a, b);
    const TwoParts high = two_sum(sum_, product.value);
    const TwoParts middle = two_sum(middle_, high.error);
    const TwoParts low = two_sum(middle.value, product.error);
    const double errors = middle.error + low.error;
    sum_ = high.value;
    middle_ = low.value;
    low_ += errors;
    errors_ += std::abs(errors);
    ++terms_;
    if (!(std::abs(product.value) >= 0x1p-968) && a != 0 && b != 0) in_range_ = false;
  }

  /// Whether value() is that of an ExactSum of the same terms. False for sums that are not finite, too.
  bool settle() {
    const Settled at = settled(sum_, middle_, low_, errors_, terms_);
    sum_ = at.value;
    if (in_range_ && at.doubt < 0x1p1000) doubt_ = at.doubt;
    return doubt_ == 0;
  }
  double value() const { return sum_; }
  /// After settle(): bounds |sum - value()| by doubt() + 2^-52 |value()|; infinite where products lost digits below the
  /// range or overflowed.
  double doubt() const { return doubt_; }

 private:
  double sum_, middle_ = 0, low_ = 0;
  double errors_ = 0;  // of what low_ is the sum of, the sizes
  double doubt_ = std::numeric_limits<double>::infinity();
  int terms_ = 0;
  bool in_range_ = true;
};

/// TripleSums side by side, in arrays that compilers add up by vector instructions, which have no fused multiply-add
/// everywhere: products are those of Dekker, Numer. Math. 18 (1971) 224, with halves of 26 digits.
template <std::size_t width>
class TripleSums {
 public:
  /// Begins the first `count` sums.
  TripleSums(const double* first, std::size_t count) : count_(count) {
    for (std::size_t i = 0; i < count_; ++i) {
      sum_[i] = first[i];
      size_[i] = std::abs(first[i]);
      middle_[i] = low_[i] = errors_[i] = lost_[i] = 0;
    }
  }

  /// Adds a_i b to sum i. Pre: b != 0.
  void add_products(const double* a, double b) {
    constexpr double splitter = 0x1p27 + 1;
    const double large = splitter * b, b_high = large - (large - b), b_low = b - b_high;
    for (std::size_t i = 0; i < count_; ++i) {
      const double t = splitter * a[i], high = t - (t - a[i]), low = a[i] - high;
      const double p = a[i] * b;
      const double e = ((high * b_high - p) + high * b_low + low * b_high) + low * b_low;
      const TwoParts sum = two_sum(sum_[i], p), middle = two_sum(middle_[i], sum.error),
                     least = two_sum(middle.value, e);
      const double errors = middle.error + least.error;
      sum_[i] = sum.value;
      middle_[i] = least.value;
      low_[i] += errors;
      errors_[i] += std::abs(errors);
      size_[i] += std::abs(p);
      lost_[i] += std::abs(p) < 0x1p-968 ? std::abs(a[i]) : 0.0;
    }
    ++terms_;
  }

  void settle() {
    for (std::size_t i = 0; i < count_; ++i) {
      const Settled at = settled(sum_[i], middle_[i], low_[i], errors_[i], terms_);
      sum_[i] = at.value;
      lost_[i] += at.doubt;
    }
  }
  /// After settle(): whether value(i) is that of an ExactSum.
  bool settled_at(std::size_t i) const { return lost_[i] == 0; }
  double value(std::size_t i) const { return sum_[i]; }
  /// The sum of the sizes of the terms, rounded.
  double size(std::size_t i) const { return size_[i]; }

 private:
  std::size_t count_;
  int terms_ = 0;
  std::array<double, width> sum_, middle_, low_, errors_, size_;
  std::array<double, width> lost_;  ///< not 0: a product lost digits below the range
};

}  // namespace perp::lcp
