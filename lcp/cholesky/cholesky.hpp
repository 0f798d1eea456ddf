// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sparse Cholesky factorization of one symmetric positive definite matrix, P A P' = L L', over CHOLMOD: the only place
/// where it appears. Its numbers are our own where it is supernodal (lcp/cholesky/cholesky_supernodal.hpp). Ordering by
/// CHOLMOD's defaults (AMD, METIS where AMD's fill is large) or the best of three, supernodal where that pays. A build
/// with PERP_GPL=OFF (lcp/gpl.hpp) orders by AMD and computes L itself, row by row. The symbolic analysis and the
/// memory of L are kept while the pattern of A, above the diagonal too, is unchanged. Reference: Chen, Davis, Hager &
/// Rajamanickam, ACM TOMS 35 (2008) 22.
#include <memory>
#include <string_view>
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

enum class CholeskyStatus {
  Ok,
  NotPositiveDefinite,  ///< a pivot is not positive: see failed_column(), failed_direction()
  NotFinite,            ///< A holds a NaN or an infinity
  OutOfMemory,          ///< the factor does not fit, or has more than 2^31 entries
};
std::string_view to_string(CholeskyStatus);

enum class CholeskyOrdering {
  Quick,    ///< CHOLMOD's defaults
  Thorough  ///< where those take long, the best of AMD, METIS and CHOLMOD's nested dissection: for many factorizations
};

/// L by columns, the diagonal first in each. Row k of P A P' is row order[k] of A.
struct CholeskyColumns {
  std::vector<int> order{};
  std::vector<int> start{0};
  std::vector<int> row{};
  std::vector<double> value{};
};

class Cholesky {
 public:
  explicit Cholesky(CholeskyOrdering = CholeskyOrdering::Quick);
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;

  /// From now on P A P' = L S L' with S = diag(+-1), the sign of each row of A: quasi-definite matrices have such an L
  /// for every P (Vanderbei, SIAM J. Optim. 5 (1995) 100, theorem 2.1). "Positive" below reads "of the sign asked for";
  /// columns() and failed_direction() have no meaning then.
  void set_signs(std::vector<signed char> signs);

  /// Factors the symmetric matrix whose lower triangle is A's; what A holds above its diagonal is not read. A is not
  /// kept but for its pattern: it may change or die afterwards. Answers OutOfMemory before the factorization if L would
  /// have more than `entries` entries. Throws std::invalid_argument if A is not square.
  ///
  /// Rounding decides about matrices that are nearly singular: Ok says that A is within n eps ||A|| of a positive
  /// definite matrix, NotPositiveDefinite that it is within that of one that is not (Higham, Accuracy and Stability of
  /// Numerical Algorithms, 2nd ed. 2002, theorems 10.3, 10.7 and 10.14). rcond() and failed_direction() tell how near.
  [[nodiscard]] CholeskyStatus factor(const SpMat& A, double entries = infinity);
  /// factor(): true if Ok, false if A is not positive definite. Throws std::bad_alloc if OutOfMemory.
  [[nodiscard]] bool try_factor(const SpMat& A);

  /// The analysis alone: what factor() of a matrix with this pattern will take. Throws as factor() does.
  [[nodiscard]] CholeskyStatus analyze(const SpMat& A);
  double flops() const;  ///< of the last analysis: the sum of squares of the entries in each column of L
  int analyses() const;  ///< made since construction: one a pattern

  /// A x = b with the last factor(); pre: that was Ok, else std::logic_error. b and x have n entries. Throws
  /// std::bad_alloc where there is no memory. Solves with one factor may run in two threads.
  void solve(In b, Out x) const;
  /// The same for all columns of X at once, in their place.
  void solve_columns(Eigen::MatrixXd& X) const;

  /// If the last factor() was Ok: (min L_jj / max L_jj)^2, not below 1 / cond_2(A) and often near it. Else 0.
  double rcond() const;

  /// If the last factor() answered NotPositiveDefinite: the column of A, from 0, at whose pivot it stopped. Else -1.
  Index failed_column() const;
  /// Then also the direction d with d'A d = that pivot <= 0, d_k = 1 in that column: up to rounding a witness that A is
  /// not positive definite. Empty otherwise, or where there was no memory for it.
  const Vec& failed_direction() const;

  /// A copy of the factor; pre: the last factor() was Ok, else std::logic_error, and nonzeros() fit an int.
  CholeskyColumns columns() const;

  Index size() const;
  /// Entries of L, after an analysis.
  double nonzeros() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perp::lcp
