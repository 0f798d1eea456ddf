// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sums and products of doubles without rounding: the number is the sum of a few doubles that do not overlap, smallest
/// first (Shewchuk, Discrete Comput. Geom. 18 (1997) 305, theorem 10; Dekker 1971 for the product). What a product may
/// have lost below the smallest double is counted in lost(); after an overflow finite() is false. Private to contact/.
#include <cmath>
#include <limits>
#include <vector>

#include "lcp/exact_sum.hpp"

namespace perp::contact {

/// More than the rounding of the few operations that follow exact sums, and less than the smallest normal number they
/// can lose.
inline constexpr double last_roundings = 1e-14;
inline constexpr double eps = std::numeric_limits<double>::epsilon();

class Expansion {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (const double part : parts_) {
      const lcp::TwoParts sum = lcp::two_sum(x, part);
      if (sum.error != 0) parts_[kept++] = sum.error;
      x = sum.value;
    }
    parts_.resize(kept);
    if (x != 0 || parts_.empty()) parts_.push_back(x);
  }

  void add_product(double a, double b) {
    if (a == 0 || b == 0) return;
    const lcp::TwoParts product = lcp::two_product(a, b);
    const bool whole = std::abs(b) < 0x1p53 && b == std::trunc(b);  // then no bit is below the smallest double
    if (std::abs(product.value) < 0x1p-960 && !whole) lost_ += 0x1p-1073;
    add(product.error);
    add(product.value);
  }

  void add_product(const Expansion& a, const Expansion& b) {
    for (const double x : a.parts_)
      for (const double y : b.parts_) add_product(x, y);
    lost_ += a.lost_ + b.lost_;  // only whether it is zero counts: those who ask first scale their factors to about 1
  }

  /// Times 2^k; what falls below the smallest double is lost.
  Expansion scaled(int k) const {
    Expansion out;
    out.lost_ = std::ldexp(lost_, k);
    for (const double part : parts_) {
      const double moved = std::ldexp(part, k);
      if (std::ldexp(moved, -k) != part) out.lost_ += 0x1p-1073;
      out.add(moved);
    }
    return out;
  }

  void negate() {
    for (double& part : parts_) part = -part;
  }

  /// To 2 eps of itself, but for lost().
  double value() const {
    double sum = 0;
    for (const double part : parts_) sum += part;
    return sum;
  }
  int sign() const { return parts_.empty() || parts_.back() == 0 ? 0 : parts_.back() > 0 ? 1 : -1; }
  double lost() const { return lost_; }
  bool finite() const { return parts_.empty() || std::isfinite(parts_.back()); }

 private:
  std::vector<double> parts_;
  double lost_ = 0;
};

}  // namespace perp::contact
