// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact without friction: the tangential rows of u = W r + q have r_T = 0, and what is left is
///     LCP(W_NN, q_N):   0 <= r_N  _|_  u_N = W_NN r_N + q_N >= 0.
///
/// With Newton's impact law, U_N,k+1 + e U_N,k in place of U_N,k+1 in the complementarity, the free velocity becomes
///     q_N = U_N,free + e o U_N,k
/// (Acary's lecture 3, (9)-(11), where (10) and (11) print the minus sign of an approaching U_N,k < 0 twice): u_N = 0
/// is then the rebound U_N,k+1 = -e U_N,k. W_NN is positive semidefinite, singular where contacts are redundant: r_N is
/// then not unique, but u is.
#include "contact/laws/affine_encoding.hpp"

namespace perp::contact {

/// The problem with U_N,free replaced by U_N,free + e o U_N,k in q. e [-] and the normal velocities `before` the impact
/// U_N,k [m/s] have one entry a contact; e in [0, 1]. Throws std::invalid_argument otherwise.
Problem with_newton_impact(Problem problem, In e, In before);

/// The same contacts with mu = 0: the problem that judges Frictionless.
Problem without_friction(Problem problem);

/// z = r_N.
class Frictionless : public AffineEncoding {
 public:
  /// Throws std::invalid_argument if the problem is malformed (check()). Its mu is not looked at.
  explicit Frictionless(const Problem& problem, const EncodingOptions& options = {});
};

}  // namespace perp::contact
