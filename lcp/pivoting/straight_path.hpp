// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The path of lemke.hpp where it meets no bound before t = 1: one segment, from the start to the zero of the linear
/// piece of its cell. Near a solution of a nonlinear problem most paths are of this kind. They need no basis, no
/// perturbation and none of the units in which pivots are compared.
#include <optional>

#include "lcp/pivoting/lemke.hpp"

namespace perp::lcp {

/// What lemke() finds from a regular start, by one factorization of M_II with I the variables inside:
///     z_I = z_I - M_II^-1 (M z + q)_I,  z_O at its bounds,  x = z - (M z + q) on O.
/// Nothing where x leaves the cell, by more than rounding, or where M_II is nearly singular: the path has pivots then,
/// or begins with artificials. `lu` is to live as long as the result's last_piece. Throws as lemke() does.
/// *left_by, if it is asked for, becomes the number of variables that leave the cell with x, where M_II is regular.
std::optional<PivotResult> straight_path(const AffineMcp& problem, In start, const LemkeOptions& options, SharedLu& lu,
                                         Index* left_by = nullptr);

}  // namespace perp::lcp
