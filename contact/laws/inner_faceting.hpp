// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Friction by the vertices of a polygon (Al-Fahed, Stavroulakis & Panagiotopoulos 1991; Stewart & Trinkle 1996):
/// P = conv{d_1, .., d_K}, r_T = D beta with D = [d_1 .. d_K], beta in R^K, and
///     u_N >= 0  _|_  r_N >= 0
///     lambda 1 + D'u_T >= 0  _|_  beta >= 0
///     mu r_N - 1'beta >= 0  _|_  lambda >= 0.
/// lambda = max_j -d_j'u_T where r_N > 0, for Coulomb's disk |u_T|. (Acary's lecture 3, (22)-(23); beta is in R^omega,
/// not in R^2.)
///
/// Reduced form, the LCP in (r_N, beta, lambda) of a contact ((24)-(26); the last block row of (25) is [mu, -1', 0],
/// the last column [0; 1; 0], and q's last entry 0):
///         [ W_NN     W_NT D     0 ]        [  q_N  ]
///     M = [ D'W_TN   D'W_TT D   1 ],   q = [ D'q_T ].
///         [ mu       -1'        0 ]        [   0   ]
/// z'M z = r'W r + mu r_N lambda >= 0 for z >= 0 and positive semidefinite W: M is copositive. For positive definite W
/// it has a solution, which Lemke's method finds (Stewart & Trinkle 1996): a solution z of LCP(M, 0) has r = 0, so that
/// r_N = 0, beta = 0 by the last row where mu > 0, and q'z = 0; theorem 3.8.6 of Cottle, Pang & Stone (1992) asks for
/// q'z >= 0.
///
/// Mixed form: D'W_TT D has K^2 entries for each of the four of W_TT; with r_T and u_T as free unknowns W stays as it
/// is:
///                r_N    r_T    u_T   beta   lambda
///               [ W_NN   W_NT   0     0      0 ]   r_N >= 0
///               [ W_TN   W_TT   -I    0      0 ]   r_T free
///           M = [ 0      I      0     -D     0 ]   u_T free       q = (q_N, q_T, 0, 0, 0).
///               [ 0      0      D'    0      1 ]   beta >= 0
///               [ mu     0      0     -1'    0 ]   lambda >= 0
/// z'M z is the same.
///
/// A contact with mu = 0 has the unknown r_N alone. References: Al-Fahed, Stavroulakis & Panagiotopoulos,
/// Ingenieur-Archiv 61 (1991) 434. Stewart & Trinkle, Int. J. Numer. Methods Engrg. 39 (1996) 2673. Cottle, Pang &
/// Stone, The Linear Complementarity Problem, 1992.
#include "contact/laws/affine_encoding.hpp"

namespace perp::contact {

class InnerFaceting : public AffineEncoding {
 public:
  /// As OuterFaceting's.
  InnerFaceting(const Problem& problem, const Polygons& polygons, const EncodingOptions& options = {});
};

}  // namespace perp::contact
