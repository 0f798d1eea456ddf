// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the Newton methods share beside their linear systems: the search, and the steps that are safe where Newton's is
/// not. Private to lcp/.
#include <algorithm>
#include <cstddef>
#include <deque>

#include "lcp/fields.hpp"
#include "lcp/iterative/newton_system.hpp"
#include "lcp/iterative/search_memory.hpp"

namespace perp::lcp {

/// t in {1, 1/2, ...} with merit(z + t d) <= reference - t decrease; 0 if there is none above `shortest`.
template <class Merit>
double backtrack(const Merit& merit, const Vec& z, const Vec& d, double reference, double decrease, double shortest) {
  for (double t = 1; t >= shortest; t /= 2)
    if (merit(z + t * d) <= reference - t * decrease) return t;
  return 0;
}

/// One step on Psi of Fischer-Burmeister's equations that needs no regularity: Levenberg-Marquardt with growing nu,
/// else the gradient. False at stationary points.
struct SafeStep {
  double armijo;
  double shortest;
  bool operator()(const AffineMcp& problem, NewtonSystem& system, const Equations& at, double reference, Vec& z) const;
};

void describe_steps(double& armijo, double& shortest, Fields& fields);

}  // namespace perp::lcp
