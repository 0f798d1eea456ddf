// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Coulomb's law at some contacts, the region, while the others hold as if glued: of the scaled problem, with r0 and D
/// positive definite, one block a contact,
///     Coulomb's law at the contacts of the region,   u_b + D_b (r_b - r0_b) = 0 at the others,   u = W r + q.
/// With D = T^-2 of an interior point (contact/cones/cone_path.hpp) the others are what a step of its path makes of
/// contacts that stick: they hardly move, and impulses stay away from the border of the cone. In the region's own
/// impulses this is again a contact problem, a small one. With K = W + D, c = -q + D r0 at the others and 0 in the
/// region, G the region's part of K^-1, and a that of K^-1 c,
///     u = (G^-1 - D) r - G^-1 a in the region,   r = K^-1 (c + u + D r) everywhere.
/// One factorization serves the region and all that it grows to. Private to contact/.
#include <Eigen/Dense>
#include <map>
#include <vector>

#include "contact/model/contact_system.hpp"
#include "contact/model/problem.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

class Region {
 public:
  /// One block of D, and its inverse, a contact; those of `inside` are not used. All contacts have the same size. What
  /// is given by reference outlives *this, and nobody else factors with `system` meanwhile.
  Region(const Scaled& problem, ContactSystem& system, std::vector<Eigen::Matrix3d> D,
         std::vector<Eigen::Matrix3d> inverse, Vec r0, std::vector<std::size_t> inside);

  /// K's factors; false: there are none.
  bool factor();
  /// The others whose impulses in r are outside of the cone, with some room for rounding.
  std::vector<std::size_t> leaving(const Vec& r) const;
  /// Takes these into the region: three solves with K's factors each. Pre: there are some, and none is in it.
  void grow(const std::vector<std::size_t>& contacts);
  std::size_t size() const { return inside_.size(); }

  /// The region's problem, all mu = 1; kept until it grows.
  const Problem& problem();
  /// All impulses, of those of the region.
  Vec whole(const Vec& region) const;
  /// |u_T| of all contacts, of the region's velocities; 0 at the others.
  Vec slips(const Vec& region_u) const;

 private:
  void add_columns(std::size_t from);
  Vec rest() const;

  const Scaled& problem_;
  ContactSystem& system_;
  std::vector<Eigen::Matrix3d> D_;
  std::vector<Eigen::Matrix3d> inverse_;
  Vec r0_;
  int size_of_one_;
  std::vector<std::size_t> inside_;
  std::vector<char> is_inside_;
  Eigen::MatrixXd columns_{};  // of K^-1, in the order of inside_
  Problem region_{};
};

}  // namespace perp::contact
