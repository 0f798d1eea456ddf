// SPDX-License-Identifier: Apache-2.0
#pragma once
/// From the impulses of one step to those of the next: Newton's method on the equation of Alart & Curnier
/// (contact/classics/alart_curnier.hpp) with the proximal term alpha (r - r_k) of the iterate itself, each step as long
/// as the natural map asks for. Where contacts keep their states, sticking ones need one step and slipping ones two or
/// three. alpha is next to nothing first, and larger where contacts are redundant and Newton's steps leave the
/// neighbourhood. Between the two come sweeps of Gauss-Seidel from the same start, ended where they do not contract;
/// what solved a step is asked first in the next, and after failures in a row some steps are not tried at all.
///
/// The symbolic analysis is kept from step to step while the pattern of W is the same, and the factors while the matrix
/// is: as long as W stays and contacts only stick or are open, a step costs two triangular solves. Private to contact/.
#include <functional>
#include <optional>

#include "contact/classics/newton.hpp"
#include "contact/model/scaling.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::contact {

struct FollowSteps;

class Follower {
 public:
  using Accept = std::function<bool(const Vec&)>;
  using Stop = std::function<bool()>;
  /// Goes from r~ until `accept` says yes; the point then. `stop` is asked before each factorization. Nothing where
  /// that, or failure, ends it first.
  std::optional<Vec> from(const Scaled& problem, In r, const Accept& accept, const Stop& stop);

  long factorizations() const { return factorizations_; }  ///< since it was made
  long steps() const { return steps_; }
  long sweeps() const { return sweeps_; }

 private:
  bool attempt(const Scaled& problem, Vec& r, const Accept& accept, const Stop& stop);
  bool newton(const Scaled& problem, Vec& r, const FollowSteps& steps, const Accept& accept, const Stop& stop);
  bool sweep(const Scaled& problem, Vec& r, const Accept& accept);
  bool direction(const Scaled& problem, const NewtonWeights& rho, In r, double alpha, Vec& d);
  bool factor(const SpMat& K);

  lcp::SparseLu lu_{lcp::LuBackend::General};
  bool klu_ = false;
  SpMat factored_{};  // the matrix of the factors; empty: there are none
  long factorizations_ = 0;
  long steps_ = 0;
  long sweeps_ = 0;
  bool sweeps_first_ = false;
  int failures_ = 0;  // in a row
  int pause_ = 0;     // steps that are left to others
};

}  // namespace perp::contact
