// SPDX-License-Identifier: Apache-2.0
#pragma once
/// F written as sums, F(x) = A x + B t(x) + c, with the terms t that are not affine, each once however many rows have
/// it. With T the ranges of t over the box, every x in the box gives a z = (x, t(x)) in the box of the affine problem
///     F = (A B) z + c,    z in [l, u] x T,
/// so that multipliers y of the rows which prove that the affine problem has no solution (lcp/judge/refutation.hpp)
/// prove it for F: in y'F terms cancel, or keep the sign that their range has. Nothing is rounded: coefficients are
/// added up only where the sum is exact, and what is left are further terms.
#include <optional>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

struct RowSums {
  lcp::AffineMcp problem;  ///< of z; the rows of t are empty
  std::vector<char> rows;  ///< 1: the row is one of F's
};

/// Nothing: F is not written down, or a row is defined nowhere in the box.
std::optional<RowSums> row_sums(const Mcp& mcp);

}  // namespace perp::ncp
