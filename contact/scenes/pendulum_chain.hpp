// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A chain of n massless links of length l with a mass m at the end of each, hung up at the origin, above a floor. It
/// moves in the plane; x are the angles a_i of the links from the downward vertical [rad], v their rates. Node i is at
///     p_i = sum_{j <= i} l (sin a_j, -cos a_j),   0 <= i < n.
/// With m_ij = m (n - max(i, j)) and x_theta = x_k + theta h v_theta, v_theta = theta v + (1 - theta) v_k a step h has
/// (P_MNL) with
///     R_i(v) = sum_j m_ij l^2 (cos(a_i - a_j) (v_j - v_k,j) + h sin(a_i - a_j) v_theta,j^2) + h m (n - i) g l sin a_i,
/// a = x_theta [N m s]: Lagrange's equations, whatever the angles. Contacts are the nodes with z + h U_N,k / 2 <= the
/// floor's, up to a thousandth of g h^2; H is that of x_k, w_N = e U_N,k.
#include "contact/scenes/nonlinear_motion.hpp"

namespace perp::contact {

struct PendulumChain {
  Index links = 10;
  double length = 0.1;    ///< l [m]
  double mass = 0.1;      ///< m [kg]
  double floor = -0.6;    ///< its height over the origin [m]
  double mu = 0.5;        ///< [-]
  double e = 0;           ///< Newton's coefficient of restitution, in [0, 1]
  double gravity = 9.81;  ///< g [m/s^2]
  double h = 0.01;        ///< [s]
  double theta = 0.5;     ///< in [1/2, 1]

  /// At rest, every link at this angle.
  Motion straight(double angle) const;
  /// The step that begins there. Throws std::invalid_argument naming field and value.
  NonlinearProblem step(const Motion& at, Derivative derivative = Derivative::Dual) const;
  /// After a step that ends with the velocities v.
  Motion moved(const Motion& at, In v) const;
  /// Kinetic and potential [J].
  double energy(const Motion& at) const;
  /// Height of node i over the origin [m].
  double height(const Motion& at, Index i) const;
};

}  // namespace perp::contact
