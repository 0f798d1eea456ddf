// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lcp/pivoting/lemke.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Newton's method on the normal map F_+(y) = F(pi(y)) + y - pi(y), undamped, as it stands in the books: y^{k+1} is the
/// zero of the piecewise linear
///     L_k(y) = F(pi(y^k)) + F'(pi(y^k)) (pi(y) - pi(y^k)) + y - pi(y)
/// (Robinson 1988, 1992; Acary, lecture 3, equations (35) and (36) for pi(y) = y^+), found by lcp::lemke from y^k. Its
/// pi(y^{k+1}) is the full step of Newton-Josephy from z^k = pi(y^k). Quadratic from nearby a strongly regular
/// solution; no more is promised: PathSearch is what makes it global.
struct NewtonRobinson {
  Stop stop{};
  lcp::LemkeOptions lemke{};  ///< max_pivots is for one linearised problem, and at most 1000 + 20 n
};

void describe(NewtonRobinson& method, Fields& fields);
inline std::string_view name_of(const NewtonRobinson&) { return "robinson"; }
void iterate(Run& run, const NewtonRobinson& method, Point point);

}  // namespace perp::ncp
