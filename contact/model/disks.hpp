// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The parts of a contact's impulses and velocities: a normal entry, and one disk of friction, or two,
///     (N, T1[, T2])     sliding:               |r_T| <= mu r_N
///     (N, T.., R..)     sliding and rolling:   |r_T| <= mu r_N,   |m_R| <= mu_r r_N.
/// A vector of fixed size holds any contact of a problem, with zeros after its entries: of size 3 where there is one
/// disk, of size 5 where there are two. Private to contact/.
#include <Eigen/Core>

namespace perp::contact {

template <int Size>
using ContactVector = Eigen::Matrix<double, Size, 1>;
template <int Size>
using ContactMatrix = Eigen::Matrix<double, Size, Size>;

/// The number of disks in a vector of that size.
template <int Size>
inline constexpr int disks = (Size - 1) / 2;

/// Disk j of y, whose disks have `width` entries each: 1 or 2. A second entry that there is not is zero.
template <int Size>
Eigen::Vector2d disk(const ContactVector<Size>& y, int j, int width) {
  if constexpr (disks<Size> == 1) return y.template tail<2>();
  if (width == 1) return {y[1 + j], 0};
  return y.template segment<2>(1 + 2 * j);
}
template <int Size>
void set_disk(ContactVector<Size>& y, int j, int width, const Eigen::Vector2d& part) {
  if constexpr (disks<Size> == 1)
    y.template tail<2>() = part;
  else if (width == 1)
    y[1 + j] = part[0];
  else
    y.template segment<2>(1 + 2 * j) = part;
}

}  // namespace perp::contact
