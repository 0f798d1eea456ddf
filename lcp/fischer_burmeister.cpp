// SPDX-License-Identifier: Apache-2.0
#include "lcp/fischer_burmeister.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {
namespace {

/// sqrt(1 + q^2) for 0 <= q <= 1, where nothing overflows and hypot's care would cost most of the function's time.
double unit_root(double q) { return std::sqrt(1 + q * q); }

/// phi_FB(a, b) / min(a, b), as a sum of positive terms of order one: no cancellation, overflow or underflow.
double fischer_burmeister_factor(double most, double least) {
  if (least > 0) {  // ab > 0: phi = 2 ab / (a + b + r)
    const double q = least / most;
    return 2 / (1 + q + unit_root(q));
  }
  if (most <= 0) {
    const double q = most / least;
    return 1 + q + unit_root(q);
  }
  // most - r = -least^2 / (most + r)
  if (most >= -least) {
    const double q = -least / most;
    return 1 + q / (1 + unit_root(q));
  }
  const double q = most / -least;
  return 1 + 1 / (q + unit_root(q));
}

}  // namespace

double fischer_burmeister_value(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return a + b;
  if (a == infinity) return saturated(b);
  if (b == infinity) return saturated(a);
  a = saturated(a);
  b = saturated(b);
  const double least = std::min(a, b);
  return least == 0 ? least : saturated(least * fischer_burmeister_factor(std::max(a, b), least));
}

CValue fischer_burmeister(double a, double b, double ha, double hb, double weight) {
  if (std::isnan(a) || std::isnan(b)) return {a + b, a + b, a + b};
  if (a == infinity) return {product({weight, saturated(b)}), 0, 1};
  if (b == infinity) return {product({weight, saturated(a)}), 1, 0};
  a = saturated(a);
  b = saturated(b);
  const double size = std::max(std::abs(a), std::abs(b));
  if (size == 0) {
    const double h = std::hypot(ha, hb);
    if (!(h > 0) || !std::isfinite(h)) return {0, 1 - std::sqrt(0.5), 1 - std::sqrt(0.5)};  // the limit along a = b > 0
    return {0, 1 - ha / h, 1 - hb / h};
  }
  const double least = std::min(a, b);
  double phi = least;
  if (least != 0) {
    const double factor = fischer_burmeister_factor(std::max(a, b), least);  // at least 0.58
    phi = weight == 1 ? saturated(least * factor) : product({weight, least, factor});
  }
  // The partials 1 - c and 1 - s of c = a / r and s = b / r, with a, b brought where r neither over- nor underflows.
  const double x = a / size;
  const double y = b / size;
  const double r = std::sqrt(x * x + y * y);
  const double c = x / r;
  const double s = y / r;
  const auto one_minus = [](double p, double q) { return p > 0 ? q * q / (1 + p) : 1 - p; };  // p^2 + q^2 = 1
  return {phi, one_minus(c, s), one_minus(s, c)};
}

}  // namespace perp::lcp
