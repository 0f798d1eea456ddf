// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Block principal pivoting for the affine MCP(l, u, M z + q), any box. Every bounded variable has a place (at lower,
/// at upper, inside); free variables are always inside, fixed ones never. The places give a point by
///     M_FF z_F = -(q_F + M_FN z_N),   w_N = M_N. z + q_N     (F inside, N at bounds; M_FF by sparse LU, refined)
/// and its infeasibilities
///     V = {i in F: z_i < l_i or z_i > u_i}  +  {i at lower: w_i < 0}  +  {i at upper: w_i > 0}.
/// All of V change places at once (Kostreva 1978). When neither |V| nor the natural residual has fallen below its least
/// value for p_max rounds, or a set of places comes again, only the least index of V changes (Murty 1974) until one of
/// them does fall (Judice & Pires 1994; Portugal, Judice & Vicente 1994, who look at |V| alone). V empty is a solution.
///
/// Finite for P-matrices: every M_FF is nonsingular, Murty's rule ends, and both least values can fall only finitely
/// often. Usually a few rounds. On meshes a coincidence set may move by one mesh width a round: a problem of 2000
/// unknowns or more that takes over five rounds goes on from the places of a coarser problem's solution, which is found
/// in the same way (lcp/pivoting/coarse_problem.hpp). For other matrices it may cycle, which is noticed (Stalled), or
/// meet a singular M_FF: then the round is repeated with one index of V after the other in place of the block, and
/// Singular is the answer if none of the first 20 gives a nonsingular matrix. A singular M_FF of the
/// start's places is replaced by the one with all variables inside. Failures leave the best point met (natural
/// residual).
///
/// Reducible problems are solved component by component first (lcp/linalg/block_triangular.hpp); if that fails, as a
/// whole. References: Kostreva, Lin. Algebra Appl. 21 (1978) 199. Murty, Lin. Algebra Appl. 9 (1974) 65. Judice &
/// Pires, Comput. Oper. Res. 21 (1994) 587. Portugal, Judice & Vicente, Math. Comp. 63 (1994) 625.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct BlockPivoting {
  int p_max = 10;                ///< rounds without progress before the least-index rule; 0: that rule at once
  Index max_iterations = 10000;  ///< rounds, of one component
  bool components = true;        ///< use reducibility
  LuBackend lu = LuBackend::General;
};
void describe(BlockPivoting& method, Fields& fields);

/// iterations: rounds; the message says how many of them were least-index steps. Throws std::invalid_argument for bad
/// input and options.
Result block_pivoting(const AffineMcp& problem, In start, const BlockPivoting& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
