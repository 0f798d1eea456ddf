// SPDX-License-Identifier: Apache-2.0
#pragma once
/// S = B' K^-1 B  and  x = K^-1 f  for a sparse square K and a sparse B, column by column through one sparse LU
/// factorization with sparse right-hand sides: nothing dense of more than one column is held, and blocks of K that a
/// column of B does not meet cost it nothing (Gilbert & Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862). x is
/// refined with residuals in twice the precision, and where K is ill-conditioned the columns are, too, one dense column
/// at a time (lcp/solve/refined_lu.hpp).
#include <memory>

#include "lcp/solve/refined_lu.hpp"

namespace perp::lcp {

struct Schur {
  /// Whether K is regular up to rounding, and what had to be refined came to an end.
  bool regular() const { return K->regular() && converged; }

  std::shared_ptr<const RefinedLu> K{};  ///< its factors
  bool converged = true;
  SpMat S{};  ///< columns of B squared; empty unless regular()
  Vec x{};    ///< rows of K; empty unless regular()
};

/// An entry of S is left out where |S_ij| <= drop sqrt(|S_ii S_jj|): rounding of what is zero by structure.
/// Throws std::invalid_argument if K is not square or sizes differ, std::bad_alloc if the factors do not fit.
Schur schur(const SpMat& K, const SpMat& B, In f, double drop);

/// Numbers that are added up to twice the precision, and their sizes: the sums of the absolute values of the terms.
struct TwoPartSums {
  explicit TwoPartSums(Vec start) : sum(start), terms(start.cwiseAbs()) {}
  /// + factor A x
  void add_product(const SpMat& A, In x, double factor = 1);

  TwoPartVector sum;
  Vec terms;
};

/// B' K^-1 b + w.
struct SchurImage {
  Vec value;
  Vec doubt;  ///< what each may be off by besides its rounding
  Vec terms;  ///< |B|' |K^-1 b| + |w|
};
/// K^-1 b refined to twice the precision and all added up in as much. NaN where K is singular or its solution does not
/// converge. O(entries of K and of its factors, and of B).
SchurImage schur_image(const RefinedLu& K, const SpMat& B, const TwoPartSums& b, const TwoPartSums& w);

/// W_0 + sign B' K^-1 B as an operator on vectors: K^-1 B r is refined to twice the precision, and what is made of it
/// added up in as much. For those to whom the entries of the matrix are not exact enough. Used by several threads at
/// once.
class SchurProduct {
 public:
  /// Throws std::invalid_argument if sizes differ. Without W_0: 0.
  SchurProduct(std::shared_ptr<const RefinedLu> K, SpMat B, double sign = 1, SpMat W_0 = {});

  bool symmetric() const { return symmetric_; }  ///< K and W_0, bit by bit
  double rcond() const { return K_->rcond(); }   ///< of K
  /// (W_0 + sign B' K^-1 B) r + w.
  SchurImage operator()(In r, In w) const;
  /// sign B' K^-1 f + w; 0 where it cancels to 64 eps^2 of what is added up.
  Vec offset(In f, In w) const;
  /// The entries, symmetric if it is; nothing where they do not converge.
  std::optional<SpMat> matrix(double drop) const;

 private:
  std::shared_ptr<const RefinedLu> K_;
  SpMat B_;
  double sign_;
  SpMat W_0_;
  bool symmetric_;
};

}  // namespace perp::lcp
