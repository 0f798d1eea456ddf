// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ranges of affine problems.
#include <memory>

#include "lcp/affine_mcp.hpp"
#include "ncp/interval/enclosure.hpp"

namespace perp::ncp {

/// Of F(x) = M x + q, by its entries. The problem outlives the enclosure.
std::unique_ptr<Enclosure> affine_enclosure(const lcp::AffineMcp& problem);

}  // namespace perp::ncp
