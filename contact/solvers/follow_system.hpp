// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The systems of Newton's steps of contact/solvers/follow.hpp, which says what K is, and what is kept of them from
/// step to step. Private to contact/.
#include <vector>

#include "contact/classics/newton.hpp"
#include "contact/model/contact_system.hpp"
#include "contact/model/problem.hpp"
#include "contact/model/residual.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

/// The state that Alart & Curnier's equation says with these rows.
State state_of(const ContactRows& rows, int size);

/// (A + B W) d = c.
struct FollowStep {
  std::vector<ContactRows> rows{};  // A and B
  Vec c{};
  Vec d{};
};

/// What is kept while W and friction are the same, and the factors of the last matrix.
class FollowSystem {
 public:
  /// With the analysis of `before`, if there is one, where the pattern is the same.
  FollowSystem(const Problem& of, const FollowSystem* before);
  bool is_of(const Problem& other) const;
  /// Takes q. Pre: is_of().
  void take(const Problem& of);

  const Scaled& problem() const { return problem_; }
  const NewtonWeights& rho() const { return rho_; }

  /// Computes the factors of K at r, unless those of the same rows are there, and counts. False: there are none.
  bool factor(In r, const FollowStep& step, int& factorizations);
  /// A and B of the factors; none: there are none.
  const std::vector<ContactRows>& factored() const { return rows_; }
  /// The system for others, whose factors take the place of K's.
  ContactSystem& give();
  /// d, as far as it is in reach with the factors; `centred`: and to the least barrier. Whether what is left is a small
  /// part of c.
  bool solve(In r, FollowStep& step, bool centred);

 private:
  static ContactSystem system_of(const Scaled& problem, const FollowSystem* before);
  Eigen::Vector3d inside(In r, std::size_t a) const;
  bool centre(In r, const FollowStep& step, Vec& d);

  Delassus W_;
  Vec mu_;
  Scaled problem_;
  ContactSystem system_;
  NewtonWeights rho_;
  Vec weight_;                             // of the impulses: 1, mu, mu
  std::vector<ContactRows> rows_{};        // of the factors
  std::vector<Eigen::Matrix3d> metric_{};  // D
  double largest_ = 1;                     // impulse at D
};

}  // namespace perp::contact
