// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The natural map of one contact (Acary & Brogliato 2008, 13.3),
///     e = r - P_K(r - rho uhat),   uhat = u + sum_j mu_j |u_j| e_N,   K = {|r_j| <= mu_j r_N}, j the contact's disks,
/// of exactly the given doubles to 1e-10 |e| + 8 eps min(|r|, |rho uhat|): that subtraction loses uhat beside a huge r,
/// and r beside a huge uhat. P_K(y) has the normal part
///     x = c_A / k_A,   c_A = y_N + sum_A mu_j |y_j|,   k_A = 1 + sum_A mu_j^2,   A = {j : |y_j| > mu_j x},
/// the disks that y has left; y_j is cut to the length mu_j x there, and stays elsewhere. With y = r - rho uhat, t_j =
/// y_j / |y_j|, h_A = u_N + sum of mu_j |u_j| over the disks not in A, and
///     s_j = |r_j| - mu_j r_N,   d_j = |y_j| - |r_j|,   g_j = |y_j| - rho |u_j|,
///     c_A = r_N - rho h_A + sum_A mu_j g_j
/// there are these regions, the third in two forms:
///     c <= 0 of all disks (-y in K*):                     e = r
///     s_j + d_j + mu_j rho uhat_N <= 0 of all (y in K):   e = rho uhat
///     |r| <= |rho uhat|:   k_A e_N = sum_A (mu_j^2 r_N - mu_j g_j) + rho h_A,   e_j = r_j - mu_j x t_j
///     else:                k_A e_N = rho uhat_N - sum_A mu_j (s_j + d_j),   e_j = rho u_j + (s_j + d_j + mu_j e_N) t_j
/// and e_j = rho u_j of disks not in A. Of one disk A is that one. Private to contact/.
#include <array>

#include "contact/model/disks.hpp"

namespace perp::contact {

/// mu_j: of sliding, and of rolling.
template <int Size>
using Frictions = std::array<double, disks<Size>>;

/// r, u: as in disks.hpp, disks of `width` entries; mu >= 0, rho > 0. The part of e that overflows is infinite or NaN.
template <int Size>
ContactVector<Size> natural_map(const ContactVector<Size>& r, const ContactVector<Size>& u, const Frictions<Size>& mu,
                                double rho = 1, int width = 2);
inline Eigen::Vector3d natural_map(const Eigen::Vector3d& r, const Eigen::Vector3d& u, double mu, double rho = 1) {
  return natural_map<3>(r, u, {mu}, rho);
}

}  // namespace perp::contact
