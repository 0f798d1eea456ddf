// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The nonsmooth equations Phi(z) = 0 of an affine MCP and the linear systems of Newton's method for them. Row i
/// depends on (z_i, F_i), F = M z + q, so that H = Da + Db M, Da and Db diagonal, is an element of the
/// B-subdifferential.
/// Private to lcp/.
#include "lcp/affine_mcp.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

struct Equations {
  Vec Phi, Da, Db;
  double merit() const { return 0.5 * Phi.squaredNorm(); }  ///< Psi
};
/// The Fischer-Burmeister equations at z (lcp/fischer_burmeister.hpp); at kinks, the limit along h with h_i = 1 at the
/// degenerate indices and 0 elsewhere (De Luca, Facchinei & Kanzow 1996, section 7).
Equations fb_equations(const AffineMcp& problem, In z);
/// Phi_i = mid(z_i - u_i, F_i, z_i - l_i), ties on F's side: Db_i = 1 where the row is F's, else Da_i = 1.
Equations min_equations(const AffineMcp& problem, In z);

/// The cell that the rows of min_equations() say: its point is where the Newton step leads.
Places places_of(const AffineMcp& problem, In z);

class NewtonSystem {
 public:
  explicit NewtonSystem(const SpMat& M, LuBackend lu = LuBackend::Umfpack, Deadline deadline = no_deadline);
  /// H d = -Phi. False if H is singular to working precision.
  bool newton(const Equations& at, Vec& d);
  /// (H'H + nu I) d = -H'Phi through the quasi-definite [I H; H' -nu I], which does not square H's condition.
  bool levenberg_marquardt(const Equations& at, double nu, Vec& d);
  /// H'Phi, the gradient of Psi where that is differentiable.
  Vec gradient(const Equations& at) const;
  int factorizations() const { return factorizations_; }

 private:
  void fill(const Equations& at);
  SpMat H_;  ///< the pattern of M with a full diagonal, kept: one symbolic analysis
  SpMat M_;  ///< on that pattern
  SparseLu lu_, lm_;
  int factorizations_ = 0;
};

}  // namespace perp::lcp
