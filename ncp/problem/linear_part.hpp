// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The rows of an MCP that are affine on all of R^n, as an affine MCP: what exact proofs may rest on.
#include <optional>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

struct LinearPart {
  lcp::AffineMcp problem;    ///< with empty rows where F_i is not affine
  std::vector<char> rows{};  ///< 1: row i is F_i; empty: all are
};

/// Returns the affine rows, with the coefficients of J at x and the constants F_i(0). Nothing if there are none, or F
/// or J is not defined there.
std::optional<LinearPart> linear_part(const Mcp& mcp, In x);

}  // namespace perp::ncp
