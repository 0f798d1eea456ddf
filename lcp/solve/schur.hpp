// SPDX-License-Identifier: Apache-2.0
#pragma once
/// S = B' K^-1 B  and  x = K^-1 f  for a sparse square K and a sparse B, column by column through one sparse LU
/// factorization with sparse right-hand sides: nothing dense of more than one column is held, and blocks of K that a
/// column of B does not meet cost it nothing (Gilbert & Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862). x is
/// refined with residuals in twice the precision, and where K is ill-conditioned the columns are, too, one dense column
/// at a time.
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/types.hpp"

namespace perp::lcp {

struct Schur {
  /// Whether K is regular up to rounding: factored, rcond at least 1e-15, and converged.
  bool regular() const;

  LuStatus status = LuStatus::Ok;
  double rcond = 0;       ///< of K with rows and columns scaled by powers of two
  bool converged = true;  ///< whether what had to be refined came to an end
  SpMat S;                ///< columns of B squared; empty unless status is Ok
  Vec x;                  ///< rows of K; empty unless status is Ok
  Vec image;              ///< B' x + w, of x before it was rounded; empty unless status is Ok
  Vec scale;              ///< of the rows and columns of K, when it was factored
};

/// The same S as an operator on vectors: y = K^-1 B r is refined until a correction is below 1e-22 of its largest
/// entry, and B' y is added up in twice the precision. For those to whom the entries of S are not exact enough. Used by
/// several threads at once.
class SchurProduct {
 public:
  /// Throws std::invalid_argument as schur() does, std::bad_alloc if the factors do not fit.
  SchurProduct(const SpMat& K, const SpMat& B);
  /// S r + w; NaN where K is singular or its solutions do not converge. O(entries of K and of its factors, and of B).
  Vec operator()(In r, In w) const;

 private:
  SparseLu lu_;
  LuStatus status_ = LuStatus::Ok;
  SpMat K_;  // scaled by rows and columns
  SpMat B_;
};

/// An entry of S is left out where |S_ij| <= drop sqrt(|S_ii S_jj|): rounding of what is zero by structure.
/// Throws std::invalid_argument if K is not square or sizes differ.
Schur schur(const SpMat& K, const SpMat& B, In f, double drop);
/// With w, 0 above, in `image`.
Schur schur(const SpMat& K, const SpMat& B, In f, In w, double drop);

}  // namespace perp::lcp
