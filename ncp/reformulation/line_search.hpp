// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the Newton methods search with. Private to ncp/.
#include "lcp/iterative/search_memory.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

using lcp::Memory;
using lcp::Stall;

/// t with  psi(x + t d) <= reference + sigma t slope,  F and J defined there, over t = 1, beta, beta^2, ...; the point
/// found replaces `point`. x + t d is projected onto `box` if `projected`.
struct SearchOutcome {
  bool found = false;
  double t = 0;
  double merit = 0;
  int backtracks = 0;
  int undefined = 0;  ///< trial points at which F or J was not defined
};
SearchOutcome line_search(Run& run, const CFunction& c, const Armijo& rule, In d, double slope, double reference,
                          bool projected, Point& point);

}  // namespace perp::ncp
