// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What both forms of Glocker's law (glocker.hpp, contact/solvers/homotopy.hpp) share, with mu = 1. Private to
/// contact/.
#include <array>
#include <cmath>

namespace perp::contact {

/// e_1, e_2, e_3 in 3D: the triangle |r_T| <= r_N is inscribed in (lecture, (45)). In 2D the interval's +1 and -1.
inline const std::array<double, 2>& facet_normal(int dimension, std::size_t i) {
  static const double half_sqrt3 = std::sqrt(3.0) / 2;
  static const std::array<std::array<double, 2>, 3> triangle{{{half_sqrt3, 0.5}, {-half_sqrt3, 0.5}, {0, -1}}};
  static const std::array<std::array<double, 2>, 3> interval{{{1, 0}, {-1, 0}, {0, 0}}};
  return dimension == 3 ? triangle[i] : interval[i];
}

/// g(r_N) = (r_N + sqrt(r_N^2 + 4 delta^2)) / 2 > 0 and g' = (1 + r_N / sqrt(...)) / 2, without cancellation.
struct SmoothNormal {
  double g, slope;
};
inline SmoothNormal smooth_normal(double r_N, double delta) {
  const double root = std::hypot(r_N, 2 * delta);
  const double g = r_N >= 0 ? (r_N + root) / 2 : 2 * delta * delta / (root - r_N);
  return {g, g / root};
}

/// sigma_D with its derivatives, and c with its derivative by r_N.
struct GlockerDisk {
  double sigma, sigma_N, sigma_T1, sigma_T2;
  double c, c_N;
};
/// The row divided by g: sigma_D = g - |r_T|^2 / g, c = 2 / g.
inline GlockerDisk normalised_disk(double delta, double N, double T1, double T2) {
  const double T = T1 * T1 + T2 * T2;
  const auto [g, slope] = smooth_normal(N, delta);
  return {.sigma = g - T / g,
          .sigma_N = slope * (1 + T / (g * g)),
          .sigma_T1 = -2 * T1 / g,
          .sigma_T2 = -2 * T2 / g,
          .c = 2 / g,
          .c_N = -2 * slope / (g * g)};
}

}  // namespace perp::contact
