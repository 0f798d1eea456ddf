// SPDX-License-Identifier: Apache-2.0
#pragma once
/// L D L' of S K for the matrices K of interior points in linear and quadratic programs: with signs S = diag(+-1),
///     S K = (Q + Theta_1   -A'      )        Q, R positive semidefinite, Theta positive diagonal,
///           (-A            -R - Theta_2),
/// is symmetric and quasi-definite, and so has an L D L' for every symmetric permutation (Vanderbei, SIAM J. Optim. 5
/// (1995) 100, theorem 2.1). Without pivoting it takes a fraction of an LU's time; how good it is depends on Theta, so
/// solve() looks. Ordering by AMD.
#include <memory>
#include <optional>

#include "lcp/kernel_clock.hpp"

namespace perp::lcp {

/// sigma_i = +-1 with sigma_i M_ij = sigma_j M_ji to the last bit, found from row to row along the entries off the
/// diagonal.
std::optional<Vec> signs_of(const SpMat& M);

class QuasiDefinite {
 public:
  /// No factorization is begun that would not have ended at the clock's deadline (lcp/kernel_clock.hpp).
  explicit QuasiDefinite(KernelClock = KernelClock());
  ~QuasiDefinite();

  /// Looks for signs with which the square M is symmetric to the last bit, and analyses its pattern, which holds the
  /// diagonal. False if there are none, or L has so many entries that a multifrontal LU is quicker. Throws
  /// std::bad_alloc.
  bool analyze(const SpMat& M);
  /// K = M but for the diagonal. False where a pivot is zero or not finite. Throws KernelTooLong, std::bad_alloc.
  bool factor(const SpMat& K);
  /// K x = b with the last factor(), which was true, and steps of refinement. False if that leaves a residual of more
  /// than `accuracy` max |b_i|.
  bool solve(const SpMat& K, In b, Out x, double accuracy) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perp::lcp
