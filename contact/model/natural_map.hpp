// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The natural map of one contact (Acary & Brogliato 2008, 13.3),
///     e = r - P_K(r - rho uhat),   uhat = u + mu |u_T| e_N,   K = {|r_T| <= mu r_N},
/// of exactly the given doubles to 1e-10 |e| + 8 eps min(|r|, |rho uhat|): that subtraction loses uhat beside a huge r,
/// and r beside a huge uhat. With y = r - rho uhat, k = 1 + mu^2, t = y_T / |y_T| and
///     s = |r_T| - mu r_N,   d = |y_T| - |r_T|,   g = |y_T| - rho |u_T|,
///     b = s + d + mu rho uhat_N  (= |y_T| - mu y_N),   c = r_N - rho u_N + mu g  (= y_N + mu |y_T|)
/// there are three regions, the third in two forms:
///     c <= 0 (-y in K*):   e = r
///     b <= 0 (y in K):     e = rho uhat
///     |r| <= |rho uhat|:   e_N = (mu^2 r_N + rho u_N - mu g) / k,    e_T = r_T - mu c t / k
///     else:                e_N = (rho uhat_N - mu (s + d)) / k,      e_T = rho u_T + b t / k
/// Private to contact/.
#include <Eigen/Core>

namespace perp::contact {

/// r, u: (N, T1, T2), T2 = 0 in 2D; mu >= 0, rho > 0. The part of e that overflows is infinite or NaN.
Eigen::Vector3d natural_map(const Eigen::Vector3d& r, const Eigen::Vector3d& u, double mu, double rho = 1);

/// uhat_N = u_N + mu |u_T|, to a few eps of itself.
double corrected_normal(const Eigen::Vector3d& u, double mu);

}  // namespace perp::contact
