// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Slips of a modeller's that leave a trace although the model may have a solution: rows that differ from those they
/// should be like. Each finding is rare in sound models; none is a proof. Private to ncp/.
#include <string>
#include <vector>

#include "ncp/explain/explain.hpp"

namespace perp::ncp {

/// Optimality conditions, games with a potential and many markets have |J_ij| = |J_ji|, and J_ij J_ji > 0 exactly where
/// i and j are on the same side: primal variables on one, prices and multipliers on the other. Where nearly all entries
/// keep this law, the row that does not is told: an entry too few, of another size or sign, all of another size (units)
/// or sign (sense), or two rows that have each other's variables. J: at a point where no entry is 0 by chance. Returns
/// whether nearly all entries keep the law.
bool add_mirror_faults(const Mcp& mcp, const SpMat& J, std::vector<Answer>& found);

/// Tells, of rows whose names differ in an index alone, the one that has another sign or size of entries where all
/// others agree.
void add_family_faults(const Mcp& mcp, const SpMat& J, std::vector<Answer>& found);

/// The start x0, which the model gives: it is outside the bounds, F or J is not defined there, or nearly all rows hold
/// there (a calibrated benchmark) and a few do not.
void add_start_faults(const Mcp& mcp, In x0, std::vector<Answer>& found);

}  // namespace perp::ncp
