// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the Newton methods search with. Private to ncp/.
#include "lcp/iterative/search_memory.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

using lcp::Memory;
using lcp::Stall;

/// t with  psi(x + t d) <= reference + sigma t slope,  F and J defined there, over t = 1, beta, beta^2, ... or those
/// times `longest`; the point found replaces `point`. x + t d is projected onto `box` if `projected`.
struct SearchOutcome {
  bool found = false;
  double t = 0;
  double merit = 0;
  int backtracks = 0;
  int undefined = 0;  ///< trial points at which F or J was not defined
};
SearchOutcome line_search(Run& run, const CFunction& c, const Armijo& rule, In d, double slope, double reference,
                          bool projected, Point& point, double longest = 1);

/// The projected searches of one major iteration, which its record counts together.
class Searches {
 public:
  Searches(Run& run, const CFunction& c, const Armijo& rule, double reference, Iteration& it)
      : run_(run), c_(c), rule_(rule), reference_(reference), it_(it) {}

  /// line_search() along d. True: `point` is the one found.
  bool along(In d, double slope, Point& point);
  bool found() const { return last_.found; }
  bool full_step() const { return last_.found && last_.t == 1; }
  double t() const { return last_.t; }
  double& merit() { return last_.merit; }  ///< whoever moves the point found on brings it down
  /// Whether F or J was undefined at every trial point.
  bool nowhere_defined() const { return undefined_ > 0 && undefined_ == it_.backtracks; }

 private:
  Run& run_;
  const CFunction& c_;
  const Armijo& rule_;
  double reference_;
  Iteration& it_;
  SearchOutcome last_;
  int undefined_ = 0;
};

}  // namespace perp::ncp
