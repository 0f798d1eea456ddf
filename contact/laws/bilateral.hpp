// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Frictionless contact of bodies under bilateral constraints, as a mixed LCP of the problem before its condensation.
/// With H_N the normal columns of H, w_N the normal entries of w (Newton's impact law folded in),
///     M v = H_N r_N + G lambda + f,   0 = G'v + b,   0 <= r_N  _|_  u_N = H_N'v + w_N >= 0.
///
/// Velocities: the mixed LCP (lcp::Mlcp) in (v, lambda) free and r_N,
///     A = [ M   -G ]   C = [ -H_N ]   a = [ -f ]   D = [ H_N'  0 ],   B = 0,   b = w_N:
///         [ G'   0 ]       [   0  ]       [  b ]
/// sparse, nothing is inverted. Multipliers: v = M^-1 (f + G lambda + H_N r_N) eliminated, with v_free = M^-1 f,
///     A = G'M^-1 G,   C = G'M^-1 H_N,   D = H_N'M^-1 G,   B = H_N'M^-1 H_N,
///     a = G'v_free + b,   b = H_N'v_free + w_N
/// (Acary's lecture 3, (12)-(13); (12) has no "= 0", and the second row of (13) has H_N' where G' is printed).
///
/// Either is solved directly (lcp::to_affine) or as the LCP of its Schur complement (lcp::SchurReduction), which is the
/// same LCP(W_NN, q_N) of the condensed problem for both: A is regular if M is positive definite and G has independent
/// columns. With dependent ones only the direct form is left, and lambda is not unique.
#include "contact/model/problem.hpp"
#include "lcp/solve/mlcp.hpp"

namespace perp::contact {

class BilateralContact {
 public:
  enum class Unknowns { Velocities, Multipliers };

  /// `global` must outlive *this. Throws std::invalid_argument if its sizes differ, `dimension` is neither 2 nor 3, an
  /// entry is not finite, or, for Multipliers, M is singular.
  BilateralContact(const Global& global, int dimension, Unknowns unknowns = Unknowns::Velocities);

  const lcp::Mlcp& mlcp() const { return mlcp_; }

  struct Point {
    Solution contact;  ///< r with r_T = 0; u of all components
    Vec v;
    Vec lambda;
  };
  /// From a point of mlcp(): r_N and lambda are its own, v also for Velocities. Throws std::invalid_argument if it has
  /// not mlcp()'s sizes.
  Point recover(const lcp::MlcpPoint& point) const;

 private:
  void in_velocities();
  void in_multipliers();

  const Global& global_;
  int dimension_;
  Unknowns unknowns_;
  SpMat H_N_;
  Vec w_N_;
  lcp::Mlcp mlcp_;
  // Multipliers: M^-1 f, and M^-1 [G H_N] is applied through this factorization.
  lcp::SparseLu lu_;
};

}  // namespace perp::contact
