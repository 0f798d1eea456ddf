#pragma once
/// Projected Newton steps that find most of the active set before anything is pivoted; private to ncp/.
#include "ncp/path/path_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// Moves `point` down the Fischer-Burmeister merit while it pays (struct Crash in ncp/path/path_search.hpp). `it` is
/// the record of the last iteration. False if the run is over: solved, or at one of its limits.
bool crash(Run& run, const Crash& options, Point& point, Iteration& it);

}  // namespace perp::ncp
