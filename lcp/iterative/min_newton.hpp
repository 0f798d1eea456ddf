// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Damped Newton for the equation  H(z) = mid(z - u, M z + q, z - l) = 0  (min(z, M z + q) for the LCP), piecewise
/// linear (Harker & Pang 1990; Fischer & Kanzow 1996; as a primal-dual active set method Hintermueller, Ito & Kunisch
/// 2002). With the rows split by the piece that is active at z,
///     L = {F_i > z_i - l_i},   U = {F_i < z_i - u_i},   I = the rest,   F = M z + q,
/// the Newton step leads to the point of that cell,  z_L = l_L, z_U = u_U, (M z + q)_I = 0:  one sparse factorization
/// of M_II. The step is halved until 1/2 ||H||^2 is below the largest of its last `memory` values. Where M_II is
/// singular, or halving does not help, steps of the Fischer-Burmeister merit (fb_newton.hpp) go on from there.
///
/// From near a solution z* at which all M_II with {i: l < z* < u, F = 0} <= I <= {F = 0} are nonsingular it ends after
/// finitely many steps with z* up to rounding (Fischer & Kanzow 1996); undamped (`memory` large) it does so from every
/// start if M is a nonsingular M-matrix. Globally: no guarantee for P-matrices without damping, which may cycle (Ben
/// Gharbia & Gilbert 2012); with it the run ends Solved or Stalled: at a stationary point of the merit functions, or
/// where ||H||^2 has not fallen by a tenth in 60 steps.
///
/// References: Harker & Pang, Lectures in Appl. Math. 26 (1990) 265. Fischer & Kanzow, Math. Prog. 74 (1996) 279.
/// Hintermueller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865. Ben Gharbia & Gilbert, Math. Prog. A 134 (2012) 349.
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct MinNewton {
  long max_iterations = 500;
  int memory = 8;           ///< merits of the last steps that the search compares with; 1: monotone
  double armijo = 1e-4;     ///< sigma: Psi(z + t d) <= max - sigma t 2 Psi(z); in (0, 1/2)
  double shortest = 1e-10;  ///< t below which a direction is given up
  LuBackend lu = LuBackend::Umfpack;
};
void describe(MinNewton& method, Fields& fields);

/// Result::iterations counts Newton steps.
Result min_newton(const AffineMcp& problem, In start, const MinNewton& options = {}, const Limits& limits = {});

}  // namespace perp::lcp
