// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lcp/lu/sparse_lu.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Levenberg-Marquardt's method on 2 n equations Phi(x) = 0 in the sense of least squares. Row i and row n + i are
///     lambda phi_i                       phi the Fischer-Burmeister function of the bounds of x_i (F_i without
///     bounds), (1 - lambda) (x_i - l_i)+ (F_i)+   of a lower bound; (u_i - x_i)+ (-F_i)+ of an upper one, the sum of
///     both for
///                                        two; F_i without bounds.
/// The second part closes level sets that the first one leaves open. It is one function with the first in the penalised
/// Fischer-Burmeister function; apart from it there is no kink where x_i > l_i and F_i > 0, and Psi = 1/2 ||Phi||^2 is
/// differentiable.
///
/// The direction d minimises ||Phi + H d||^2 + nu ||d||^2, H an element of the C-subdifferential, with nu = 1e-16, and
/// more where H'H is singular to rounding. First at most `preprocess` steps, each cut off at the box and at a trust
/// radius, whatever they do to Psi. If those do not solve the problem, from the start: x+ = x + t d with a nonmonotone
/// Armijo search on Psi from the sixth step on, and a return to the best point after `watchdog` steps without a better
/// one. Converges globally to stationary points of Psi, and q-quadratically to R-regular solutions.
///
/// Kanzow & Petra, Optim. Methods Softw. 19 (2004) 507, and their program LMMCP, whose constants these are. It has no
/// gradient steps and no restarts. Its least-squares problems are solved by QR; here by an LU of
/// [I -H; H' nu I], which does not square the condition of H.
struct Lmmcp {
  Stop stop{};
  static constexpr double lambda = 0.1;
  static constexpr int preprocess = 20;
  static constexpr int watchdog = 20;
  double sigma = 1e-4;
  double beta = 0.55;
  int max_backtracks = 46;  ///< t > 1e-12
  int memory = 10;
  lcp::LuBackend lu = lcp::LuBackend::General;
};
void describe(Lmmcp& method, Fields& fields);
inline std::string_view name_of(const Lmmcp&) { return "lmmcp"; }
void iterate(Run& run, const Lmmcp& method, Point point);

}  // namespace perp::ncp
