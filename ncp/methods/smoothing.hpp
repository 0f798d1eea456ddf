// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/reformulation/smoothing_function.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// How mu follows the iterates; r is their natural residual.
enum class SmoothingSchedule {
  /// SMOOTH (Chen & Mangasarian 1996, where alpha = 1/mu): Newton steps on Phi_mu(x) = 0 with Armijo's search on
  /// 1/2 ||Phi_mu||^2; mu never rises and is at most min(r, sqrt(r)) (but 1e-4 tol at least), and mu x shrink follows
  /// where the smooth system is solved to ||Phi_mu||_inf <= centring mu.
  NewtonArmijo,
  /// Path following towards ||Phi_mu(x)||_inf <= beta mu (Burke & Xu 1998; Chen & Xiu 1999). Predictor: the smooth
  /// Jacobian with the nonsmooth right-hand side, H_mu d = -Phi_0(x), which by Jacobian consistency (Chen, Qi & Sun
  /// 1998) is Newton's step in the limit; the full step is taken if it leads into the neighbourhood of a mu at most
  /// half as large. Else a corrector: a damped Newton step on Phi_mu = 0, and then the least mu of a few whose
  /// neighbourhood x is in.
  PredictorCorrector,
};

/// Newton's method on smooth approximations Phi_mu(x) = 0 of the reformulation, mu -> 0; at the end on the active set,
/// so that the last digits do not depend on mu: once the signs of x - F - l and x - F - u have settled, x_i goes to its
/// bound or J_II d_I = -(F_I + J_IA d_A), and the step is kept if it halves the natural residual. Theory: for
/// P0-functions all smooth Jacobians are nonsingular; for strongly monotone F both schedules converge from everywhere,
/// quadratically at the end. Elsewhere: Levenberg-Marquardt steps (H'H + nu I) d = -H'Phi_mu and gradient steps where H
/// is singular or its step is refused; where the residual has stopped falling, mu is raised, by ever more, which moves
/// the local minima of the merit function, and the run goes on from where it is. Iterates may leave the box.
struct Smoothing {
  Stop stop{};
  SmoothingFunction function = neural();
  SmoothingSchedule schedule = SmoothingSchedule::NewtonArmijo;
  Armijo search{};
  static constexpr double shrink = 0.5;  ///< see NewtonArmijo
  static constexpr double centring = 1;  ///< see NewtonArmijo
  /// PredictorCorrector: beta, at least twice what the start needs, and 2 kappa of the function.
  static constexpr double neighbourhood = 10;
  bool finish = true;  ///< active-set Newton steps
  int restarts = 6;    ///< times that mu is raised
  int patience = 25;   ///< iterations without 1 % less natural residual after which it is
  lcp::LuBackend lu = lcp::LuBackend::General;
};
void describe(Smoothing& method, Fields& fields);
inline std::string_view name_of(const Smoothing&) { return "smooth"; }
void iterate(Run& run, const Smoothing& method, Point point);

}  // namespace perp::ncp
