// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Proofs, exact in the doubles given, that an affine MCP has no solution. Included by result.hpp.
///
/// Let z lie in a box Z and w in a box W. If w = M z + q, then y'(M z + q - w) = 0 for every y; so y proves that there
/// are no such z, w if, with g = M'y,
///     sup over Z x W of y'(M z + q - w)  =  q'y + sum_j max(l_j g_j, u_j g_j) - sum_i min(a_i y_i, b_i y_i)  <  0,
/// Z = [l, u], W = [a, b] (Farkas' lemma; Mangasarian 1969, section 2.4). A bound that is infinite must have g_j, y_i
/// of the other sign, or 0. Nothing is rounded: signs and the sum are those of lcp/exact_sum.hpp's expansions, for
/// exponents of the terms of one sum up to 1700 apart.
///
/// For the affine MCP Z is the box, and W what the box says of F = M z + q alone: F_i >= 0 where only l_i is finite,
/// F_i <= 0 where only u_i is, F_i = 0 where neither is, anything where both are. For the LCP: y >= 0, M'y <= 0,
/// q'y < 0.
///
/// Such a y need not be a vector of doubles: where g_j has to be 0, rounding leaves something of either sign. With J
/// the j whose g_j has the wrong sign, but is below 1e-9 sum_i |M_ij y_i|, and the sum above without them, y excludes
/// all solutions with
///     |z|_inf  <  R = -(q'y + ...) / sum_J |g_j|
/// for z of the equilibrated problem (|M_ij|, |q_i| up to about one), infinite if J is empty. Before R is formed, the
/// rounding of y is taken away by a correction d, a second vector of doubles, with (M'd)_J = -g_J: R is about 1e30 if
/// there is a y with g_J = 0 nearby, and at most about 1e17 if there is none, where a solution far out may exist.
#include "lcp/affine_mcp.hpp"
#include "lcp/judge/two_part_vector.hpp"

namespace perp::lcp {

/// The R from which on "no solution" is said.
inline constexpr double proof_radius = 1e22;

/// The radius R that y, or y corrected, excludes; infinity: everywhere; 0: y proves nothing. Also 0 where the exponents
/// of the terms of a sum are more than 1700 apart.
double infeasible_radius(const AffineMcp& problem, In y);

/// Whether it is at least proof_radius.
bool proves_infeasible(const AffineMcp& problem, In y);

/// y, or y corrected, whichever excludes more; empty if none excludes anything.
TwoPartVector certificate_parts(const AffineMcp& problem, In y);

/// The points that y excludes, for y of the signs asked for: with r the natural residual of z,
///     margin <= r (|y|_1 + sum_j |g_j|) + max_J |z_j| sum_J |g_j|,   margin = -(q'y + ...) as above.
struct Exclusion {
  double margin = 0;  ///< 0: nothing
  double wrong = 0;   ///< sum_J |g_j|
  double size = 0;    ///< |y|_1 + sum |g_j| of the other j
};
Exclusion exclusion(const AffineMcp& problem, const TwoPartVector& y);
/// The same for any boxes Z and W (entries of W: 0 or infinite).
Exclusion exclusion(const SpMat& M, In q, const Box& Z, const Box& W, const TwoPartVector& y);

/// A y near the given one that does, of length 1 (but for a factor of two) in the maximum norm; empty if none is found.
/// Tried are y itself and, with the rows of M equilibrated and tiny y_i put to 0: multiples of y whose entries are
/// nearly numbers of few digits, rounded to them (the products are then exact; for data of few digits); y moved so that
/// all these g_j become clearly, though slightly, right (for data of all digits); and y corrected, as above.
/// Empty, too, if a natural residual of `tol` is not excluded.
Vec exact_certificate(const AffineMcp& problem, In y, double tol = 0);

/// The same for any boxes Z and W (entries of W: 0 or infinite) and M of equilibrated rows.
Vec exact_exclusion(const SpMat& M, In q, const Box& Z, const Box& W, In y);
/// The same with its correction, where that is what excludes.
TwoPartVector exclusion_parts(const SpMat& M, In q, const Box& Z, const Box& W, In y);

}  // namespace perp::lcp
