#pragma once
/// Invertible representation of a basis B = A(:, basis), updated one column at a time:
///     B <- B + (a_q - B e_p) e_p'.
/// Product form of the inverse over any SparseLu: B_k = B_0 E_1 ... E_k, E_j the identity with column p_j replaced by
/// B_{j-1}^-1 a_q (Dantzig & Orchard-Hays 1954). Measured within 1.5x of the best Forrest-Tomlin codes over UMFPACK.
#include <span>
#include <vector>

#include "lcp/sparse_lu.hpp"

namespace perp::lcp {

struct BasisOptions {
  LuBackend lu = LuBackend::Umfpack;
  int refactor_every = 64;      ///< stale() after so many replacements
  double fill_limit = 4;        ///< stale() when the eta file has more than this many entries per nonzero of B
  double unstable_tol = 1e-8;   ///< replace(): Unstable if |pivot| < this x the largest entry of its column
  double singular_tol = 1e-13;  ///< replace(): Singular if |pivot| < this x the largest entry of its column
};

class BasisFactor {
 public:
  enum class Update {
    Ok,
    Unstable,  ///< made, but the pivot was small: refactor before trusting it
    Singular,  ///< refused: the new basis is singular; the old one is still represented
  };

  explicit BasisFactor(const SpMat& A, BasisOptions = {});  ///< A is n x m, m >= n, and outlives *this

  /// Factors A(:, basis) afresh; basis holds n column indices of A.
  [[nodiscard]] LuStatus factor(std::span<const Index> basis);
  void ftran(In b, Out x) const;  ///< B  x = b
  void btran(In b, Out x) const;  ///< B' x = b
  /// Puts column q of A at position p of the basis; `ftran_of_q` = B^-1 a_q.
  [[nodiscard]] Update replace(Index p, Index q, In ftran_of_q);

  /// SparseLu::rcond() of the basis at the last factor().
  double rcond() const { return lu_.rcond(); }

  int updates() const { return static_cast<int>(etas_.size()); }  ///< since the last factor()
  bool stale() const;                                             ///< refactor now: length or fill
  int factorizations() const { return factorizations_; }
  const std::vector<Index>& basis() const { return basis_; }
  const SpMat& matrix() const { return B_; }  ///< A(:, basis) at the last factor()

 private:
  struct Eta {
    Index p;
    double pivot;
    std::vector<int> rows;  // the other nonzeros of the column
    std::vector<double> values;
  };
  const SpMat* A_;
  BasisOptions options_;
  SparseLu lu_;
  SpMat B_;
  std::vector<Index> basis_;
  std::vector<Eta> etas_;
  std::size_t eta_entries_ = 0;
  int factorizations_ = 0;
};

}  // namespace perp::lcp
