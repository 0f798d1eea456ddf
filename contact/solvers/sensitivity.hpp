// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Says how a solution r, u = W r + q of a contact problem (contact/model/problem.hpp) moves with parameters p in R^m
/// of q, mu and W. docs/contact/derivatives.md has the equations of each region, and of the kinks between them, where
/// there is a derivative in each direction dp only: y, the entries of dr, or of slip, that are free at the kinks, and
/// w = S y + h obey a contact problem with S for W and h for q, an LCP where no touching contact is at rest. At an edge
/// of mu = 0 (r_N > 0, u = 0, dmu > 0) du_N = 0, |dr_T| <= dmu r_N and |du_T| dr_T = -dmu r_N du_T.
#include <string>
#include <string_view>
#include <vector>

#include "contact/model/problem.hpp"
#include "contact/model/residual.hpp"
#include "ncp/analysis/sensitivity.hpp"

namespace perp::contact {

/// The partial derivatives with respect to p (a dense matrix D: D.sparseView()). What is 0 x 0, or has no entries, does
/// not depend on p.
struct ParameterDerivatives {
  SpMat dq{};               ///< d n x m
  SpMat dmu{};              ///< n x m
  SpMat dmu_r{};            ///< n x m, where there is rolling friction
  std::vector<SpMat> dW{};  ///< dW/dp_j, d n x d n, m of them
};
/// p = (q, mu): all there are but W's and mu_r.
ParameterDerivatives by_q_and_mu(const Problem& problem);

struct SensitivityOptions {
  double residual_tol = 1e-6;  ///< an r with a larger Residual::largest() is no solution
  /// u_N and |u_T| vanish where they are at most degenerate_tol V_a, r_N where it is at most degenerate_tol R_a, of
  /// max(|q_a|, |(W r)_a|) and max(|r_a|, V_a / w_a) (contact/model/residual.hpp), and mu r_N - |r_T| at that part of
  /// mu r_N. Where both of a pair vanish is a kink; else the larger one decides.
  double degenerate_tol = 1e-6;
  /// The system, equilibrated, counts as singular below this reciprocal condition.
  double singular_rcond = 1e-13;
  Index max_degenerate = 300;  ///< more entries of y are refused: S is dense
};

using ncp::SensitivityStatus;

/// The first four as State.
enum class Region { Open, Stick, Slip, Roll, Touching, Edge };
std::string_view to_string(Region);

struct Sensitivity {
  /// Differentiable: dr and du are derivatives (by mu_a = 0: from above). Directional: one-sided ones in the direction
  /// given. Refused: Degenerate, Singular (W is only semidefinite on the contacts that the message names, for example),
  /// NotASolution, TooLarge.
  SensitivityStatus status = SensitivityStatus::NotASolution;
  std::string message;            ///< of a refusal, why, with contacts and values; else what was found
  Eigen::MatrixXd dr;             ///< d n x m: dr_i/dp_j; d n x 1 in a direction; empty if refused
  Eigen::MatrixXd du;             ///< of the same shape
  std::vector<Region> regions;    ///< of every contact; empty if NotASolution
  std::vector<Index> degenerate;  ///< contacts at a kink
  double rcond = 1;               ///< of the equilibrated system: an estimate of 1 / condition; 1 if all are open
  bool strongly_regular = false;  ///< proven: no kinks, or one solution for every dp, up to the rounding of S
  Residual residual;              ///< of r
  bool known() const { return status == SensitivityStatus::Differentiable || status == SensitivityStatus::Directional; }
};

/// Computes dr/dp and du/dp for all p_j, by one factorization and m solves. A solution with contacts at a kink is
/// refused (Degenerate); ask for the derivative in a direction instead. Throws std::invalid_argument for what is no
/// problem, wrong sizes, values that are not finite, and options out of range.
Sensitivity sensitivity(const Problem& problem, In r, const ParameterDerivatives& parameters,
                        const SensitivityOptions& options = {});

/// Computes lim (r(p + s dp) - r(p)) / s for s -> 0+, and the same for u. Each entry of y costs one more solve, and all
/// of them together a contact problem, or an LCP, of their number. Its solution is the derivative if it is the only
/// one. If the theory does not say so, an enumeration decides LCPs (up to 20 entries of y); else the answer is
/// Degenerate, as it is where there are several solutions (paths may branch) or none (the solution may vanish or jump).
/// Throws also where mu_a = 0 would fall.
Sensitivity sensitivity(const Problem& problem, In r, const ParameterDerivatives& parameters, In dp,
                        const SensitivityOptions& options = {});

}  // namespace perp::contact
