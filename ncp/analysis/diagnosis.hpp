// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is known about the best point of a run that found no solution; private to ncp/.
#include <string>

#include "ncp/problem/counted_mcp.hpp"

namespace perp::ncp {

/// Why steps end where they do, in whole sentences, empty if there is nothing to say: variables that ran off to
/// infinity, whether the point is stationary for the Fischer-Burmeister merit Psi, and with what value. `point` holds F
/// and J.
struct Diagnosis {
  bool unbounded = false;
  bool stationary = false;
  std::string message;
  std::string advice;
};
Diagnosis diagnose(const Mcp& mcp, const Point& point, In start);

}  // namespace perp::ncp
