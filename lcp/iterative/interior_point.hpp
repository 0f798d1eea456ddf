// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Infeasible primal-dual interior points with Mehrotra's predictor and corrector for monotone affine MCPs (M positive
/// semidefinite, not necessarily symmetric). With slacks s = z - l > 0, t = u - z > 0 of the finite bounds and their
/// multipliers w, v > 0 the conditions are
///     M z + q - w + v = 0,   s_i w_i = mu,   t_i v_i = mu,   mu -> 0,
/// and Newton's direction for them, with right-hand sides c, e of the complementarity rows, is
///     (M + diag(w / s + v / t)) dz = -(M z + q - w + v) + c / s - e / t,
///     dw = (c - w dz) / s,   dv = (e + v dz) / t:
/// one sparse LU of one pattern an iteration, two solves. The predictor has c = -s w; sigma = (mu_aff / mu)^3; the
/// corrector c = sigma mu - s w - ds_aff dw_aff (Mehrotra 1992). One step length for all, the longest that keeps the
/// neighbourhood  s_i w_i >= gamma mu,  ||residual|| / mu <= C times its first value  (Wright 1997, chapter 8; Zhang
/// 1994). Free variables are equations, regularised by a proximal term below rounding of the entries; fixed ones are
/// taken out. M is scaled by D M D, which keeps monotonicity.
///
/// When the signs of s - w and t - v stop changing they tell the active bounds, and the equations of the others are
/// solved with refinement (M_II may be singular: proximal steps from the interior point): this gives the last digits.
///
/// For monotone M with a solution the iterates converge to one (maximally complementary), strict complementarity or
/// not; 10 to 30 iterations are usual. Without a feasible point they diverge; the direction, cleaned, is tried as a
/// certificate: Infeasible only if proves_infeasible() accepts it, else Stalled. M that is not monotone is accepted,
/// with no guarantee but that Solved is judged.
///
/// References: Mehrotra, SIAM J. Optim. 2 (1992) 575. Wright, Primal-Dual Interior-Point Methods, SIAM 1997. Zhang,
/// SIAM J. Optim. 4 (1994) 208. Potra, Lect. Appl. Math. 32 (1996) 617.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct InteriorPoint {
  long max_iterations = 200;
  double gamma = 1e-4;         ///< of the neighbourhood, in (0, 1); Wright 1997, chapter 8
  double to_boundary = 0.995;  ///< share of the way to the boundary at most, in (0, 1)
  double proximal = 1e-10;     ///< weight of the proximal term of free variables, relative to the scaled M
  LuBackend lu = LuBackend::Umfpack;
};
void describe(InteriorPoint& method, Fields& fields);

/// Result::iterations counts predictor-corrector steps.
Result interior_point(const AffineMcp& problem, In start, const InteriorPoint& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
