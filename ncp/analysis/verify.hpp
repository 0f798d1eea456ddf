// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Encloses a solution by a proof: Krawczyk's operator on the equations of the variables between their bounds, and the
/// signs of the other F_i.
///
/// Let x be near a solution, L (U) the variables at their lower (upper) bound there and I the others. Let X be a box
/// about x, C about J_II(x)^-1, and J(X) hold every J of a point of X. If
///     K(X) = x - C F_I(x) + (I - C J_II(X)) (X_I - x_I)   lies in the interior of X_I,
/// F_I(l_L, u_U, .) has exactly one zero in X_I (Krawczyk 1969; Moore, Kearfott & Cloud (2009), theorem 8.2). With
///     X_I in the interior of [l_I, u_I],   F_L > 0 and F_U < 0 on all of X,
/// that is exactly one solution of the problem in X: strict complementarity leaves no other sets. Every rounding is
/// accounted for: F and J by intervals (ncp/interval), products of matrices by a priori bounds (Higham, Accuracy and
/// Stability of Numerical Algorithms (2002), section 3.5).
#include <optional>
#include <string>

#include "ncp/problem/mcp.hpp"
#include "ncp/run/result.hpp"

namespace perp::ncp {

struct Verified {
  /// Exactly one solution lies in {y : |y_i - x_i| <= radius_i, l <= y <= u}.
  bool unique = false;
  Vec x{};                ///< the point given, after Newton steps on the equations of I, and the bounds exactly
  Vec radius{};           ///< of x
  Index active = 0;       ///< variables at a bound
  std::string why_not{};  ///< with names and values; empty if unique
  double largest_radius() const { return radius.size() == 0 ? 0 : radius.maxCoeff(); }
};

/// Variables between their bounds up to which it is tried: C is a full matrix.
inline constexpr Index most_verified = 4000;

/// For problems with ranges: affine ones (as their data M and q are evaluated), and models of .nl files. Throws
/// std::invalid_argument if x has not as many finite entries as the problem, std::bad_alloc.
Verified verify(const Mcp& mcp, In x);
/// The same of a result, whose point then is the middle of the box: it has had Newton steps. Not unique where the judge
/// likes the point before better, and the middle does not meet `tol`.
Verified verify(const Mcp& mcp, double tol, Result& result);

}  // namespace perp::ncp
