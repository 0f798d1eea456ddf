// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The unit cone K = {|r_j| <= r_N, j the contact's disks} in R^3 or R^5, of the coordinates of
/// contact/model/scaling.hpp; entries that a smaller contact has not are zero (disks.hpp). Of one disk K is its own
/// dual. Private to contact/.
#include <algorithm>

#include "contact/model/disks.hpp"

namespace perp::contact {

/// uhat = u + |u_T| e_N: De Saxce's change of variables. Of two disks u + (|u_T| + |w_R|) e_N.
template <int Size>
ContactVector<Size> corrected(ContactVector<Size> u, int width) {
  double opening = 0;
  for (int j = 0; j < disks<Size>; ++j) opening += disk<Size>(u, j, width).norm();
  u[0] += opening;
  return u;
}
inline Eigen::Vector3d corrected(const Eigen::Vector3d& u) { return corrected<3>(u, 2); }

/// y_N^2 - |y_T|^2: positive in the interior of K, and of -K.
inline double cone_det(const Eigen::Vector3d& y) {
  const double length = y.tail<2>().norm();
  return (y[0] - length) * (y[0] + length);
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

/// The root x >= 0 of x - y_N = sum (|y_j| - x)+ is P_N; each disk is cut to it.
template <int Size>
ContactVector<Size> project_onto_unit_cone(const ContactVector<Size>& y, int width) {
  if constexpr (disks<Size> == 1) {
    return project_onto_unit_cone(y);
  } else {
    const double T = disk<Size>(y, 0, width).norm();
    const double R = disk<Size>(y, 1, width).norm();
    const double longer = std::max(T, R);
    const double shorter = std::min(T, R);
    double x = y[0];
    if (longer > x) x = (y[0] + longer) / 2;
    if (shorter > x) x = (y[0] + longer + shorter) / 3;
    if (!(x > 0)) return ContactVector<Size>::Zero();
    ContactVector<Size> p = y;
    p[0] = x;
    if (T > x) set_disk<Size>(p, 0, width, x / T * disk<Size>(y, 0, width));
    if (R > x) set_disk<Size>(p, 1, width, x / R * disk<Size>(y, 1, width));
    return p;
  }
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
