// SPDX-License-Identifier: Apache-2.0
#include "contact/model/units.hpp"

namespace perp::contact {

Units Units::of(const Delassus& W, In q) {
  const double largest = q.size() > 0 ? q.lpNorm<Eigen::Infinity>() : 0;
  const double trace = W.diagonal().sum();
  Units units;
  if (largest > 0) units.velocity = largest;
  if (trace > 0) units.W = trace / static_cast<double>(W.rows());
  units.impulse = units.velocity / units.W;
  return units;
}

}  // namespace perp::contact
