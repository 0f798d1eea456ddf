// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the tests of scenes share.
#include <random>

#include "contact/scenes/rigid_bodies.hpp"

namespace perp::contact {

inline constexpr double g = 9.81;  ///< [m/s^2]

inline Vec3 random_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

}  // namespace perp::contact
