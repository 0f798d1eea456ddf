// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The numbers of a supernodal Cholesky factor whose shape is known, over Eigen's kernels: CHOLMOD's own factorization
/// takes what time BLAS takes, and Debian's reference BLAS takes five times what Eigen does. Right-looking: the update
/// of a supernode's ancestors is computed a panel of columns at a time, and then subtracted where they are. No threads.
/// Reference: Ng & Peyton, SIAM J. Sci. Comput. 14 (1993) 1034. Private to lcp/cholesky/.
#include <span>
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

/// Supernode s has the columns first[s] to first[s + 1] - 1 of P A P' = L L'. Its rows, these columns among them, are
/// those from rows_at[s] on in `rows`, ascending; its values a dense block from values_at[s] on.
struct SupernodalShape {
  std::span<const int> first;
  std::span<const int> rows_at;
  std::span<const int> values_at;
  std::span<const int> rows;
};

class SupernodalFactor {
 public:
  /// Of matrices with the pattern of A, whose row order[k] is the k-th of P A P'. `signs` of A's rows: P A P' = L S L';
  /// empty: all are positive. `shape` outlives *this.
  SupernodalFactor(const SpMat& A, std::span<const int> order, std::span<const signed char> signs,
                   const SupernodalShape& shape);

  /// L into its values; what A holds above the diagonal is not read. The first column of P A P' whose pivot has not
  /// its sign, or n: columns before that one are complete in the rows before it.
  Index factor(const SpMat& A, std::span<double> values);

  /// x <- (P A P')^-1 x, columns of a matrix or a vector, with these values of L. From several threads, too.
  template <class X>
  void solve(std::span<const double> values, X& x) const;

 private:
  Index eliminate(std::size_t s, double* values) const;
  void update_ancestors(std::size_t s, double* values);
  void locate(std::size_t s, Index from, std::size_t ancestor);

  SupernodalShape shape_;
  Vec signs_;                  // of the columns of P A P'
  std::vector<int> owner_;     // the supernode of each column
  std::vector<int> places_;    // of A's entries among the values; -1: above the diagonal
  std::vector<int> relative_;  // where the rows of a supernode are in its ancestor
  Eigen::MatrixXd update_;
};

}  // namespace perp::lcp
