// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Variational inequalities over polyhedra with nonlinear F (ncp/problem/lifted_vi.hpp): solved as the MCP with
/// multipliers, judged by the projection on C (lcp/vi/vi.hpp), which knows none. Where that point misses the tolerance,
/// Josephy's Newton method adds digits: each step solves the affine VI of F(x) + J(x) (y - x).
///
///     perp::lcp::ViResult r = perp::ncp::solve_vi(mcp, A, rows, x0);      // the box is mcp's
///
/// Reference: Josephy, Newton's method for generalized equations, MRC report 1965, Madison 1979.
#include <functional>

#include "lcp/vi/vi.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {

/// Solves the lifted MCP from a start.
using LiftedSolve = std::function<Result(const Mcp& lifted, const Vec& z0)>;

/// Affine problems that keep M and q are solved by lcp::solve_vi(), without `solve`. Throws std::invalid_argument for
/// malformed input.
lcp::ViResult solve_vi(const Mcp& mcp, const SpMat& A, const Box& rows, In x0, const LiftedSolve& solve,
                       const lcp::Limits& limits = {});
/// By automatic(), within the tolerance, the time and the interruption of `stop`.
lcp::ViResult solve_vi(const Mcp& mcp, const SpMat& A, const Box& rows, In x0, const Stop& stop = {});

}  // namespace perp::ncp
