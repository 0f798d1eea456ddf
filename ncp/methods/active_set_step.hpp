// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Newton's method on the equation that an active set leaves; private to ncp/.
#include <vector>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// Where each variable is guessed to end: by the sign of x - F beyond its bounds. AtLower: x_i - F_i <= l_i (fixed
/// variables too); AtUpper: x_i - F_i >= u_i; Free: between, where F_i = 0 is asked for.
std::vector<lcp::BoundState> active_set(const Box& box, const Point& point);

/// The Newton point of that guess, projected onto the box: d_i = l_i - x_i or u_i - x_i for the active variables,
/// J_II d_I = -(F_I + J_IA d_A) for the free ones I. It is the full step of Newton's method on mid(x - l, F, x - u) =
/// 0, and of order two near a solution with a nonsingular J_II. False: J_II is singular.
bool active_set_step(Run& run, const Point& point, const std::vector<lcp::BoundState>& active, lcp::LuBackend backend,
                     Vec& to);

/// Such steps at the end of a method that comes to its solutions along a path.
class ActiveSetFinish {
 public:
  /// A step from `point`, if its active set is that of the last call, to one of at most half the natural residual.
  /// After failures it is tried more and more seldom.
  bool step(Run& run, const Point& point, lcp::LuBackend backend, Point& to);

 private:
  std::vector<lcp::BoundState> active_;
  int pause_ = 0;  // calls until the next try
  int failures_ = 0;
};

}  // namespace perp::ncp
