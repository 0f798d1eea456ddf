// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sweeps of nonsmooth Gauss-Seidel, in the coordinates of contact/model/scaling.hpp: contact by contact the local
/// problem
///     u_a = W_aa r_a + b_a,   b_a = q_a + sum_{b != a} W_ab r_b,
/// is solved, by cases (open; sticks) and else by a few Newton steps on Alart & Curnier's equation (lecture, (71);
/// Jourdan, Alart & Jean, Comput. Methods Appl. Mech. Eng. 155 (1998) 31). A sweep costs as much as a product with W.
/// It contracts fast where contacts are coupled weakly, and hardly at all elsewhere.
#include "contact/model/scaling.hpp"

namespace perp::contact {

class GaussSeidel {
 public:
  explicit GaussSeidel(const Scaled& problem);

  /// One sweep over all contacts, which updates r and u = W r + q; the norm of the change of r.
  double sweep(Vec& r, Vec& u) const;

 private:
  const Scaled& problem_;
  std::vector<Eigen::Matrix3d> diagonal_;  // W_aa; of smaller contacts its first rows and columns
  std::vector<Eigen::Matrix3d> inverse_;
};

}  // namespace perp::contact
