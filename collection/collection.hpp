// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The named test problems.
#include <span>
#include <string_view>
#include <vector>

#include "collection/base/entry.hpp"

namespace perp::ncp::collection {

std::span<const Entry> entries();          ///< sorted by class, then name
const Entry* find(std::string_view name);  ///< nullptr if there is none
/// Names close to `name` (for "did you mean").
std::vector<std::string_view> similar(std::string_view name);

}  // namespace perp::ncp::collection
