// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A proof that a problem has no solution, from the ranges of F (ncp/interval/enclosure.hpp).
#include <optional>
#include <string>

#include "ncp/interval/interval.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// A row that no point of the box satisfies.
struct NoSolution {
  Index row = -1;
  Interval range{};  ///< holds F_row(x) for every x that could be a solution; empty: F_row is defined nowhere there
};

/// Solutions lie in the box X. Where F_i > 0 on all of X, x_i = l_i, which is X_i from then on, and there is no
/// solution if l_i is infinite; F_i < 0 likewise. Repeated until X stays as it is. Nothing: no proof was found that
/// way, or the problem has no ranges.
std::optional<NoSolution> no_solution(const Mcp& mcp);

/// "equation "F[1]" lies in [0.1, inf] wherever its variables are within their bounds, and x[1] is free".
std::string describe(const Mcp& mcp, const NoSolution& proof);

}  // namespace perp::ncp
