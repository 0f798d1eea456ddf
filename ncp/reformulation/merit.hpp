// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Psi(x) = 1/2 ||Phi(x)||^2 of a reformulation, an element H of the B-subdifferential of Phi, and grad Psi = H' Phi.
/// Private to ncp/.
#include "ncp/problem/counted_mcp.hpp"
#include "ncp/reformulation/cfunction.hpp"

namespace perp::ncp {

/// The factor of the nu that Levenberg-Marquardt steps try in turn, and how many.
inline constexpr double lm_growth = 1e3;
inline constexpr int lm_tries = 4;
/// A stationarity() below this is zero.
inline constexpr double stationary_tol = 1e-9;

/// Phi, H = Da + Db J and H'Phi at a point.
struct Linearisation {
  Reformulation at;
  SpMat H;  ///< empty if it was not asked for
  Vec gradient;
  double merit = 0;
  /// max_j |gradient_j| / sum_i (|Da_j| [i = j] + |Db_i J_ij|) |Phi_i|: 0 at stationary points, 1 without cancellation.
  double stationarity = 0;
  /// The minimiser of ||Phi + H d|| along d = -gradient.
  Vec cauchy_step() const;
};
/// Fractions of multiples of the golden ratio: in (0, 1), no two alike; another sequence for every k.
Vec generic(Index n, int k = 0);

/// Phi, Da, Db. At kinks the element of the B-subdifferential is the one along a generic h > 0: x + s h meets no kink
/// for small s > 0 (De Luca, Facchinei & Kanzow 1996, section 7, with h_i = 1 at degenerate indices).
void elements(const CFunction& c, const Box& box, const Point& point, Reformulation& out);
void linearise(const CFunction& c, const Box& box, const Point& point, Linearisation& out, bool with_H = true);
/// Da + Db J in the pattern of J with its diagonal.
void assemble(In Da, In Db, const SpMat& J, SpMat& H);

/// max_j |gradient_j| / terms_j, terms_j the sum of the sizes of what gradient_j is the sum of; 1 where that overflows.
double stationarity(const Vec& gradient, const Vec& terms);

double merit(const CFunction& c, const Box& box, In x, In F);
/// fischer_burmeister(), made once: its names take longer than a small problem's merit.
const CFunction& fischer_merit();

}  // namespace perp::ncp
