// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Newton's method on the equation that an active set leaves; private to ncp/.
#include <vector>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// Where each variable is guessed to end: by the sign of x - F beyond its bounds. AtLower: x_i - F_i <= l_i (fixed
/// variables too); AtUpper: x_i - F_i >= u_i; Free: between, where F_i = 0 is asked for.
std::vector<lcp::Cell> active_set(const Box& box, const Point& point);

/// Newton's steps on the equation of that guess, at the end of a method that comes to its solutions along a path: d_i =
/// l_i - x_i or u_i - x_i for the active variables, J_II d_I = -(F_I + J_IA d_A) for the free ones I, and x + d is
/// projected onto the box. It is the full step of Newton's method on mid(x - l, F, x - u) = 0, and of order two near a
/// solution with a nonsingular J_II. Where a factorization costs tens of solves, steps with the last factors (chord
/// steps: Shamanskii 1967) stand in for those of new ones as long as each gains a digit.
class ActiveSetFinish {
 public:
  ActiveSetFinish(Run& run, lcp::LuBackend backend) : run_(run), backend_(backend), lu_(backend) {}
  /// A step from `point`, if its active set is that of the last call, to one of at most half the natural residual.
  /// After failures it is tried more and more seldom.
  bool step(const Point& point, Point& to);

 private:
  bool factor(const SpMat& J);
  bool move(const Point& point, Point& to);
  bool falls(const Point& point, double share, Point& to);
  bool chord(const Point& point, Point& to);

  Run& run_;
  lcp::LuBackend backend_;
  lcp::SparseLu lu_;  // of J_II of some point, while a chord step may follow
  std::vector<lcp::Cell> active_;
  std::vector<Index> I_;  // free in active_
  bool chords_ = false;   // the last step began with these factors and gained a digit
  int pause_ = 0;         // calls until the next try
  int failures_ = 0;
};

}  // namespace perp::ncp
