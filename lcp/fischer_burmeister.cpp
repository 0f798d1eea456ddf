// SPDX-License-Identifier: Apache-2.0
#include "lcp/fischer_burmeister.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {
namespace {

/// weight phi_FB.
double value_of(double a, double b, double weight) {
  if (weight == 1) return fischer_burmeister_value(a, b);
  if (std::isnan(a) || std::isnan(b)) return a + b;
  if (a == infinity) return product({weight, saturated(b)});
  if (b == infinity) return product({weight, saturated(a)});
  a = saturated(a);
  b = saturated(b);
  const double least = std::min(a, b);
  if (least == 0) return least;
  return product({weight, least, fischer_burmeister_factor(std::max(a, b), least)});
}

}  // namespace

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
