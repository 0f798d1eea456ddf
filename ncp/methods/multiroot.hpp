// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Which of GSL's solvers with derivatives (GNU Scientific Library reference manual, chapter "Multidimensional
/// Root-Finding").
enum class MultirootSolver {
  Hybridsj,  ///< Powell's hybrid method, scaled trust region: MINPACK's hybrj
  Hybridj,   ///< the same, unscaled
  Newton,    ///< undamped
  Gnewton,   ///< damped: t = (sqrt(1 + 6 r) - 1) / (3 r) for a growth r of ||.||^2
};
std::string_view to_string(MultirootSolver);  ///< "gsl-hybridsj", ...

/// A baseline: a general solver of smooth square systems that knows nothing of complementarity (GSL's, on dense
/// matrices). Without bounds it solves F(x) = 0. With bounds it solves the smoothed Fischer-Burmeister equations
/// Phi_mu(x) = 0 (ncp/reformulation/smoothing_function.hpp) for mu, mu shrink, mu shrink^2, ... mu_end, each from the
/// last zero; only the natural residual of the problem itself says that it is solved. What it has not: sparsity, steps
/// shortened where F is not defined (EvaluationFailed), any means where a matrix is singular (LinearAlgebraFailed) or
/// the smoothed equations have a local minimum (NoProgress).
///
/// GSL's error handler is global and ends the process by default. It is neither called nor touched: errors are seen
/// before GSL does (Newton and Gnewton: an LU factorization of each matrix to look for zero pivots), so two solves may
/// run in two threads. Memory of n^2 doubles is tried before GSL asks for it.
///
/// Not where perp is built with PERP_GPL=OFF (lcp/gpl.hpp): there it answers NotApplicable, and is no preset.
struct Multiroot {
  Stop stop{};  ///< an iteration is one of GSL's
  MultirootSolver solver = MultirootSolver::Hybridsj;
  static constexpr double mu = 1;  ///< first mu, in the units of x and F
  static constexpr double shrink = 1e-2;
  static constexpr double mu_end = 1e-9;  ///< at degenerate solutions the natural residual is about mu_end
  static constexpr lcp::Index max_size =
      500;  ///< larger problems are refused (NotApplicable): O(n^2) memory, O(n^3) work an iteration
};

void describe(Multiroot& method, Fields& fields);
inline std::string_view name_of(const Multiroot& method) { return to_string(method.solver); }
void iterate(Run& run, const Multiroot& method, Point point);

}  // namespace perp::ncp
