// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The principal pivoting method of Cottle and Dantzig, in its asymmetric form with 1 x 1 and 2 x 2 principal pivots,
/// for the affine MCP(l, u, M z + q), any box: first brought to pairs (z_k, w_k) >= 0, w = M z + q (two bounds make two
/// pairs; fixed variables vanish). Every pair has a basic variable b_k and a nonbasic one n_k; m is the tableau of  b =
/// m n + const.
///
///   major cycle   for a pair r with a negative value: the *driving* variable n_r grows
///                 (A) from 0, where b_r < 0, until b_r = 0: pivot <b_r, n_r>, end of the cycle; or
///                 (B) from its value n_r < 0 until n_r = 0, end of the cycle;
///   blocked       when some b_s >= 0 falls to 0, or b_s < 0 falls to lambda (below all values): if m_ss > 0 pivot
///                 <b_s, n_s>, else (m_ss = 0) the 2 x 2 pivot <b_s, n_r>, <b_r, n_s>, which passes from A to B or
///                 back;
///   not blocked   (A, m_rr = 0): row r has m_rk <= 0 for all k and no solution exists.
/// Ties go to r, then to the least index.
///
/// Sufficient matrices, so P-matrices and positive semidefinite ones, symmetric or not: ends with a solution or a proof
/// that there is none (Cottle, Pang & Stone 1992, section 4.2; least index: Cottle & Chang 1992),
/// Infeasible with a certificate that proves_infeasible() accepts. A negative diagonal pivot, or a 2 x 2 pivot of the
/// wrong signs, shows that M is not sufficient: NotApplicable. Free variables are pivoted in first; where their block
/// of M is singular they are split, z = z+ - z- (positive semidefinite stays so). Starts from the start's places, or
/// from z = l where their block is singular.
///
/// Every pivot replaces a column of a BasisFactor; nothing dense is kept. Works on equilibrated data. Failures leave
/// the best point met (natural residual). References: Cottle & Dantzig, Lin. Algebra Appl. 1 (1968) 103. Cottle, Pang &
/// Stone, The Linear Complementarity Problem, 1992, section 4.2. Cottle & Chang, SIAM J. Matrix Anal. Appl. 13 (1992)
/// 1131.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct PrincipalPivoting {
  Index max_iterations = 100000;  ///< pivots
  LuBackend lu = LuBackend::General;
};
void describe(PrincipalPivoting& method, Fields& fields);

/// iterations: principal pivots, 1 x 1 or 2 x 2. Throws std::invalid_argument for bad input and options.
Result principal_pivoting(const AffineMcp& problem, In start, const PrincipalPivoting& options = {},
                          const Limits& limits = {});

}  // namespace perp::lcp
