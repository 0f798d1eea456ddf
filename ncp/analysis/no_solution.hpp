// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A proof that a problem has no solution, from the ranges of F (ncp/interval/enclosure.hpp).
#include <optional>
#include <string>
#include <vector>

#include "lcp/deadline.hpp"
#include "ncp/interval/interval.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/run/result.hpp"

namespace perp::ncp {

/// A row that no point of the box satisfies.
struct NoSolution {
  Index row = -1;
  Interval range{};  ///< holds F_row(x) for every x that could be a solution; empty: F_row is defined nowhere there
  bool narrowed = false;  ///< of the box, signs of F had left a part, over which the range is
};

/// That no point has a natural residual of at most tol; with tol = 0, that there is no solution. Such points lie in the
/// box X. Where F_i > tol on all of X, x_i <= l_i + tol, which narrows X_i, and there is none if l_i is infinite; F_i <
/// -tol likewise. Repeated until X stays as it is. Nothing: no proof was found that way, or the problem has no ranges.
std::optional<NoSolution> no_solution(const Mcp& mcp, double tol = 0);

/// The same by the rows marked 1 alone, and by the bounds that X has of the box.
std::optional<NoSolution> no_solution(const Mcp& mcp, double tol, const std::vector<char>& rows, const Box& X);

/// "equation "F[1]" lies in [0.1, inf] wherever its variables are within their bounds, and x[1] is free".
std::string describe(const Mcp& mcp, const NoSolution& proof);

/// The same by branch and prune: the box is halved until in every part the signs of F, or an equation  0 in F_i(m) +
/// [-tol, tol] + J_i(X) (X - m), leave nothing. Each point with a residual of at most tol lies in one of the parts.
/// Returns how many parts were refuted, all of the box; 0: no proof was found within about a second or the deadline, or
/// the problem has no ranges. Reference: Neumaier, Acta Numerica 13 (2004) 271.
int no_solution_in_parts(const Mcp& mcp, double tol = 0, lcp::Deadline deadline = lcp::no_deadline);

/// The same by multipliers of rows, in whose sum the terms that are not affine cancel or keep the sign of their range
/// (ncp/analysis/row_sums.hpp), as exp(x_1) does in x_2 - exp(x_1) >= 0 and exp(x_1) - x_2 >= 1. They are those of a
/// linear program that asks for the signs of F, which is given at most a second. Nothing: no proof was found that way.
std::optional<Infeasibility> no_solution_by_sums(const Mcp& mcp, double tol = 0,
                                                 lcp::Deadline deadline = lcp::no_deadline);

}  // namespace perp::ncp
