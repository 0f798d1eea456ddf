// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The unit cone K = {|r_T| <= r_N} in R^3, of the coordinates of contact/model/scaling.hpp; entries that a smaller
/// contact has not are zero. K is its own dual. Private to contact/.
#include <Eigen/Core>

namespace perp::contact {

/// uhat = u + |u_T| e_N: De Saxce's change of variables.
inline Eigen::Vector3d corrected(Eigen::Vector3d u) {
  u[0] += u.tail<2>().norm();
  return u;
}

/// y_T / |y_T|, or zero.
inline Eigen::Vector2d tangential_direction(const Eigen::Vector3d& y) {
  const double length = y.tail<2>().norm();
  return length > 0 ? Eigen::Vector2d(y.tail<2>() / length) : Eigen::Vector2d::Zero();
}

inline Eigen::Vector3d project_onto_unit_cone(const Eigen::Vector3d& y) {
  const double length = y.tail<2>().norm();
  if (length <= y[0]) return y;
  if (length <= -y[0]) return Eigen::Vector3d::Zero();
  Eigen::Vector3d p;
  p << 1, tangential_direction(y);
  return (y[0] + length) / 2 * p;
}

/// r_T onto the disk of that radius.
inline Eigen::Vector3d project_onto_disk(Eigen::Vector3d r, double radius) {
  const double length = r.tail<2>().norm();
  if (length > radius) r.tail<2>() *= radius / length;
  return r;
}

/// The derivative of uhat.
inline Eigen::Matrix3d corrected_slope(const Eigen::Vector3d& u) {
  Eigen::Matrix3d slope = Eigen::Matrix3d::Identity();
  slope.topRightCorner<1, 2>() = tangential_direction(u).transpose();
  return slope;
}

}  // namespace perp::contact
