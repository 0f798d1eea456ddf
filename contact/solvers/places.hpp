// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Place of a contact of a solution, as far as derivatives need it (sensitivity.hpp). Private to contact/.
#include <vector>

#include <Eigen/Core>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// Moves of a disk of friction: Edge is the kink between Stick and Slip.
enum class Move { Stick, Slip, Edge };

struct Disk {
  Index first = 0;  ///< of its entries
  double mu = 0;
  double r_N = 0;
  Move move = Move::Stick;
  bool rests = true;            ///< u_T = 0
  double speed = 0;             ///< |u_T|
  Eigen::Vector2d along{0, 0};  ///< u_T / |u_T|, or r_T / |r_T| at the edge
};

struct Place {
  enum class Normal { Open, Closed, Touching };
  Normal normal = Normal::Open;
  std::vector<Disk> disks{};
};

/// Finds the place of contact a from u = W r + q and W's diagonal, with SensitivityOptions::degenerate_tol.
Place place(const Problem& problem, In r, In u, Index a, In diagonal, double tol);

}  // namespace perp::contact
