// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Factors of M + diag(d), d > 0, for the M of linear and quadratic programs: with signs S = diag(+-1),
///     S (M + diag(d)) = (Q + D_1   -A'    )        Q, R positive semidefinite, D positive diagonal,
///                       (-A       -R - D_2),
/// is symmetric and quasi-definite. It has an L S L' for every symmetric permutation (Vanderbei, SIAM J. Optim. 5
/// (1995) 100, theorem 2.1), which takes what a Cholesky factorization does. How good it is depends on d.
/// More generally R (M + diag(d)) with a diagonal R of any entries but zero may be: R is found with S, the signs of R.
#include <optional>
#include <vector>

#include "lcp/cholesky/cholesky.hpp"

namespace perp::lcp {

/// sigma_i = +-1 with sigma_i M_ij = sigma_j M_ji to the last bit, found from row to row along the entries off the
/// diagonal.
std::optional<Vec> signs_of(const SpMat& M);

/// Returns M with a place for each entry of its diagonal, zeros where it has none.
SpMat with_diagonal(const SpMat& M);

class QuasiDefinite {
 public:
  QuasiDefinite();

  /// Looks for R with which the square M is symmetric but for rounding, and analyses its pattern, which holds the
  /// diagonal and is symmetric. False if there is none. Entries that meet a zero of the pattern are left out of the
  /// factors. Another M of the same pattern costs no more than its entries. Throws std::bad_alloc.
  bool analyze(const SpMat& M);
  /// Factors M + diag(d). False where a pivot has not the sign of its row, or is not finite. Throws
  /// std::bad_alloc.
  bool factor(In d);
  /// (M + diag(d)) x = b with the last factor(), which was true. Without refinement.
  void solve(In b, Out x) const;

  const Vec& rows() const { return R_; }                    ///< R
  double flops() const { return cholesky_.flops(); }        ///< of factor()
  double nonzeros() const { return cholesky_.nonzeros(); }  ///< of L

 private:
  Vec R_;
  std::vector<signed char> signs_;  ///< of R
  SpMat lower_;                     ///< of R M; its diagonal comes first in each column
  Vec diagonal_;                    ///< of R M
  Cholesky cholesky_;
};

}  // namespace perp::lcp
