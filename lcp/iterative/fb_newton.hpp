// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Semismooth Newton for the Fischer-Burmeister equation Phi(z) = 0 of the affine MCP (De Luca, Facchinei & Kanzow
/// 1996; boxes after Billups 1995). With phi(a, b) = a + b - sqrt(a^2 + b^2), the rows of Phi are
///     phi(z_i - l_i, F_i),  -phi(u_i - z_i, -F_i),  phi(z_i - l_i, -phi(u_i - z_i, -F_i)),  F_i,  z_i - l_i
/// for a lower, an upper, both, no finite bound, and a fixed variable; F = M z + q.
///     H d = -Phi,  H = Da + Db M in the B-subdifferential;   z <- z + t d,
/// t = 1, 1/2, ... by the non-monotone Armijo test  Psi(z + t d) <= max of the last Psi + sigma t grad Psi'd  on the
/// differentiable Psi = ||Phi||^2 / 2 (Grippo, Lampariello & Lucidi 1986). Where H is singular or d is no direction of
/// sufficient descent, grad Psi'd <= -rho ||d||^p, Levenberg-Marquardt steps with growing nu, then -grad Psi. Once the
/// bounds that F and z point to stay the same for two steps, the point of that cell (M_II z_I = ...) is tried: it
/// gives the last digits.
///
/// Every accumulation point is a stationary point of Psi, and a solution if M is P0 there (De Luca et al. 1996, theorem
/// 14); locally quadratic, and finite by the cell's point, if M is R-regular. Stalled: Psi is stationary at a point
/// that is no solution, or does not fall any more. Infeasibility is not recognised.
///
/// References: De Luca, Facchinei & Kanzow, Math. Prog. 75 (1996) 407. Fischer, Optimization 24 (1992) 269. Grippo,
/// Lampariello & Lucidi, SIAM J. Numer. Anal. 23 (1986) 707.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct FbNewton {
  long max_iterations = 500;
  int memory = 8;             ///< merits of the last steps that the search compares with; 1: monotone
  double armijo = 1e-4;       ///< sigma, in (0, 1/2)
  double shortest = 1e-10;    ///< t below which a direction is given up
  double descent_rho = 1e-8;  ///< rho; De Luca, Facchinei & Kanzow 1996, section 8
  double descent_p = 2.1;     ///< p > 2; the same
  LuBackend lu = LuBackend::Umfpack;
};
void describe(FbNewton& method, Fields& fields);

/// Result::iterations counts Newton, Levenberg-Marquardt and gradient steps.
Result fb_newton(const AffineMcp& problem, In start, const FbNewton& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
