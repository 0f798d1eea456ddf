// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Multipliers y that are right but for rounding, made exactly right. Let E be the columns j of an affine problem with
/// (y'M)_j nearly 0. Of the rows with a multiplier some are chosen freely, to 24 digits, and the others follow from
///     (y'M)_j = 0,  j in E,
/// by Gauss' elimination in rational numbers. Times their common denominator all are integers. Private to ncp/.
#include <optional>

#include "lcp/affine_mcp.hpp"
#include "lcp/judge/two_part_vector.hpp"

namespace perp::ncp {

/// Nothing: a column of E cannot be 0, the integers have more digits than two doubles, or there are more than 200 rows
/// or columns in E.
std::optional<lcp::TwoPartVector> exact_multipliers(const lcp::AffineMcp& problem, lcp::In y);

}  // namespace perp::ncp
