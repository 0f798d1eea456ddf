// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The conditions between y and w = S y + h at the kinks of a contact problem's solution (sensitivity.hpp), each on
/// some entries of y and w:
///     Pair   0 <= y _|_ w >= 0
///     Cone   y in K, K* > w + (sum_j mu_j |w_j|) e_N, y _|_ w + ..: Coulomb's law, for the disks whose mu_j is not 0
///     Disk   |y| <= radius,   |w| y = -radius w
/// Without cones, and with disks that are intervals, this is an affine MCP; else it is a contact problem: pairs have no
/// friction, disks a normal impulse that is given. Private to contact/.
#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "contact/model/delassus.hpp"

namespace perp::contact {

struct Kink {
  enum class Law { Pair, Cone, Disk };
  Law law = Law::Pair;
  Index first = 0;             ///< of its entries in y, which follow each other: (N), (N, disks..) or one disk
  std::array<double, 2> mu{};  ///< of a cone's disks
  double radius = 0;           ///< of a disk
};

struct Kinks {
  int dimension = 3;  ///< of the problem whose kinks they are
  bool rolls = false;
  std::vector<Kink> list{};
  int width() const { return rolls ? (dimension - 1) / 2 : dimension - 1; }  ///< entries of a disk
};

struct KinksSolution {
  Vec y{};              ///< empty: not found, or not known to be the only one
  bool always = false;  ///< proven, up to the rounding of S: there is one for every h and radius
  std::string why{};    ///< of an empty y
};
KinksSolution solve(const Kinks& kinks, const Eigen::MatrixXd& S, In h);

}  // namespace perp::contact
