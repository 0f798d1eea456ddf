// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Bodies under bilateral constraints G' v + b = 0 as bodies without: v = v_b + Z y, G' v_b = -b, G' Z = 0,
///     (Z'M Z) y = (Z'H) r + Z'(f - M v_b),   u = (Z'H)' y + w + H' v_b.
/// Z has blocks, one for the velocities that constraints join, however indirectly, by a dense QR factorization of their
/// part of G, in units in which M has a unit diagonal. There Z'Z = 1. Private to contact/.
#include <optional>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// Velocities that are joined, at most: what is dense in them costs more than entries of W beyond.
inline constexpr Index most_joined = 300;

/// The problem in y. Nothing where more than most_joined velocities are joined, G has dependent columns, to rounding,
/// or joins masses so far apart that Z does not hold it, no motion is left, or M is not symmetric bit by bit.
std::optional<Global> free_motions(const Global& global);

}  // namespace perp::contact
