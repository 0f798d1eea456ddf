// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Units in which a contact problem has entries near one, whatever its own: velocities in q_s = |q|_inf, impulses in
/// q_s / s with s = tr(W) / (d n), so that
///     r = (q_s / s) r~,   u = q_s u~,   u~ = (W / s) r~ + q / q_s.
/// Coulomb's law is the same in both. Where q or the trace is zero, 1 stands in its place.
#include "contact/model/problem.hpp"

namespace perp::contact {

struct Units {
  double velocity = 1;  ///< q_s [m/s]
  double impulse = 1;   ///< q_s / s [N s]
  double W = 1;         ///< s [1/kg]

  /// Units in which nothing changes.
  static Units none() { return {}; }
  static Units of(const Delassus& W, In q);
};

inline Units Units::of(const Delassus& W, In q) {
  const double largest = q.size() > 0 ? q.lpNorm<Eigen::Infinity>() : 0;
  const double trace = W.diagonal().sum();
  Units units;
  if (largest > 0) units.velocity = largest;
  if (trace > 0) units.W = trace / static_cast<double>(W.rows());
  units.impulse = units.velocity / units.W;
  return units;
}

}  // namespace perp::contact
