// SPDX-License-Identifier: Apache-2.0
#pragma once
/// phi_FB(a, b) = a + b - sqrt(a^2 + b^2), zero iff a >= 0, b >= 0, ab = 0 (Fischer 1992; the sign of the minimum), and
/// the row of a box [l, u] by Billups' composition (1995, section 3.2), for it and other C-functions:
///     free: F    only l: phi(x - l, F)    only u: -phi(u - x, -F)    both: phi(x - l, -phi(u - x, -F))    fixed: x -
///     l.
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

/// phi_FB alone, the same double.
double fischer_burmeister_value(double a, double b);

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
