// SPDX-License-Identifier: Apache-2.0
#pragma once
/// KLU's factors of matrices with one pattern and changing numbers: the order and the pivots of the first one serve the
/// others, at a quarter of the price and without requests for memory.
#include <memory>

#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

/// One object may be used by one thread at a time.
class RefactoredLu {
 public:
  RefactoredLu();
  ~RefactoredLu();
  RefactoredLu(RefactoredLu&&) noexcept;
  RefactoredLu& operator=(RefactoredLu&&) noexcept;

  /// Chooses order and pivots. Pre: A is square, compressed, finite.
  LuStatus factor(const SpMat& A);
  /// Of another matrix with the pattern of the last factor(), which was Ok; asks for no memory. False where a pivot has
  /// vanished: there are no factors then. Small pivots show in the residual of what is solved.
  bool refactor(const SpMat& A);
  /// b <- A^-1 b; asks for no memory. Pre: there are factors.
  void solve(Out b);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perp::lcp
