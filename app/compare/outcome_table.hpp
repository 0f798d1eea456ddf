// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a campaign says at its end.
#include <iosfwd>
#include <span>

#include "app/campaign/campaign.hpp"
#include "app/campaign/cell.hpp"

namespace perp::app::compare {

/// Methods by outcomes, those that occurred: how many cells. Problems without a solution are counted apart, as "honest"
/// where a run did not claim one. With restarts also the failures that they left.
void print_outcomes(std::ostream& out, const Campaign& campaign, std::span<const Cell> cells);

/// Wrong claims, one a line, shortened.
void print_false_claims(std::ostream& out, std::span<const Cell> cells);

}  // namespace perp::app::compare
