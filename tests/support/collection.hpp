// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The collection as tests use it.
#include "collection/collection.hpp"

namespace perp::support {

/// Small enough for suites that solve everything.
inline bool quick(const ncp::collection::Entry& entry) { return entry.size <= 1200; }

/// Optimality conditions, equations from far starts, random NCPs: many, and harder for some systems than the rest.
inline bool set_apart(const ncp::collection::Entry& entry) {
  return entry.problem_class == "kkt" || entry.problem_class == "equations" || entry.problem_class == "random";
}

/// Pairs known to be beyond every method here (start k, from 0): from multipliers 0 and 1, far from 71 and 62, Newton's
/// steps of hs93 run into the corner where the gradient of a violated constraint vanishes.
inline bool beyond_all(const ncp::collection::Entry& entry, std::size_t k) {
  return entry.name == "hs93-kkt" && k != 1;
}

}  // namespace perp::support
