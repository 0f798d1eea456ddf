// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Invertible representation of a basis B = A(:, basis), updated one column at a time:
///     B <- B + (a_q - B e_p) e_p'.
/// A is n x m; besides its own columns 0 .. m-1 the basis may use the unit columns e_i, numbered m + i.
///
/// Columns with one entry (slacks: variables at their bounds) are set aside, so that only the active block C is
/// factored:
///     B = [ D  S ]   rows of the slacks        x_a = C^-1 b_a,   x_s = D^-1 (b_s - S x_a).
///         [ 0  C ]   the other rows
/// Later columns are in product form:  B_k = B_0 E_1 ... E_k,  E_j the identity with column p_j replaced by
/// B_{j-1}^-1 a_q (Dantzig & Orchard-Hays 1954; measured within 1.5x of the best Forrest-Tomlin codes). Solves with
/// sparse right-hand sides take time proportional to the entries they touch where the library gives its factors
/// (LuBackend::General).
#include <memory>
#include <span>
#include <vector>

#include "lcp/lu/sparse_lu.hpp"
#include "lcp/lu/sparse_vector.hpp"

namespace perp::lcp {

struct BasisOptions {
  LuBackend lu = LuBackend::Auto;
  int refactor_every = 500;   ///< stale() after so many replacements
  double fill_limit = 64;     ///< stale() when the eta file has more than this many entries per nonzero of B and row
  double growth_limit = 1e6;  ///< stale() after a replacement with max |d_i / d_p| above this
  /// stale() when the solves have passed through this many entries of the eta file per entry of L + U: then they have
  /// cost as much as a factorization (UMFPACK: some 300 such passes; anything from 120 to 700 is about as good), the
  /// least average a replacement.
  double work_limit = 300;
  double drift_limit = 1e-9;   ///< stale() when ||B d - a_q|| of a replacement exceeds this x (||a_q|| + || |B| |d| ||)
  double unstable_tol = 1e-8;  ///< replace(): Unstable if |pivot| < this x the largest entry of its column
  double singular_tol = 1e-13;  ///< replace(): Singular if |pivot| < this x the largest entry of its column
  /// factor_repaired(): a column is dependent if its pivot is below this x its largest entry on the way.
  double dependent_tol = 1e-11;
  SharedLu* shared = nullptr;  ///< with other bases, which outlives them; null: an own factorization
};

class BasisFactor {
 public:
  enum class Update {
    Ok,
    Unstable,  ///< made, but the pivot was small: refactor before trusting it
    Singular,  ///< refused: the new basis is singular; the old one is still represented
  };
  /// A column found to depend on the others, and the unit column put in its place.
  struct Dependency {
    Index position;
    Index column;
    Index row;
  };

  explicit BasisFactor(const SpMat& A, BasisOptions = {});  ///< m >= n; A outlives *this, its values may change
  ~BasisFactor();
  BasisFactor(BasisFactor&&) noexcept;
  BasisFactor& operator=(BasisFactor&&) noexcept;

  /// Factors A(:, basis) afresh; basis holds n column indices of A, or m + i for e_i.
  [[nodiscard]] LuStatus factor(std::span<const Index> basis);
  /// The same, but dependent columns are replaced by unit columns and reported in `replaced`. Singular only if the
  /// repaired basis is, too.
  [[nodiscard]] LuStatus factor_repaired(std::span<const Index> basis, std::vector<Dependency>& replaced);

  // Solves: x of B x = b by positions, b by rows. One thread at a time: they share workspace.
  void ftran(In b, Out x) const;                             ///< B  x = b
  void ftran(const SparseVector& b, SparseVector& x) const;  ///< the same; x is overwritten
  void ftran_column(Index q, SparseVector& x) const;         ///< B  x = a_q
  void btran(In b, Out x) const;                             ///< B' x = b
  void btran(const SparseVector& b, SparseVector& x) const;
  /// b - B x, from the columns themselves.
  Vec residual(In b, In x) const;

  /// Puts column q of A at position p of the basis; `ftran_of_q` = B^-1 a_q.
  [[nodiscard]] Update replace(Index p, Index q, In ftran_of_q);
  [[nodiscard]] Update replace(Index p, Index q, const SparseVector& ftran_of_q);

  /// Estimate of 1 / (||B||_1 ||B^-1||_1) of the present basis (SparseLu::rcond()); 0 if the last factor() was not Ok.
  double rcond() const;
  /// Whether the pivots of the last factor() leave no doubt that rcond() is far above rounding: costs no solve. Pre:
  /// nothing has been replaced, and nobody else has factored with a shared LU, since then.
  bool surely_regular() const;

  int updates() const;  ///< since the last factor()
  bool stale() const;   ///< refactor now: length, fill, work, growth or drift
  int factorizations() const;
  const std::vector<Index>& basis() const;
  Index active() const;  ///< order of the block C that the last factor() factored

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perp::lcp
