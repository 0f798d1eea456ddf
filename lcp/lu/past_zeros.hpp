// SPDX-License-Identifier: Apache-2.0
#pragma once
/// LU of singular matrices, which the libraries but for UMFPACK do not show. Private to lcp/lu/.
#include <span>
#include <utility>
#include <vector>

#include "lcp/lu/lu_factors.hpp"

namespace perp::lcp {

/// The largest size of an entry of each row.
Vec row_scale(const SpMat& A);

/// Gilbert & Peierls' factorization, which goes on past columns without a pivot: they come last, with the rows that are
/// left. The pivot is in the row of A with the fewest entries of those where it is large enough.
class PastZeros {
 public:
  /// What is left of a column below this part of what it was is rounding.
  static constexpr double rounding = 1e-14;

  /// A column without an entry above `zero` times its largest on the way, rows scaled, has no pivot.
  PastZeros(const SpMat& A, std::span<const int> order, double zero = rounding);

  /// The columns without a pivot, and as many rows that none has its pivot in.
  const std::vector<int>& dependent() const { return dependent_; }
  std::vector<int> rows_left() const;
  /// Not to be called twice.
  void extract(LuFactors& out);

 private:
  void eliminate(int column, int mark, double zero);
  int pivot(double least) const;
  void reach(int root, int mark);

  const SpMat& A_;
  Vec scale_;
  std::vector<int> row_entries_;
  Triangle L_;  // its rows are A's until the end
  Triangle U_, U_dependent_;
  std::vector<double> pivot_;
  std::vector<int> step_of_row_, pivot_row_, order_, dependent_;
  Vec x_;
  std::vector<int> seen_, reached_;
  std::vector<std::pair<int, int>> stack_;
};

}  // namespace perp::lcp
