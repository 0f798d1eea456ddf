// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the cells of a campaign say of each other's problems.
#include <vector>

#include "app/campaign/campaign.hpp"
#include "app/campaign/cell.hpp"

namespace perp::app::compare {

/// A method of perp that says Infeasible has a proof: a certificate it has checked, or all cases examined. Its cell is
/// then `infeasible` also where nobody knew (a file, or a problem of the collection without a listed solution). Here,
/// with all cells at hand:
///
///   somebody has a solution of the problem (the judge's residual is at most tol, from any start): the denial is false;
///   else the problem has none: no_solution and denied_by are set, so that nobody's failure on it counts as one.
///
/// What external programs deny is no proof and stays as it is. cells.jsonl and campaign.json are not touched; whoever
/// shows cells calls this first.
void settle(Campaign& campaign, std::vector<Cell>& cells);

}  // namespace perp::app::compare
