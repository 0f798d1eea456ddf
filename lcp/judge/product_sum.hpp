// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Exact sums of products of up to three doubles. Private to lcp/.
#include <algorithm>
#include <array>
#include <cmath>

#include "lcp/exact_sum.hpp"

namespace perp::lcp {

/// The exact sum of products a b c, whatever their exponents: all are multiplied by one power of two, so that the
/// largest is near 2^900.
class ProductSum {
 public:
  /// To be told of every product first.
  void announce(double a, double b, double c = 1) {
    if (a != 0 && b != 0 && c != 0) top_ = std::max(top_, std::ilogb(a) + std::ilogb(b) + std::ilogb(c));
  }
  void add(double a, double b, double c = 1) {
    if (a == 0 || b == 0 || c == 0) return;
    const std::array exponents{std::ilogb(a), std::ilogb(b), std::ilogb(c)};
    const int shift = exponents[0] + exponents[1] + exponents[2] - top_ + 900;
    if (shift < -800) {  // the last of 159 digits would be lost
      exact_ = false;
      return;
    }
    const TwoParts ab = two_product(std::scalbn(a, -exponents[0]), std::scalbn(b, -exponents[1]));
    const double scaled_c = std::scalbn(c, -exponents[2]);
    for (const double part : {ab.error, ab.value}) sum_.add_product(std::scalbn(part, shift), scaled_c);
  }
  bool exact() const { return exact_ && sum_.exact(); }
  int sign() const { return sum_.sign(); }
  double value() const { return std::scalbn(sum_.value(), top_ - 900); }

 private:
  ExactSum sum_;
  int top_ = -100000;
  bool exact_ = true;
};

}  // namespace perp::lcp
