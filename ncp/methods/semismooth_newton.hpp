// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/reformulation/cfunction.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// How the Newton systems H d = -Phi are solved.
enum class LinearSolver {
  Direct,  ///< sparse LU of H
  Krylov,  ///< inexactly, in memory proportional to J's entries: lcp/linalg/krylov.hpp; by LU where that does not
           ///< converge
  Auto,    ///< Krylov for more than 20 000 unknowns
};

/// Forcing terms of the inexact method:  ||H d + Phi|| <= eta_k ||Phi||,
///     eta_k = gamma (||Phi_k|| / ||Phi_{k-1}||)^alpha, not below gamma eta_{k-1}^alpha if that is above 0.1, at most
///     eta_max
/// (Eisenstat & Walker, SIAM J. Sci. Comput. 17 (1996) 16, choice 2 with their safeguard), nor tighter than Stop::tol
/// asks for (Kelley 1995, section 6.3). alpha = 2: the convergence stays quadratic; alpha in (1, 2): of order alpha.
struct Forcing {
  static constexpr double eta_max = 0.1;
  static constexpr double gamma = 0.9;
  static constexpr double alpha = 2;
  int max_iterations = 300;  ///< of one linear solve
  /// After a full inexact Newton step, so many steps with its matrix and preconditioner (chord steps: Shamanskii 1967)
  /// at most, accelerated by the last differences (Anderson 1965; Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715);
  /// each must leave at most half of ||Phi||. They cost an evaluation of F and a few Krylov iterations each.
  int chord_steps = 10;
};

/// x+ = x + t d,  H d = -Phi(x),  H in the B-subdifferential of Phi  (De Luca, Facchinei & Kanzow 1996, Math. Prog.
/// 75). Levenberg-Marquardt steps (H'H + nu I) d = -H'Phi where H is singular or d is no descent direction, gradient
/// steps where those fail too. Converges q-quadratically to R-regular solutions; every accumulation point is stationary
/// for the merit.
///
/// Functions whose merit is not differentiable (CFunction::smooth_merit is false: min): a full Newton step is taken
/// where it leaves at most half of the least ||Phi|| so far; others are searched along on the Fischer-Burmeister merit,
/// which also gives the gradients (De Luca, Facchinei & Kanzow, Comput. Optim. Appl. 16 (2000) 173). Records tell Phi's
/// merit.
///
/// Inexact (LinearSolver::Krylov): a d that is no descent direction is computed again with a smaller eta before another
/// is tried, and Levenberg-Marquardt steps are truncated conjugate gradients on the normal equations, which descend
/// wherever they stop (Facchinei & Kanzow 1997, Math. Prog. 76). Iteration::linear says K where d came from the Krylov
/// method, D where that had failed and LU took over.
struct SemismoothNewton {
  Stop stop{};
  CFunction cfunction = fischer_burmeister();
  Armijo search{};
  double descent_rho = 1e-9;  ///< a Newton direction needs  grad psi . d <= -rho (||d|| / sqrt n)^p
  static constexpr double descent_p = 2.1;
  bool levenberg_marquardt = true;  ///< steps of that kind before gradient steps
  LinearSolver linear = LinearSolver::Auto;
  Forcing forcing{};
  lcp::LuBackend lu = lcp::LuBackend::General;
};
void describe(Forcing& forcing, Fields& fields);
void describe(SemismoothNewton& method, Fields& fields);
inline std::string_view name_of(const SemismoothNewton&) { return "semismooth"; }
void iterate(Run& run, const SemismoothNewton& method, Point point);

}  // namespace perp::ncp
