// SPDX-License-Identifier: Apache-2.0
/// The natural map r - P_K(r - rho uhat) by Newton's method with a line search.
#include <cmath>

#include "contact/classics/classics.hpp"
#include "contact/model/natural_map.hpp"
#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

/// Of P_K at y, an element of the generalised Jacobian.
Eigen::Matrix3d projection_slope(const Eigen::Vector3d& y) {
  const double length = y.tail<2>().norm();
  if (length <= y[0]) return Eigen::Matrix3d::Identity();
  if (length <= -y[0]) return Eigen::Matrix3d::Zero();
  const Eigen::Vector2d t = tangential_direction(y);
  Eigen::Matrix3d slope;
  slope(0, 0) = 1;
  slope.topRightCorner<1, 2>() = t.transpose();
  slope.bottomLeftCorner<2, 1>() = t;
  slope.bottomRightCorner<2, 2>() =
      (1 + y[0] / length) * Eigen::Matrix2d::Identity() - y[0] / length * t * t.transpose();
  return slope / 2;
}

NewtonRows natural_map_rows(const Eigen::Vector3d& r, const Eigen::Vector3d& u, double rho) {
  NewtonRows out;
  const Eigen::Matrix3d slope = projection_slope(r - rho * corrected(u));
  out.A = (Eigen::Matrix3d::Identity() - slope) / rho;
  out.B = slope * corrected_slope(u);
  out.c = -natural_map(r, u, 1, rho) / rho;
  return out;
}

}  // namespace

void describe(NaturalMapNewton& m, Fields& f) { describe(m.newton, f); }

RowsOf equation(const Scaled& problem, const NaturalMapNewton& /*method*/) {
  return [rho = NewtonWeights(problem)](std::size_t a, const Eigen::Vector3d& r, const Eigen::Vector3d& u) {
    return natural_map_rows(r, u, rho.N[static_cast<Index>(a)]);
  };
}

}  // namespace perp::contact
