// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Newton's matrix A + B (W + alpha I) of contact/classics/newton.hpp, and its factors.
///  * Where W is given by entries, on their pattern.
///  * Where W = H' M^-1 H is known by its parts, with factors of M + H (A + alpha B)^-1 B H' (contact_system.hpp).
///  Where
///    contacts stick A is zero: there is no alpha = 0. No entry of W is formed, and a direction that leaves a residual
///    is refused.
/// Private to contact/classics.
#include <memory>
#include <vector>

#include "contact/model/contact_system.hpp"

namespace perp::contact {

class NewtonMatrix {
 public:
  /// `problem` outlives *this. No factorization is begun that would not have ended at the deadline.
  NewtonMatrix(const Scaled& problem, lcp::Deadline deadline);

  bool by_bodies() const { return bodies_ != nullptr; }
  /// Whether there are factors. Pre: alpha is not 0 by bodies.
  bool factor(const std::vector<ContactRows>& rows, double alpha);
  /// Whether d solves the system of the last factors. Pre: there are some.
  bool solve(In c, Vec& d);

 private:
  Vec product(const Vec& d) const;

  const Scaled& problem_;
  SpMat K_;  // by entries
  lcp::SparseLu lu_;
  std::unique_ptr<ContactSystem> bodies_;
  std::vector<ContactRows> rows_;  // of bodies_, with alpha B in A
};

}  // namespace perp::contact
