// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Primal-dual interior points for nonlinear MCPs, as a homotopy in tau: with s = x - l > 0, t = u - x > 0 of the
/// finite bounds and multipliers w, v > 0,
///     F(x) - w + v = 0,   s_i w_i = tau,   t_i v_i = tau,   tau -> 0.
/// Newton's direction with right-hand sides c, e of the products is
///     (J + diag(w / s + v / t)) dx = -(F - w + v) + c / s - e / t,   dw = (c - w dx) / s,   dv = (e + v dx) / t:
/// one sparse LU of one pattern an iteration, two solves. Predictor c = -s w, e = -t v; sigma = (tau_aff / tau)^3;
/// corrector c = sigma tau - s w - dx dw (Mehrotra, SIAM J. Optim. 2 (1992) 575). One step length for x, w and v, a
/// share `to_boundary` of the way to the boundary, shortened a few times where the least product would fall below
/// `neighbourhood` times their mean.
///
/// Steps are not searched for a monotone decrease of ||F - w + v||: they are cut only where F is undefined or the norm
/// would grow by more than `growth`. Where that goes wrong (the steps vanish, the residual stops falling) the products
/// are raised to a larger tau around the best point and sigma is kept from being small: a restart. At the end Newton
/// steps on the active set, as in Smoothing, which make the convergence quadratic. x stays strictly inside [l, u], so F
/// need not be defined outside; fixed variables are held. Theory: for monotone F with a strictly feasible point the
/// central path exists and leads to a solution (Kojima, Megiddo & Noma, Math. Oper. Res. 16 (1991) 754); elsewhere a
/// homotopy without a guarantee, whose outcome the judge decides.
struct InteriorPoint {
  Stop stop{};
  double to_boundary = 0.99;     ///< in (0, 1)
  double neighbourhood = 1e-4;   ///< in (0, 1); Wright, Primal-Dual Interior-Point Methods (1997), chapter 5
  double least_centring = 1e-4;  ///< sigma at least; in (0, 1)
  double growth = 10;            ///< of ||F - w + v||_2 in one step at most; > 1
  double margin = 1;             ///< the start is moved so far inside finite bounds, or to the middle; > 0
  bool finish = true;            ///< Newton steps on the active set
  int restarts = 6;              ///< times that tau is raised
  int patience = 30;             ///< iterations without 1 % less natural residual after which it is
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
