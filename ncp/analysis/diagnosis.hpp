// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is known about the best point of a run that found no solution; private to ncp/.
#include <string>

#include "ncp/problem/counted_mcp.hpp"
#include "ncp/run/judge.hpp"

namespace perp::ncp {

/// Why steps end where they do, in whole sentences, empty if there is nothing to say: variables that ran off to
/// infinity, whether the point is stationary for the Fischer-Burmeister merit Psi, and with what value. `point` holds F
/// and J; `earlier` is a point of at least ten times its residual, from before, or is empty.
struct Diagnosis {
  bool unbounded = false;
  bool stationary = false;
  std::string message;
  std::string advice;
};
Diagnosis diagnose(const Mcp& mcp, const Point& point, In start, const Judged& earlier);

}  // namespace perp::ncp
