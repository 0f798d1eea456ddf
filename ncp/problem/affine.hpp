// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Affine problems: F(x) = M x + q, as lcp::AffineMcp and back.
#include <memory>
#include <string>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// Returns M and q if the problem says that it is affine, and F and J are defined at 0; otherwise null. They are the
/// problem's own where it keeps them (Mcp::affine), and live as long as it does.
std::shared_ptr<const lcp::AffineMcp> affine_part(const Mcp& mcp);

/// Makes an Mcp of the affine MCP. Names are as in Functions. Throws std::invalid_argument if the problem is malformed.
std::unique_ptr<Mcp> make_affine_mcp(lcp::AffineMcp problem, std::string name,
                                     std::vector<std::string> variable_names = {},
                                     std::vector<std::string> equation_names = {});

}  // namespace perp::ncp
