// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Primal-dual interior points for nonlinear MCPs, as a homotopy in tau: with s = x - l > 0, t = u - x > 0 of the
/// finite bounds and multipliers w, v > 0,
///     F(x) - w + v = 0,   s_i w_i = tau,   t_i v_i = tau,   tau -> 0,
/// on the skeleton that it shares with the affine method (lcp/iterative/interior_path.hpp): predictor, corrector and
/// Gondzio's correctors on one factorization of J + diag(w / s + v / t), which is an L S L' where row factors make J
/// symmetric and quasi-definite (networks, programs' conditions) and an LU elsewhere.
///
/// The start has the size of the problem: d solves (J + 1) d = -F at x0, one for each bound, and s - w = x0 + d - l -
/// (F + J d) with products s w of its mean square. Free variables follow by a Newton step on their equations alone. x0
/// itself is gone on from where that leads to larger residuals. One step length for x, w and v, a share `to_boundary`
/// of the way to the boundary, shortened a few times where the least product would fall below `neighbourhood` times
/// their mean.
///
/// Steps are not searched for a monotone decrease of ||F - w + v||: they are cut only where F is undefined or the norm
/// would grow by more than `growth`. Where that goes wrong (the steps vanish, the residual stops falling) the products
/// are raised to a larger tau around the best point: a restart. At the end Newton steps on the active set, as in
/// Smoothing, which make the convergence quadratic. x stays strictly inside [l, u], so F need not be defined outside;
/// fixed variables are held. Theory: for monotone F with a strictly feasible point the central path exists and leads to
/// a solution (Kojima, Megiddo & Noma, Math. Oper. Res. 16 (1991) 754); elsewhere a homotopy without a guarantee, whose
/// outcome the judge decides.
struct InteriorPoint {
  Stop stop{};
  double to_boundary = 0.99;    ///< in (0, 1)
  double neighbourhood = 1e-4;  ///< in (0, 1); Wright, Primal-Dual Interior-Point Methods (1997), chapter 5
  double growth = 10;           ///< of ||F - w + v||_2 in one step at most; > 1
  bool finish = true;           ///< Newton steps on the active set
  int restarts = 6;             ///< times that tau is raised
  int patience = 30;            ///< iterations without 1 % less natural residual after which it is
  lcp::LuBackend lu = lcp::LuBackend::General;
  /// Called with tau before every linearisation; F and J are evaluated after it. Here a problem may tie smoothing
  /// parameters of its own to tau, so that one path leads both to zero. There are no Newton steps on the active set
  /// then, for they would solve the problem of the present tau. May be empty.
  std::function<void(double tau)> follow{};
};
void describe(InteriorPoint& method, Fields& fields);
inline std::string_view name_of(const InteriorPoint&) { return "interior"; }
void iterate(Run& run, const InteriorPoint& method, Point point);

}  // namespace perp::ncp
