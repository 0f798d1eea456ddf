// SPDX-License-Identifier: Apache-2.0
#pragma once
/// L D L' of principal blocks of one matrix M that is symmetric but for the signs of its rows, as those of quadratic
/// programs are: S M = (S M)', S = diag(+-1). One ordering serves all blocks, for the fill of a block is part of the
/// fill of M (Rose, Tarjan & Lueker, SIAM J. Comput. 5 (1976) 266, lemma 4): a block has no analysis of its own.
/// Nothing is pivoted, which is safe where the block is quasi-definite (Vanderbei, SIAM J. Optim. 5 (1995) 100);
/// solve() looks whether it was good enough.
#include <vector>

#include "lcp/types.hpp"

namespace perp::lcp {

class SignedBlocks {
 public:
  /// False if M has no such signs, to the last bit, or its fill is much.
  bool analyze(const SpMat& M);
  /// Of the block of the rows and columns that are `in`, + lambda I. False where a pivot cancels to nothing.
  bool factor(const std::vector<bool>& in, double lambda);
  /// x_I = (M_II + lambda I)^-1 b_I with the last factor(), which was true; x = 0 elsewhere, b has all rows. False if
  /// that leaves a residual of more than `accuracy` max |b_I|.
  bool solve(In b, double accuracy, Vec& x) const;
  /// M + M' is positive semidefinite to rounding, by its L D L'. False: perhaps not. Takes the place of factor().
  bool semidefinite();

 private:
  struct Entry {
    int row;  ///< earlier in the order
    double value;
  };
  bool order(const SpMat& M);
  void take(const SpMat& M);
  bool fill_is_little();
  /// Row k of L from the entries of rows that are of use; D_k, and the size of the terms it is the sum of.
  template <class Use>
  double eliminate(int k, double diagonal, Use use, double& size);
  void residual(const Vec& x, Vec& r) const;

  Index n_ = 0;
  std::vector<int> order_, place_;
  Vec sign_, diagonal_;     // of S M, in the order
  std::vector<int> start_;  // of the strict upper triangle of S M, by columns
  std::vector<Entry> upper_;
  std::vector<int> column_, end_;  // L by columns: where they begin, with room for the fill of M, and end
  std::vector<int> row_;
  std::vector<double> value_;
  std::vector<double> D_;
  std::vector<int> parent_, mark_, path_;
  std::vector<double> y_;
  std::vector<char> in_;  // in the order
  double lambda_ = 0;
};

}  // namespace perp::lcp
