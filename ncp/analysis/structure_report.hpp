// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Why the Jacobian is singular, in sentences with names.
///
/// At a point x the block that Newton's method has to solve with is B = J_AA: A are the variables off their bounds, or
/// at one that F pushes them away from (x_i = l_i with F_i < 0, x_i = u_i with F_i > 0); the others stay where they
/// are.
#include <functional>
#include <string>
#include <vector>

#include "lcp/linalg/structure.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// Returns "a, b and c" or, for more than six names, "a, b, c, d, e and 12 more".
std::string listed(std::size_t count, const std::function<std::string(std::size_t)>& name);
std::string listed_variables(const Mcp& mcp, const std::vector<Index>& variables);
std::string listed_equations(const Mcp& mcp, const std::vector<Index>& equations);

/// Describes the parts without a matching (lcp::dulmage_mendelsohn, in the indices of the problem): "too many
/// equations: 3 rows (a, b and c) for 2 variables (x and y)", "too many unknowns: ...". Empty rows (`over` without
/// columns) and empty columns are not mentioned.
std::vector<std::string> describe_parts(const Mcp& mcp, const lcp::StructurePart& over,
                                        const lcp::StructurePart& under);

/// Returns the variables A in ascending order, without fixed ones. A variable is at a bound if it is within 1e-10 (1 +
/// |bound|) of it.
std::vector<Index> active_block(const Box& box, In x, In F);

/// Says in one line, without a full stop, what makes B singular. First it looks for rows and columns without entries,
/// and for structurally too many equations or unknowns; then for parallel rows or columns. If there are none but B is
/// singular to working precision, it names the equations of which a combination vanishes, and the variables that can
/// move together without changing any equation. Returns an empty string if B is not singular, or if J, x or F is not
/// finite. Costs a matching, and a factorization of B if its structural rank is full. Throws std::invalid_argument if
/// the sizes do not fit.
std::string explain_singularity(const Mcp& mcp, const SpMat& J, In x, In F);

/// Says of a solution x, with J and F there, what makes it not the only one, or perhaps: variables that are in no
/// equation, or B is singular (explain_singularity). It is not the only one if a point beside x, along a null vector of
/// B, has a natural residual of at most `tol`, too. An empty string if B is regular.
std::string undetermined(const Mcp& mcp, const SpMat& J, In x, In F, double tol);

}  // namespace perp::ncp
