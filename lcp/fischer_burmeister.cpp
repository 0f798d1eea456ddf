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

/// weight phi_FB.
double value_of(double a, double b, double weight) {
  if (std::isnan(a) || std::isnan(b)) return a + b;
  const auto weighted = [weight](double phi) { return weight == 1 ? phi : product({weight, phi}); };
  if (a == infinity) return weighted(saturated(b));
  if (b == infinity) return weighted(saturated(a));
  a = saturated(a);
  b = saturated(b);
  const double least = std::min(a, b);
  if (least == 0) return least;
  const double factor = fischer_burmeister_factor(std::max(a, b), least);  // at least 0.58
  return weight == 1 ? saturated(least * factor) : product({weight, least, factor});
}

}  // namespace

double fischer_burmeister_value(double a, double b) { return value_of(a, b, 1); }

CValue fischer_burmeister(double a, double b, double ha, double hb, double weight) {
  const double phi = value_of(a, b, weight);
  if (std::isnan(a) || std::isnan(b)) return {phi, phi, phi};
  if (a == infinity) return {phi, 0, 1};
  if (b == infinity) return {phi, 1, 0};
  a = saturated(a);
  b = saturated(b);
  const double size = std::max(std::abs(a), std::abs(b));
  if (size == 0) {
    const double h = std::hypot(ha, hb);
    if (!(h > 0) || !std::isfinite(h)) return {0, 1 - std::sqrt(0.5), 1 - std::sqrt(0.5)};  // the limit along a = b > 0
    return {0, 1 - ha / h, 1 - hb / h};
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
