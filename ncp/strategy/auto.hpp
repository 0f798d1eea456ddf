// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "ncp/methods/semismooth_newton.hpp"
#include "ncp/path/path_search.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Chooses the method by size, structure and class of the problem, says in the message which and why, and goes on to
/// others of the family where it is stuck, all within one budget of iterations, evaluations and time (Stop):
///
///     affine, J pos. semidefinite     the linear methods (lcp::Auto, which chooses by the class of the matrix)
///     n > large, J not symmetric      PathSearch with few pivots, then InteriorPoint, before what follows
///     affine                          the linear methods
///     n > large, J symmetric          NewtonJosephy, its linearised problems as quadratic programs by multigrid
///     else, or with a warm basis      PathSearch
///
/// then PathSearch if it was not the last, SemismoothNewton where F is proven to be a uniform P-function (every
/// stationary point of its merit is the solution, and its level sets are bounded: Facchinei & Pang (2003), section
/// 9.1), Smoothing and InteriorPoint (not for affine problems), SemismoothNewton on the penalised function and with
/// proximal escapes. Every attempt but the last may use half of the iterations and
/// evaluations that are left, or 100 and 1000 if that is more: tighter limits are for the first method alone.
struct Auto {
  Stop stop{};
  Index large = 2000;
  PathSearch path{};              ///< options where it is tried; stop is not used
  SemismoothNewton semismooth{};  ///< likewise
};

void describe(Auto& method, Fields& fields);
inline std::string_view name_of(const Auto&) { return "auto"; }

}  // namespace perp::ncp
