// SPDX-License-Identifier: Apache-2.0
#pragma once
/// (M + diag(d)) x = b for one M and many d > 0, the systems of interior points and of their cells: by L S L' where
/// row factors make M symmetric (lcp/linalg/quasi_definite.hpp), by sparse LU otherwise, or where L S L' meets a pivot
/// of a wrong sign. Private to lcp/iterative/.
#include "lcp/linalg/quasi_definite.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

class ShiftedSystem {
 public:
  /// M has its diagonal in its pattern and outlives *this.
  ShiftedSystem(const SpMat& M, LuBackend lu);

  /// M has been given other values, in its pattern.
  void update();
  /// Row factors that make M symmetric, or null.
  const Vec* rows() const { return symmetric_ ? &ldlt_.rows() : nullptr; }
  /// Cost of a factorization, in solves.
  double dearness() const;

  LuStatus factor(const Vec& d);
  /// Solves with the last factor(), which was Ok, and refines.
  void solve(const Vec& b, Vec& x) const;
  int factorizations() const { return factorizations_; }

 private:
  LuStatus factor_by_lu();
  Vec solved(const Vec& b) const;

  const SpMat& M_;
  QuasiDefinite ldlt_;
  SparseLu lu_;
  SpMat K_;
  Vec d_, weight_;  ///< of a row's residual: 1 / max(1, d_i)
  bool symmetric_ = false;
  bool by_lu_ = false;  ///< the last factor() was
  int factorizations_ = 0;
};

}  // namespace perp::lcp
