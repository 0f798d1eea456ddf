// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An elastic rod of n nodes, pressed on the plane z = 0 and pushed along it. x are the places (x, y, z) of the nodes,
/// v their velocities. With d_i = x_{i+1} - x_i, the rest length l of a segment and Green's strain
/// eps_i = (|d_i|^2 - l^2) / 2 l^2 the energy is
///     E(x) = sum_i EA l (eps_i^2 / 2 + beta eps_i^4 / 4) + sum_i B |d_i - d_{i-1}|^2 / 2 l^3:
/// large displacements, and a stiffness that grows with the strain where beta > 0. A step h has (P_MNL) with
///     R(v) = m (v - v_k) + h (E'(x_theta) + c v_theta - F),   x_theta = x_k + theta h v_theta,                      [N
///     s] v_theta = theta v + (1 - theta) v_k,   F: weight and `press` on each node, `push` on the first.
/// Contacts are the nodes with z + h U_N,k / 2 <= 0, up to a thousandth of the way that F closes within the step; H is
/// the same at all x.
#include "contact/scenes/nonlinear_motion.hpp"
#include "contact/scenes/rigid_bodies.hpp"

namespace perp::contact {

struct ElasticRod {
  Index nodes = 20;
  double length = 0.05;       ///< l [m]
  double mass = 0.01;         ///< m, of a node [kg]
  double stretching = 200;    ///< EA [N]
  double hardening = 50;      ///< beta [-]
  double bending = 0.01;      ///< B [N m^2]
  double damping = 0.01;      ///< c, of a node [N s/m]
  double mu = 0.4;            ///< [-]
  double gravity = 9.81;      ///< [m/s^2]
  double press = 0.5;         ///< on each node, downwards [N]
  Vec3 push = Vec3(3, 1, 0);  ///< on the first node [N]
  double h = 0.01;            ///< [s]
  double theta = 1;           ///< in [1/2, 1]

  /// Straight along x and at rest, the nodes at this height.
  Motion straight(double height = 0) const;
  /// The step that begins there. Throws std::invalid_argument naming field and value.
  NonlinearProblem step(const Motion& at, Derivative derivative = Derivative::Dual) const;
  /// After a step that ends with the velocities v.
  Motion moved(const Motion& at, In v) const;
  /// E [J].
  double elastic_energy(const Motion& at) const;
};

}  // namespace perp::contact
