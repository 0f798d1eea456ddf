// SPDX-License-Identifier: Apache-2.0
#pragma once
/// K y = b for a sparse square K by one LU factorization, with K scaled symmetrically by powers of two, and y refined
/// to twice the precision where that is wanted: each correction reduces the error by eps / rcond. References: Moler, J.
/// ACM 14 (1967) 316; Demmel et al., ACM TOMS 32 (2006) 325 (extra-precise refinement); Ruiz 2001 (scaling).
#include <functional>
#include <optional>
#include <vector>

#include "lcp/judge/two_part_vector.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/lu/sparse_vector.hpp"

namespace perp::lcp {

class RefinedLu {
 public:
  /// Throws std::invalid_argument if K is not square, std::bad_alloc if the factors do not fit.
  explicit RefinedLu(SpMat K);

  Index size() const { return K_.rows(); }
  LuStatus status() const { return status_; }
  double rcond() const { return rcond_; }  ///< of the scaled K; 1 of none
  /// Whether K is regular up to rounding: factored, and rcond at least 1e-15.
  bool regular() const;
  bool symmetric() const { return symmetric_; }  ///< K, bit by bit
  /// Of the rows and columns of K, when it was factored.
  const Vec& scale() const { return D_; }
  /// Unknowns that K couples, however indirectly, have the same number, from 0.
  const std::vector<int>& part_of() const { return part_of_; }
  double entries_of_factors() const;

  // Pre: status() is Ok. Several threads may call them at once.
  Vec solve(In b) const;
  /// Until a correction of y is below doubt() of it, in its part of K and its units. Nothing where one stays above
  /// `largest_last` of the largest entry there; 0: above that doubt.
  std::optional<TwoPartVector> refined(const TwoPartVector& b, double largest_last = 0) const;
  /// What entries of y = refined(b) may be off by: 64 eps^2 / rcond of the largest in their part and its units, and of
  /// `terms`, the sizes of what was added up in b.
  Vec doubt(const TwoPartVector& y, In terms) const;
  /// take(j, z) for column z of K^-1 B, by solves with sparse right-hand sides, without refinement, until take() is
  /// false.
  void for_each_column(const SpMat& B, const std::function<bool(Index j, const SparseVector& z)>& take) const;
  /// B' K^-1 B, refined where rcond is below 1e-6; nothing where that does not come to an end. An entry is left out
  /// where |S_ij| <= drop sqrt(|S_ii S_jj|): rounding of what is zero by structure.
  std::optional<SpMat> schur(const SpMat& B, double drop) const;

 private:
  double share_in_doubt() const;
  bool add_refined_columns(const SpMat& B, std::vector<Eigen::Triplet<double>>& entries) const;

  SpMat K_;  // D K D
  Vec D_;
  SparseLu lu_;
  LuStatus status_ = LuStatus::Ok;
  double rcond_ = 1;
  bool symmetric_ = false;
  std::vector<int> part_of_;
};

}  // namespace perp::lcp
