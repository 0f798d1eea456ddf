#pragma once
#include "lcp/lemke.hpp"
#include "ncp/options.hpp"

namespace perp::ncp {

/// x+ solves the linearised problem MCP(l, u, F(x) + F'(x)(. - x)), by lcp::lemke from the last basis; damped on the
/// Fischer-Burmeister merit (Josephy 1979; Mathiesen 1985; Rutherford 1993). Quadratic near strongly regular solutions.
struct NewtonJosephy {
  Stop stop{};
  Armijo search{};
  Escape escape{.rounds = 0};
  lcp::LemkeOptions lemke{};  ///< max_pivots is for one subproblem, and at most 1000 + 20 n
};

std::optional<std::string> invalid(const NewtonJosephy& method);

}  // namespace perp::ncp
