// SPDX-License-Identifier: Apache-2.0
#pragma once
/// phi_FB(a, b) = a + b - sqrt(a^2 + b^2), zero iff a >= 0, b >= 0, ab = 0 (Fischer 1992; the sign of the minimum), and
/// the row of a box [l, u] by Billups' composition (1995, section 3.2), for it and other C-functions:
///     free: F    only l: phi(x - l, F)    only u: -phi(u - x, -F)    both: phi(x - l, -phi(u - x, -F))    fixed: x -
///     l.
#include <algorithm>
#include <cmath>

#include "lcp/types.hpp"
#include "lcp/wide_arithmetic.hpp"

namespace perp::lcp {

struct CValue {
  double phi = 0;
  double da = 0;  ///< d phi / da; at a kink an element of the B-subdifferential
  double db = 0;
};

/// weight phi_FB(a, b), and the partials of phi_FB: without cancellation, overflow or underflow. At (0, 0) the limit of
/// the partials along (ha, hb).
CValue fischer_burmeister(double a, double b, double ha, double hb, double weight = 1);

/// sqrt(1 + q^2) for 0 <= q <= 1, where nothing overflows and hypot's care would cost most of the function's time.
inline double unit_root(double q) { return std::sqrt(1 + q * q); }

/// phi_FB(a, b) / min(a, b), as a sum of positive terms of order one, at least 0.58: no cancellation, overflow or
/// underflow.
inline double fischer_burmeister_factor(double most, double least) {
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

/// phi_FB alone, the same double.
inline double fischer_burmeister_value(double a, double b) {
  if (std::abs(a) < infinity && std::abs(b) < infinity) {
    const double least = std::min(a, b);
    return least == 0 ? least : saturated(least * fischer_burmeister_factor(std::max(a, b), least));
  }
  if (std::isnan(a) || std::isnan(b)) return a + b;
  if (a == infinity) return saturated(b);
  if (b == infinity) return saturated(a);
  return fischer_burmeister_value(saturated(a), saturated(b));  // at least one is -inf
}

/// The row's value alone. phi(a, b): a C-function.
template <class Phi>
double box_value(const Phi& phi, double l, double u, double x, double F) {
  if (l == u) return saturated(x - l);
  const bool has_lower = l > -infinity;
  const bool has_upper = u < infinity;
  if (!has_lower && !has_upper) return F;
  if (!has_upper) return phi(x - l, F);
  const double upper = -phi(u - x, -F);
  return has_lower ? phi(x - l, upper) : upper;
}

/// The row and its partials in x and F, at kinks those along (hx, hF). phi(a, b, ha, hb): a C-function.
template <class Phi>
CValue box_row(const Phi& phi, double l, double u, double x, double F, double hx, double hF) {
  if (l == u) return {saturated(x - l), 1, 0};
  const bool has_lower = l > -infinity;
  const bool has_upper = u < infinity;
  if (!has_lower && !has_upper) return {F, 0, 1};
  if (!has_upper) return phi(x - l, F, hx, hF);
  const CValue upper = phi(u - x, -F, -hx, -hF);
  // d(-phi(u - x, -F)) = da dx + db dF
  if (!has_lower) return {-upper.phi, upper.da, upper.db};
  const CValue both = phi(x - l, -upper.phi, hx, upper.da * hx + upper.db * hF);
  return {both.phi, saturated(both.da + both.db * upper.da), saturated(both.db * upper.db)};
}

}  // namespace perp::lcp
