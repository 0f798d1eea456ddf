// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is told of the point that a solve returns, beside its residual. Private to ncp/.
#include <memory>

#include "ncp/run/options.hpp"
#include "ncp/run/result.hpp"

namespace perp::ncp {

/// Sets Result::relative and relative_row, by one evaluation of J at x that no statistics count, and of a solution the
/// notes: what its tolerance excuses although the equation is far from balanced. With T = 1e3 tol,
///   * x_i not at the bound that F_i's sign asks for and |F_i| > T t_i: F_i is small, but so is everything it is made
///   of
///     (and it is more than a change of every x_j by tol max(1, |x_j|) explains);
///   * |F_i| > T, excused by a bound that x_i is near but not at, where the point would be no solution;
///   * |F_i| > T where the bounds of x_i are no further apart than the tolerance.
/// Returns that J, of an affine problem its own; null where it is not defined.
std::shared_ptr<const SpMat> annotate(const Mcp& mcp, const Stop& stop, Result& result);

/// The largest |F_i| / t_i of the rows that no bound excuses, where F_i is more than such a change explains.
double imbalance(const Mcp& mcp, const SpMat& J, In x, In F, double tol);

}  // namespace perp::ncp
