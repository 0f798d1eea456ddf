// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Variational inequalities over polyhedra (ncp/problem/lifted_vi.hpp): solved as the MCP with multipliers, judged by
/// the projection on C (lcp/vi/vi.hpp), which knows none. Where that point misses the tolerance, Josephy's Newton
/// method adds digits: each step solves the affine VI of F(x) + J(x) (y - x). Affine ones are lcp::solve_vi()'s.
///
///     perp::lcp::ViResult r = perp::ncp::solve_vi(mcp, A, rows, x0);      // the box is mcp's
///
/// Reference: Josephy, Newton's method for generalized equations, MRC report 1965, Madison 1979.
#include <functional>

#include "lcp/vi/vi.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {

/// `lifted` has a polyhedron(). `solve` solves it, where F is not affine. Throws std::invalid_argument for malformed
/// input.
lcp::ViResult solve_vi(const Mcp& lifted, const std::function<Result()>& solve, const lcp::Limits& limits);
/// By automatic(), within the tolerance, the time and the interruption of `stop`.
lcp::ViResult solve_vi(const Mcp& mcp, const SpMat& A, const Box& rows, In x0, const Stop& stop = {});

/// The tolerance, the time from now on, and the interruption.
lcp::Limits vi_limits(const Stop& stop);
/// Judges x by the projection on lifted.polyhedron().
lcp::ViResult judge_vi(const Mcp& lifted, In x, const lcp::Limits& limits);

}  // namespace perp::ncp
