// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Projected successive overrelaxation for the affine MCP(l, u, M z + q): sweeps over the variables, forward or forth
/// and back,
///     z_i <- mid(l_i, z_i - omega (M z + q)_i / M_ii, u_i),
/// with the newest values of the others (Cryer 1971; omega = 1 is projected Gauss-Seidel). With blocks of b consecutive
/// variables, block B's affine MCP in z_B, the others held, is solved exactly by its complementary cells, and z_B moves
/// by omega times the way to that solution, projected.
///
/// Converges from every start to a solution
///  * for 0 < omega < 2 if M is symmetric positive definite (Cryer 1971), or symmetric positive semidefinite with
///    positive diagonal (definite blocks) and the minimum of z'Mz/2 + q'z over the box is attained (Luo & Tseng 1992);
///  * for 0 < omega <= 1 if M is an H-matrix with positive diagonal, such as a strictly diagonally dominant one (Ahn
///    1981; Cottle, Pang & Stone 1992, section 5.3; Mangasarian 1977 has more on splittings).
/// For other matrices it may cycle or diverge. The rate is that of SOR for the equations of the free variables: slow
/// for ill-conditioned M. O(entries of M) a sweep; memory: one copy of M by rows.
///
/// Short steps are no proof: the natural residual alone, looked at every `check_every` sweeps, says Solved. Stalled: it
/// grew beyond all bounds (the message says "diverges"), or did not fall by a hundredth in `patience` sweeps; z is the
/// best point seen. NotApplicable: M_ii <= 0 for a variable with a bound (M_ii = 0 for a free one), or a block without
/// a solution. Infeasibility is not recognised: such problems diverge or stall.
///
/// References: Cryer, SIAM J. Control 9 (1971) 385. Mangasarian, J. Optim. Theory Appl. 22 (1977) 465. Ahn, J. Optim.
/// Theory Appl. 33 (1981) 175. Luo & Tseng, J. Optim. Theory Appl. 72 (1992) 7.
#include "lcp/judge/result.hpp"

namespace perp::lcp {

struct ProjectedSor {
  double omega = 1;        ///< relaxation, in (0, 2)
  bool symmetric = false;  ///< sweep forth and back (SSOR); counts as two sweeps
  Index block = 1;  ///< variables of a block, 1 to 6 (3^6 cells); 3 for the contacts of three-dimensional mechanics
  Index max_sweeps = 100'000;
  int check_every = 10;   ///< sweeps between two looks at the residual; at least 1
  Index patience = 2000;  ///< sweeps within which the residual must fall by a hundredth
};
void describe(ProjectedSor& method, Fields& fields);

/// Result::iterations counts sweeps.
Result projected_sor(const AffineMcp& problem, In start, const ProjectedSor& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
