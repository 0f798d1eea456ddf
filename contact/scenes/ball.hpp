// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A ball on a horizontal plane under a load of constant size that comes from three directions in turn (Acary, lecture
/// 3, Aussois 2010, (26)), with P = 5 s, L = 1:
///     F(t) = L mu m g d_j,  t in [j P, (j + 1) P) mod 3 P,  j = 0, 1, 2,
///     d_0 = (cos 60, sin 60),  d_1 = (-1, 0),  d_2 = (cos 60, -sin 60)  degrees: d_0 + d_1 + d_2 = 0.
/// The ball slides without turning. By Coulomb's law it stays at rest for L <= 1; for L > 1 its velocity tends to a
/// periodic one, which by the threefold symmetry of load and disk has the mean 0: the path closes. A friction polygon
/// has not that symmetry, unless K is a multiple of 3: the ball drifts, and where to depends on how the frame
/// (T1, T2), which means nothing, lies to the load.
///
/// While it slides, with the angle phi from load to velocity,
///     d|v|/dt = mu g (L cos phi - 1),  and for L = 1   |v| (1 + cos phi) = constant,
/// since the load adds to the velocity along itself what friction takes from |v|.
#include <functional>
#include <string>
#include <vector>

#include "contact/scenes/moreau_jean.hpp"

namespace perp::contact {

struct CyclicBall {
  double mass = 1;        ///< m [kg]; the path does not depend on it
  double radius = 0.1;    ///< [m]; nor on this
  double mu = 0.3;        ///< [-]
  double gravity = 9.81;  ///< g [m/s^2]
  double load = 1;        ///< L [-]: |F| / (mu m g)
  double phase = 5;       ///< P [s]
  double cycles = 3;      ///< of 3 P
  double h = 0.01;        ///< [s]
  double theta = 0.5;     ///< of the scheme
  double frame = 0;       ///< of the contact, turned from (x, y) by this angle [rad]
  bool rolls = false;     ///< it may turn: then it rolls, F = 7/5 m a, while 2/7 F is within friction's limit, L <= 3.5
  Vec3 velocity = Vec3::Zero();  ///< at t = 0 [m/s]
  double tol = 1e-10;            ///< of each step's contact problem
};

/// d_j at the time t, of length 1.
Vec3 load_direction(const CyclicBall& ball, double t);

struct BallPath {
  FrictionLaw law{};
  std::vector<double> times{};     ///< t_0 = 0, .. [s]
  std::vector<Vec3> centres{};     ///< [m]
  std::vector<Vec3> velocities{};  ///< [m/s]
  Energy energy{};                 ///< at the end; work and losses are sums over all steps
  double start_energy = 0;         ///< T + V at t = 0 [J]
  long iterations = 0;
  double worst = 0;       ///< largest Residual::scaled, by Coulomb's law, of all steps
  bool solved = true;     ///< false: it ends where a step was not solved
  std::string message{};  ///< why, then
  double seconds = 0;     ///< of computing

  /// Between the centres at the times k 3 P, k = cycles - 1 and cycles: mean velocity over the last cycle [m/s].
  Vec3 drift(const CyclicBall& ball) const;
};

/// Steps until cycles 3 P. Ends early where `stop` says so, if there is one. Throws std::invalid_argument naming
/// option and value.
BallPath run_ball(const CyclicBall& ball, const FrictionLaw& law, const std::function<bool()>& stop = {});

}  // namespace perp::contact
