// SPDX-License-Identifier: Apache-2.0
#pragma once
/// From a request to a campaign. Private to app/compare.
#include <vector>

#include "app/campaign/campaign.hpp"
#include "app/compare/compare.hpp"

namespace perp::app::compare {

/// What is asked for; what the request leaves open is as in `before`, if there is one, else as usual. Of the problems
/// name, file and class only, unless `before` has them. Warnings go to `notes`. Throws InputError.
Campaign asked_campaign(const CompareRequest& request, const Campaign* before, std::vector<std::string>& notes);

/// Throws InputError where a campaign that was begun as `before` cannot go on as `now`, saying what differs.
void check_resumable(const std::string& dir, const Campaign& before, const Campaign& now);

}  // namespace perp::app::compare
