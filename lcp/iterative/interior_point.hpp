// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Infeasible primal-dual interior points with Mehrotra's predictor and corrector for monotone affine MCPs (M positive
/// semidefinite, not necessarily symmetric), on the skeleton of lcp/iterative/interior_path.hpp with F(z) = M z + q:
/// one factorization of one pattern an iteration, and some solves. The delta term is proximal, towards the last
/// iterate, so that the limit solves the problem as it is (Rockafellar, SIAM J. Control 14 (1976) 877; Pougkakiotis &
/// Gondzio, Comput. Optim. Appl. 78 (2021) 307). The start is Mehrotra's. Linear programs have two step lengths, other
/// problems one. Fixed variables are taken out. M is scaled by D M D, which keeps monotonicity.
///
/// When the signs of s - w stop changing they tell the active bounds, and the equations of the others are solved with
/// refinement (M_II may be singular: proximal steps from the interior point); violated places are exchanged, as block
/// pivoting does, while that helps. This gives the last digits.
///
/// For monotone M with a solution the iterates converge to one (maximally complementary), strict complementarity or
/// not; 10 to 30 iterations are usual. Without a feasible point they diverge; the direction, cleaned, is tried as a
/// certificate: Infeasible only if proves_infeasible() accepts it, else Stalled. M that is not monotone is accepted,
/// with no guarantee but that Solved is judged. Of the start nothing is used but that it may be the best point met.
///
/// References: Mehrotra, SIAM J. Optim. 2 (1992) 575. Gondzio, Comput. Optim. Appl. 6 (1996) 137. Wright, Primal-Dual
/// Interior-Point Methods, SIAM 1997. Schwan, Jiang, Kuhn & Jones, PIQP, CDC 2023.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct InteriorPoint {
  Index max_iterations = 200;
  double to_boundary = 0.995;  ///< share of the way to the boundary at most, in (0, 1)
  double proximal = 1e-10;     ///< delta, the weight of the proximal term, relative to the scaled M
  LuBackend lu = LuBackend::General;
};
void describe(InteriorPoint& method, Fields& fields);

/// Result::iterations counts predictor-corrector steps.
Result interior_point(const AffineMcp& problem, In start, const InteriorPoint& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
