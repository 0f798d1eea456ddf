// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How a solve ended: one vocabulary for affine problems, nonlinear ones and contact.
#include <iosfwd>
#include <string_view>

namespace perp {

enum class Status {
  Solved,               ///< the natural residual is at most the tolerance
  SolvedToRounding,     ///< it is not, but in every row it is within the rounding of the row's terms
  Infeasible,           ///< proven to have no solution: by a certificate, or as the message says
  StationaryPoint,      ///< the gradient of the merit function vanished, the residual did not
  NoProgress,           ///< steps became too short to change x
  Stalled,              ///< no progress short of the tolerance: a cycle, a stationary point, rounding
  Ray,                  ///< a pivoting method's path went off along a ray: no solution found, and no proof of anything
  Unbounded,            ///< the iterates ran off to infinity
  Singular,             ///< a matrix the method has to factor is singular
  LinearAlgebraFailed,  ///< no direction could be computed
  SubproblemFailed,     ///< the linearised problem could not be solved, however regularised
  EvaluationFailed,     ///< F or J is not defined at the start, or at every point tried
  NotApplicable,        ///< the problem is outside what the method is defined for; the message says why
  IterationLimit,
  TimeLimit,
  Interrupted,  ///< somebody asked to stop
  OutOfMemory,  ///< something did not fit; the message says how much it takes, where that is known
};
std::string_view to_string(Status);  ///< "Solved", "StationaryPoint", ...
std::ostream& operator<<(std::ostream& out, Status status);

}  // namespace perp
