// SPDX-License-Identifier: Apache-2.0
#pragma once
/// KLU as a library of SparseLu. Private to lcp/lu/.
#include <klu.h>

#include <span>
#include <vector>

#include "lcp/lu/lu_backend.hpp"

namespace perp::lcp {

class Klu final : public LuLibrary {
 public:
  Klu();
  Klu(const Klu&) = delete;
  Klu& operator=(const Klu&) = delete;
  ~Klu() override;

  LuStatus analyze(const SpMat& A) override;
  FactorCost cost() const override;
  LuStatus factor(const SpMat& A) override;
  void reuse_pivots() override { reuse_ = true; }
  void solve(const SpMat& A, In b, Out x, bool transposed) const override;
  /// factor() with the pivots of the last one that was Ok, without a request for memory. False where one has vanished.
  bool refactor(const SpMat& A);
  /// solve() by one thread at a time, without a request for memory.
  void solve_in_place(Out b) { klu_solve(symbolic_, numeric_, numeric_->n, 1, b.data(), &common_); }
  double pivot_ratio() const override { return common_.rcond; }

  /// The order of the columns that analyze() found, block triangular and AMD within the blocks. Pre: it was Ok.
  std::span<const int> columns_in_order() const { return {symbolic_->Q, at(symbolic_->n)}; }
  bool gives_factors() const override { return false; }  // klu_solve is as quick
  /// The factors of the whole matrix, from those of its diagonal blocks; pre: the last factor() was Ok.
  void extract(LuFactors& out) const;
  /// What the last factor() came to, not estimated; pre: it was Ok.
  FactorCost spent() const;

 private:
  bool factor_again();
  std::vector<int> extract_blocks(LuFactors& out) const;
  LuStatus status() const;

  klu_common common_{};
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_ = nullptr;
  SpMat pattern_;
  bool factored_ = false;  // the last factor() was Ok
  bool reuse_ = false;
};

}  // namespace perp::lcp
