// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The one judge. r(x) = || x - mid(l, x - F(x), u) ||_inf is zero exactly at the solutions of MCP(l, u, F); it knows
/// no method, no merit function and no scaling, and nothing else may call a point solved.
#include "lcp/judge/judge.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

struct Residual {
  double natural = infinity;   ///< || x - mid(l, x - F, u) ||_inf; +inf where F is not defined
  Index worst = -1;            ///< index of the largest entry; of the first undefined equation where F is not defined
  double bounds = 0;           ///< || x - mid(l, x, u) ||_inf
  double complementarity = 0;  ///< || min(x - l, F+) ||_inf and || min(u - x, F-) ||_inf: the larger
};

/// Of given values F = F(x). A NaN or infinity in x or F gives natural = +inf at that index. Throws
/// std::invalid_argument if x, F and the box have not one length.
Residual residual(const Box& box, In x, In F);
/// Evaluates F itself; that of affine problems in sums without rounding errors (lcp/judge/judge.hpp).
Residual residual(const Mcp& mcp, In x);

/// r_i = |mid(x_i - u_i, F_i, x_i - l_i)|, whose largest is Residual::natural.
Vec row_residuals(const Box& box, In x, In F);
/// What they are the rest of: t_i = sum_j |J_ij x_j| + |F_i - sum_j J_ij x_j|, and the nonzeros of the rows of J.
lcp::RowTerms row_terms(const SpMat& J, In x, In F);
/// Whether a bound excuses F_i: x_i is on it and F_i has its sign, or x_i is fixed.
bool at_its_bound(const Box& box, Index i, double x, double F);
/// r_i against t_i, of values given, and of values it evaluates itself; not to_rounding where F or J is not defined.
lcp::Accuracy accuracy(const Box& box, In x, In F, const SpMat& J);
lcp::Accuracy accuracy(const Mcp& mcp, In x);

}  // namespace perp::ncp
