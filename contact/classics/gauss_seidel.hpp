// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sweeps of nonsmooth Gauss-Seidel, in the coordinates of contact/model/scaling.hpp: contact by contact the local
/// problem
///     u_a = W_aa r_a + b_a,   b_a = q_a + sum_{b != a} W_ab r_b,
/// is solved (local_problem.hpp; lecture, (71); Jean & Moreau 1992; Jourdan, Alart & Jean, Comput. Methods Appl. Mech.
/// Eng. 155 (1998) 31). A sweep costs as much as a product with W. It contracts fast where contacts are coupled weakly,
/// and hardly at all elsewhere.
#include <variant>
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
  template <int Size>
  using Contacts = std::vector<LocalProblem<Size>>;
  template <int Size>
  double sweep(const Contacts<Size>& contacts, Vec& r, Vec& u) const;

  const Scaled& problem_;
  std::variant<Contacts<3>, Contacts<5>> contacts_;
  LocalSolver local_;
  double omega_;
};

/// W_aa of every contact; of smaller ones the first rows and columns.
template <int Size>
std::vector<LocalProblem<Size>> local_problems(const Scaled& problem);

/// Impulses that are changed contact by contact, and their velocities u = W r + q. Where W is by its parts the
/// velocities of the bodies move in place of u, and no entry of W is formed.
class MovingImpulses {
 public:
  /// Pre: u = W r + q. Both outlive *this.
  MovingImpulses(const Scaled& problem, Vec& r, Vec& u);
  /// Of the contact: u as the impulses stand.
  template <int Size>
  ContactVector<Size> velocity(const Scaled::Block& block) const;
  /// Sets its impulse; the squared norm of the change.
  template <int Size>
  double set(const Scaled::Block& block, const ContactVector<Size>& after);
  /// Makes u that of the impulses.
  void finish();

 private:
  const Scaled& problem_;
  const DelassusParts* parts_;
  const SpMat* H_ = nullptr;  // of rigid bodies L^-1 H, M = L L'
  Vec& r_;
  Vec& u_;
  Vec v_{};  // M^-1 H r, or L^-1 H r
};

}  // namespace perp::contact
