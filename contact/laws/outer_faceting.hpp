// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Friction by the edges of a polygon (Klarbring 1986; Klarbring & Bjorkman 1988): P = {x : c_i'x <= 1}, and the
/// multipliers kappa_i of its K edges span the normal cone,
///     u_N >= 0  _|_  r_N >= 0
///     u_T + sum_i kappa_i c_i = 0
///     sigma_i = mu r_N - c_i'r_T >= 0  _|_  kappa_i >= 0.
/// (Acary's lecture 3, equation (20). In (18) the sum runs over -grad sigma_i = c_i, not over grad sigma_i.)
///
/// Mixed form, unknowns (r_N, r_T, kappa) of a contact, with C = [c_1 .. c_K]:
///         [ W_NN   W_NT   0 ]        [ q_N ]        r_N >= 0
///     M = [ W_TN   W_TT   C ],   q = [ q_T ],       r_T free
///         [ mu 1   -C'    0 ]        [  0  ]        kappa >= 0.
/// z'M z = r'W r + mu r_N sum kappa_i: M is copositive on the box's recession cone for positive semidefinite W.
///
/// Reduced form (Glocker 2001): with two independent normals, C_1 = [c_i c_j] (in the plane problem one, c_1), the
/// slacks s = (sigma_i, sigma_j) are unknowns in place of r_T, and the two kappa are functions:
///     r_T = C_1^-T (mu r_N 1 - s),   (kappa_i, kappa_j) = -C_1^-1 (u_T + C_2 kappa_2)
/// with C_2, kappa_2 of the other edges. An LCP of K + 1 unknowns (r_N, s, kappa_2) a contact, its values (u_N, kappa_i
/// and kappa_j, sigma_2). W is not inverted, and M is as sparse as W. The pair is the one with the largest determinant.
///
/// Where contacts are redundant W_TT is singular, and the free unknowns r_T are no start basis of Lemke's method for
/// the mixed form. lemke_start() has the pair's kappa in the basis in their place, sigma_i = sigma_j = 0: the reduced
/// form's path.
///
/// A contact with mu = 0 has the unknown r_N alone. References: Klarbring, Comput. Methods Appl. Mech. Engrg. 58 (1986)
/// 185. Klarbring & Bjorkman, Comput. Mech. 3 (1988) 25. Glocker, Set-Valued Force Laws, Springer 2001.
#include "contact/laws/affine_encoding.hpp"

namespace perp::contact {

class OuterFaceting : public AffineEncoding {
 public:
  /// Copies what it needs of the problem. Throws std::invalid_argument if it is malformed (check()), or there is
  /// neither one polygon nor one for each contact, or one is of another dimension than the tangent plane.
  OuterFaceting(const Problem& problem, const Polygons& polygons, const EncodingOptions& options = {});

 private:
  Vec mixed_start(const Problem& problem, const Polygons& polygons) const;
};

}  // namespace perp::contact
