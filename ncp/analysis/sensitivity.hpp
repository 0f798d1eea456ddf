// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Says how a solution x(p) of MCP(l(p), u(p), F(.; p)) moves with parameters p in R^m.
///
/// With J = F_x(x; p) and the index sets
///     A   l_i < x_i < u_i, F_i = 0      inside
///     N   x_i = l_i, F_i > 0, or x_i = u_i, F_i < 0, or l_i = u_i      at a bound b_i (l_i or u_i)
///     B   x_i = l_i or x_i = u_i, and F_i = 0      degenerate
/// x is differentiable if B is empty (strict complementarity) and J_AA regular. Then
///     dx_N/dp = db_N/dp,   J_AA dx_A/dp = -(dF_A/dp + J_AN db_N/dp)
///     dF/dp (total) = dF/dp + J dx/dp,   zero on A; on N the derivative of the multiplier F_i
/// (implicit function theorem; Fiacco 1976). With degenerate indices there is only a derivative in each direction dp.
/// It is the solution d of the affine problem on the critical cone
///     d_N = db_N,   (J d + dF)_A = 0,   0 <= d_i - dl_i _|_ (J d + dF)_i >= 0  (x_i = l_i),
///                                       0 <= du_i - d_i _|_ -(J d + dF)_i >= 0 (x_i = u_i),   i in B
/// with db, dF for (db/dp) dp, (dF/dp) dp. It is unique for every dp iff J_AA is regular and the Schur complement S =
/// J_BB - J_BA J_AA^-1 J_AB, row and column i reflected where x_i = u_i, is a P-matrix: strong regularity (Robinson,
/// Math. Oper. Res. 5 (1980) 43; Math. Program. Study 30 (1987) 45; Kyparisis, Math. Oper. Res. 15 (1990) 286; Pang,
/// same journal 15 (1990) 149).
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp {

/// The partial derivatives with respect to p at (x, p), each n x m (a dense matrix D: D.sparseView()).
struct ParameterDerivatives {
  SpMat dF;
  SpMat dl{};  ///< 0 x 0: the lower bounds do not depend on p. Rows of infinite bounds must be zero
  SpMat du{};
};

struct SensitivityOptions {
  double residual_tol = 1e-6;  ///< an x with a larger natural residual is no solution
  /// i is degenerate where x_i is within degenerate_tol (1 + |b_i|) of a bound b_i and |F_i| <= degenerate_tol max(1,
  /// max_j |J_ij|); else the larger of the two decides between A and N.
  double degenerate_tol = 1e-6;
  /// J_AA, equilibrated by its rows' and columns' largest entries, counts as singular below this reciprocal condition.
  double singular_rcond = 1e-13;
  Index max_degenerate = 1000;  ///< more are refused: S is dense
  lcp::LuBackend lu = lcp::LuBackend::Umfpack;
};

enum class SensitivityStatus {
  Differentiable,  ///< dx and dF are derivatives
  Directional,     ///< dx and dF are one-sided derivatives in the direction given
  Degenerate,      ///< refused: no derivative, or none that is known to be the only one; the message names B
  Singular,        ///< refused: J_AA is singular; the message says why, with names
  NotASolution,    ///< refused: the residual of x is above residual_tol
  NotDefined,      ///< refused: F or J is not defined at x
  TooLarge,        ///< refused: max_degenerate, or out of memory
};
std::string_view to_string(SensitivityStatus);

enum class Activity { Inside, AtLower, AtUpper, Fixed, DegenerateLower, DegenerateUpper };
std::string_view to_string(Activity);

struct Sensitivity {
  SensitivityStatus status = SensitivityStatus::NotDefined;
  std::string message;            ///< of a refusal, why, with names and values; else what was found
  Eigen::MatrixXd dx;             ///< n x m: dx_i/dp_j; n x 1 in a direction; empty if refused
  Eigen::MatrixXd dF;             ///< of the same shape: the total derivative of F_i
  std::vector<Activity> states;   ///< of every variable; empty if NotASolution or NotDefined
  std::vector<Index> degenerate;  ///< B
  double rcond = 1;               ///< of the equilibrated J_AA: an estimate of 1 / condition; 1 if A is empty
  bool strongly_regular = false;  ///< proven: J_AA regular, B empty or S a P-matrix
  Residual residual;              ///< of x
  bool known() const { return status == SensitivityStatus::Differentiable || status == SensitivityStatus::Directional; }
};

/// Computes dx/dp and dF/dp for all p_j, by one factorization and m solves. A solution with degenerate indices is
/// refused (Degenerate); ask for the derivative in a direction instead. Throws std::invalid_argument for wrong sizes,
/// values that are not finite, and options out of range.
Sensitivity sensitivity(const Mcp& mcp, In x, const ParameterDerivatives& parameters,
                        const SensitivityOptions& options = {});

/// Computes lim (x(p + s dp) - x(p)) / s for s -> 0+, and the same for F. Each degenerate index costs one more solve,
/// and all of them together an LCP of their number. If the LCP has one solution, this is the derivative of every path
/// of solutions from x in that direction. It has one if S is a P-matrix; otherwise an enumeration of its cells decides
/// (up to 20 degenerate indices). If it has several solutions (paths may branch) or none (the solution may vanish or
/// jump), the answer is Degenerate.
Sensitivity sensitivity(const Mcp& mcp, In x, const ParameterDerivatives& parameters, In dp,
                        const SensitivityOptions& options = {});

}  // namespace perp::ncp
