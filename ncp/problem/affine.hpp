#pragma once
/// Affine problems: F(x) = M x + q, as lcp::AffineMcp and back.
#include <optional>
#include <string>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// M and q of a problem that says it is affine; nothing if it does not, or if F or J is not defined at 0.
std::optional<lcp::AffineMcp> affine_part(const Mcp& mcp);

/// The affine MCP as an Mcp. Names as in Functions. Throws std::invalid_argument if the problem is malformed.
std::unique_ptr<Mcp> make_affine_mcp(lcp::AffineMcp problem, std::string name,
                                     std::vector<std::string> variable_names = {},
                                     std::vector<std::string> equation_names = {});

}  // namespace perp::ncp
