// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sweeps of nonsmooth Gauss-Seidel, in the coordinates of contact/model/scaling.hpp: contact by contact the local
/// problem
///     u_a = W_aa r_a + b_a,   b_a = q_a + sum_{b != a} W_ab r_b,
/// is solved (local_problem.hpp; lecture, (71); Jean & Moreau 1992; Jourdan, Alart & Jean, Comput. Methods Appl. Mech.
/// Eng. 155 (1998) 31). A sweep costs as much as a product with W. It contracts fast where contacts are coupled weakly,
/// and hardly at all elsewhere.
#include <vector>

#include "contact/classics/local_problem.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

class GaussSeidel {
 public:
  /// `omega` != 1: r_a moves by omega times what the local problem says, and is projected onto its cone.
  explicit GaussSeidel(const Scaled& problem, LocalSolver local = LocalSolver::Newton, double omega = 1);

  /// One sweep over all contacts, which updates r and u = W r + q; the norm of the change of r.
  double sweep(Vec& r, Vec& u) const;

 private:
  Eigen::Vector3d solved(std::size_t a, const Eigen::Vector3d& before, const Eigen::Vector3d& u) const;
  double sweep_by_parts(Vec& r, Vec& u) const;

  const Scaled& problem_;
  std::vector<LocalProblem> contacts_;
  LocalSolver local_;
  double omega_;
};

/// W_aa of every contact; of smaller ones the first rows and columns.
std::vector<LocalProblem> local_problems(const Scaled& problem);

/// Sets the impulse of one contact, and u = W r + q with it; the squared norm of the change.
double set_impulse(const Scaled& problem, const Scaled::Block& block, const Eigen::Vector3d& after, Vec& r, Vec& u);

}  // namespace perp::contact
