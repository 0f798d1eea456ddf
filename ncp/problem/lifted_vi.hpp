// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Variational inequalities over polyhedra C = {b <= A x <= c, l <= x <= u} (lcp/vi/polyhedron.hpp) with nonlinear F:
/// find x in C with F(x)'(y - x) >= 0 for all y in C. As an MCP in z = (x, lambda, s), one s in [b_i, c_i] for each row
/// with two different finite bounds,
///     F_x = F(x) - A'lambda,   F_lambda = A x - (b, c, or s),   F_s = lambda.
#include <memory>

#include "lcp/vi/polyhedron.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// F and [l, u] are the problem's, which outlives what is returned. Rows are called A[k] and their multipliers
/// lambda[k], k from `first`. Throws std::invalid_argument for malformed rows.
std::unique_ptr<Mcp> lifted(const Mcp& mcp, const SpMat& A, const Box& rows, int first = 1);
/// z = (x, lambda, A x), in the box.
Vec lifted_point(const Mcp& lifted, In x, In lambda);

}  // namespace perp::ncp
