// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lcp/lu/lu_backend.hpp"

namespace perp::lcp {
namespace {

/// Row-scaled dense LU with partial pivoting: for matrices so small that the bookkeeping of the sparse codes is most of
/// their work.
class DenseLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat&) override { return LuStatus::Ok; }

  LuStatus factor(const SpMat& A) override {
    const Index n = A.rows();
    scale_.setZero(n);
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(A, j); it; ++it) scale_[it.row()] = std::max(scale_[it.row()], std::abs(it.value()));
    if (!(scale_.minCoeff() > 0)) return LuStatus::Singular;
    scale_ = scale_.cwiseInverse();
    if (!scale_.allFinite()) return LuStatus::Singular;
    scaled_.setZero(n, n);
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(A, j); it; ++it) scaled_(it.row(), j) = scale_[it.row()] * it.value();
    lu_.compute(scaled_);
    const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
    const double least = pivots.minCoeff();
    const double most = pivots.maxCoeff();
    pivot_ratio_ = std::isfinite(most) && most > 0 ? least / most : 0;
    return pivot_ratio_ > 0 ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(const SpMat& /*A*/, In b, Out x, bool transposed) const override {
    if (!transposed) {
      x = lu_.solve(scale_.cwiseProduct(b));
      return;
    }
    Vec y = b;  // (P' L U)' = U' L' P
    lu_.matrixLU().transpose().triangularView<::Eigen::Lower>().solveInPlace(y);
    lu_.matrixLU().transpose().triangularView<::Eigen::UnitUpper>().solveInPlace(y);
    x = scale_.cwiseProduct(lu_.permutationP().transpose() * y);
  }

  double pivot_ratio() const override { return pivot_ratio_; }

 private:
  double pivot_ratio_ = 0;
  Vec scale_;
  ::Eigen::MatrixXd scaled_;
  ::Eigen::PartialPivLU<::Eigen::MatrixXd> lu_;
};

}  // namespace

std::unique_ptr<LuLibrary> make_dense() { return std::make_unique<DenseLu>(); }

}  // namespace perp::lcp
