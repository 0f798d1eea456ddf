// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random sparse LCPs of known class, of any size, with a planted solution or a certificate that there is none. Made
/// with the Mersenne twister (std::mt19937) and uniform numbers only, whose bits are the same on every platform.
/// The class is certain by construction, not by a test; the arguments stand with the functions. Notation: B sparse,
/// about two entries a row, uniform in [-1, 1]; W = C - C' skew, about one entry a row of C; v >= 0 vectors.
///
/// A solution z is planted by q = F - M z with z, F >= 0, z'F = 0: each index has z_i in [1/2, 2] or F_i in [1/2, 2],
/// with equal chances. All throw std::invalid_argument, naming the argument, for n below the stated least.
#include "lcp/affine_mcp.hpp"

namespace perp::ncp::collection {

struct RandomLcp {
  lcp::AffineMcp problem;
  lcp::Vec solution{};     ///< planted; empty if there is none, or none known
  lcp::Vec certificate{};  ///< y >= 0, M'y <= 0, q'y < 0: no feasible point; empty for the others
};

/// M = B B' + W + diag(d), d in [0.1, 1]: v'Mv >= d_min v'v, positive definite, not symmetric. The solution is the only
/// one. n >= 1.
RandomLcp random_positive_definite(lcp::Index n, unsigned seed);

/// M = B B' + W with B n x n/2: positive semidefinite, M + M' of rank n/2 at most. n >= 2.
RandomLcp random_semidefinite(lcp::Index n, unsigned seed);

/// M = H E, H strictly row dominant with positive diagonal, E = diag in [0.1, 10]: the minors are those of H, positive
/// (H is an H-matrix), times entries of E, so that M is P. M_11 = 1, M_12 = 9, M_21 = 0, M_22 = 10 make it
/// indefinite: v = (5, -1, 0, ..) has v'Mv = -10. The solution is the only one. n >= 2.
RandomLcp random_p_matrix(lcp::Index n, unsigned seed);

/// M = nonnegative, with positive diagonal: v'Mv >= sum M_ii v_i^2 > 0. M_11 = M_22 = 1, M_12 = M_21 = 3: not
/// semidefinite, v = (1, -1, 0, ..). n >= 2.
RandomLcp random_strictly_copositive(lcp::Index n, unsigned seed);

/// M = P'(diag(M_1, M_2))P + W, M_1 semidefinite and singular as above, M_2 strictly copositive, P a permutation:
/// v'Mv = 0, v >= 0, is v_2 = 0 and v_1'M_1 v_1 = 0, hence (M + M')v = 0. Copositive-plus; neither semidefinite nor
/// strictly copositive. n >= 4.
RandomLcp random_copositive_plus(lcp::Index n, unsigned seed);

/// M nonnegative with M_11 = 0, M_12 = 1: copositive, but v = e_1 has v'Mv = 0 and (M + M')v >= e_2, so that it is not
/// copositive-plus: Lemke's ray proves nothing. n >= 2.
RandomLcp random_copositive(lcp::Index n, unsigned seed);

/// M_ij <= 0 off the diagonal, the diagonal in [-0.2, 2], M_11 = -0.2: Z, not P. Feasible, as a solution is planted;
/// the least feasible point is another, as a rule. n >= 1.
RandomLcp random_z_matrix(lcp::Index n, unsigned seed);

/// Bimatrix game 0 <= x _|_ A y - e >= 0, 0 <= y _|_ B'x - e >= 0 with dense A, B (m x n) uniform in [0.1, 1]. There is
/// a solution (Nash 1951; Lemke & Howson 1964), none is planted. m, n >= 1.
RandomLcp random_bimatrix(lcp::Index m, lcp::Index n, unsigned seed);

/// random_semidefinite's M, and z_i = F_i = 0 at about half of the indices: no strict complementarity at the planted
/// solution. n >= 2.
RandomLcp random_degenerate(lcp::Index n, unsigned seed);

/// M = B B' + W, semidefinite and hence copositive-plus, where rows 1 and 2 of B and of W are opposite: y = e_1 + e_2
/// has M'y = 0, and q'y = -1. Lemke's method must end on a ray and prove it. n >= 2.
RandomLcp random_infeasible(lcp::Index n, unsigned seed);

/// Row 1 of M is <= 0, M_11 = -1, and q_1 = -1: F_1 < 0 wherever z >= 0. M is not copositive, so that no theorem speaks
/// for Lemke's ray; the certificate is y = e_1. n >= 1.
RandomLcp random_infeasible_row(lcp::Index n, unsigned seed);

}  // namespace perp::ncp::collection
