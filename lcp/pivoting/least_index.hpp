// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Murty's least-index principal pivoting (a Bard-type method) for the affine MCP(l, u, M z + q), any box. Places and
/// their point as in block_pivoting.hpp; every step changes the place of one variable,
///     r = min { i : i inside and z_i outside [l_i, u_i],  or at lower and w_i < 0,  or at upper and w_i > 0 },
/// from a bound inside or from inside to the bound it is beyond. Ends with a solution for every P-matrix and every
/// start (Murty 1974; Cottle, Pang & Stone 1992, theorem 4.2.8; with upper bounds by the same induction over the last
/// index: F_n is increasing in z_n where the others solve their problem, so n changes its place twice at most).
///
/// The reference method of its family: each step factors M_FF afresh, and the number of steps may be exponential. For
/// other matrices it may cycle, which is noticed (Stalled), or meet a singular M_FF (Singular); a singular block at the
/// start is replaced by the one with all variables inside. Failures leave the best point met (natural residual).
/// References: Murty, Lin. Algebra Appl. 9 (1974) 65. Bard, in: Optimization, Academic Press 1969.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct LeastIndex {
  long max_iterations = 100000;   ///< steps
  double degenerate_tol = 1e-11;  ///< signs within this x the size of the terms they come from are not violated
  LuBackend lu = LuBackend::Umfpack;
};
void describe(LeastIndex& method, Fields& fields);

/// iterations: steps. Throws std::invalid_argument for bad input and options.
Result least_index(const AffineMcp& problem, In start, const LeastIndex& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
