// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sparse LU of one square matrix, P A Q = L U, over UMFPACK, KLU or Eigen, the only place where the three appear.
/// PERP_GPL=OFF: no UMFPACK (lcp/gpl.hpp). LuBackend::Auto takes L L' of large positive definite matrices. The symbolic
/// analysis (ordering, elimination tree) is kept while the sparsity pattern of A is unchanged. References: Davis, ACM
/// TOMS 30 (2004) 196 (UMFPACK); Davis & Palamadai Natarajan, TOMS 37 (2010) 36 (KLU).
#include <memory>
#include <string_view>

#include "lcp/types.hpp"

namespace perp::lcp {

struct LuFactors;  // lu_factors.hpp

enum class LuBackend {
  General,  ///< for any size: UMFPACK; without it "mixed", which is KLU or, where that has much to do, Eigen's
  Klu,
  Eigen,  ///< its sparse LU
  Dense,  ///< partial pivoting in a full matrix, rows scaled
  Auto,   ///< Dense up to 32 rows, Klu up to 300; beyond, Cholesky (lcp/cholesky) of matrices that are symmetric up to
          ///< 1e-15 and positive definite beyond doubt, General of others
};
enum class LuStatus {
  Ok,
  Singular,   ///< structurally, or an exactly zero (or not finite) pivot; near-singularity is told by rcond()
  NotFinite,  ///< A holds a NaN or an infinity
};
std::string_view to_string(LuBackend);  ///< as the options name it
std::string_view to_string(LuStatus);

class SparseLu {
 public:
  explicit SparseLu(LuBackend = LuBackend::General);
  ~SparseLu();
  SparseLu(SparseLu&&) noexcept;
  SparseLu& operator=(SparseLu&&) noexcept;

  /// Factors A. That is copied: it may change or die afterwards. The matrix that was factored last is not factored
  /// again. Throws std::invalid_argument if A is not square, std::bad_alloc (NotEnoughMemory, by the estimate) where
  /// the factors do not fit, or have more than 2^31 entries.
  [[nodiscard]] LuStatus factor(const SpMat& A);
  /// From now on Klu, and Auto where it has 33 to 300 rows, try the pivots of one matrix for the next of its pattern,
  /// in half of the time or less. P, Q, pivot_ratio(), last digits and, near singularity, the status may then depend on
  /// the matrices before.
  void reuse_pivots();

  // Solves with the last factor(); pre: that was Ok, else std::logic_error. b and x have n rows, may not overlap.
  void solve(In b, Out x) const;             ///< A  x = b
  void solve_transposed(In b, Out x) const;  ///< A' x = b
  /// A x = b with steps of iterative refinement while the residual shrinks (at most `steps`).
  void solve_refined(In b, Out x, int steps = 3) const;

  /// Estimate of 1 / (||A||_1 ||A^-1||_1), in [0, 1]; 0 if the last factor() was not Ok. Costs about four solves.
  /// ||A^-1||_1 by Hager's method in Higham's form (ACM TOMS 14 (1988) 381, algorithm 4.1): a lower bound, rarely
  /// off by more than three.
  double rcond() const;

  /// min |U_ii| / max |U_ii| of the last factor(), which costs nothing: a large one speaks for a regular matrix, though
  /// no proof, a small one says nothing. 0 if that was not Ok or the library does not tell (Eigen).
  double pivot_ratio() const;

  /// Copies L, U and the permutations, for solves with sparse right-hand sides. General gives them of Singular, too,
  /// with the zero pivots in their places. False where the library gives none (Dense, Klu) or nothing is
  /// factored. Throws bad_alloc.
  bool factors(LuFactors& out) const;
  bool gives_factors() const;  ///< whether factors() may be true

  Index size() const;
  /// Symbolic analyses made since construction: one a pattern.
  int analyses() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A factorization that several use in turn, for its analysis: matrices of one pattern are analysed once. Not for two
/// threads at once.
struct SharedLu {
  SparseLu lu;
  const void* user = nullptr;  ///< whose matrix `lu` has the factors of
};

}  // namespace perp::lcp
