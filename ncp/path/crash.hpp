// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Projected Newton steps that find most of the active set before anything is pivoted; private to ncp/.
#include "ncp/path/path_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

enum class CrashEnd {
  Over,      ///< the run is: solved, or at one of its limits
  Regular,   ///< or nothing said that J_II is singular
  Singular,  ///< J_II at the last point, of a nonlinear problem
};

/// Moves `point` down the Fischer-Burmeister merit while it pays (struct Crash in ncp/path/path_search.hpp). `it` is
/// the record of the last iteration. `lu` is left with the factors of the last J_II.
CrashEnd crash(Run& run, const Crash& options, Point& point, Iteration& it, lcp::SparseLu& lu);

}  // namespace perp::ncp
