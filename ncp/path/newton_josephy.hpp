// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lcp/pivoting/lemke.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// How the linearised problems are solved.
enum class Subproblem {
  Lemke,  ///< by pivoting: lcp::lemke
  Qp,  ///< where J is symmetric, as the quadratic program that they are then: lcp::bound_qp; else, or where that fails
       ///< (J not positive semidefinite on a face), by pivoting
  Auto,  ///< Qp for more than 2000 unknowns
};

/// x+ solves the linearised problem MCP(l, u, F(x) + F'(x)(. - x)), by lcp::lemke from the last basis; damped on the
/// Fischer-Burmeister merit (Josephy 1979; Mathiesen 1985; Rutherford 1993). Quadratic near strongly regular solutions.
struct NewtonJosephy {
  Stop stop{};
  Armijo search{};
  Subproblem subproblem = Subproblem::Auto;
  /// With Qp, after a full step to x+: so many steps that solve MCP(l, u, F(x+) + F'(x)(. - x+)), with the old Jacobian
  /// (Shamanskii 1967: order 2 + their number an iteration); one is kept if it leaves at most half of ||Phi||.
  int chord_steps = 1;
  lcp::LemkeOptions lemke{};  ///< max_pivots is for one subproblem, and at most 1000 + 20 n
};

void describe(NewtonJosephy& method, Fields& fields);
inline std::string_view name_of(const NewtonJosephy&) { return "josephy"; }
void iterate(Run& run, const NewtonJosephy& method, Point point);

}  // namespace perp::ncp
