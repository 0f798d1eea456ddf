// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "lcp/lu/lu_backend.hpp"
#include "lcp/lu/past_zeros.hpp"

namespace perp::lcp {
namespace {

/// Row-scaled dense LU with partial pivoting: for matrices so small that the bookkeeping of the sparse codes is most of
/// their work. Most entries are zero all the same, and a column with a zero in the row of the pivot is left alone.
class DenseLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat&) override { return LuStatus::Ok; }

  LuStatus factor(const SpMat& A) override {
    pivot_ratio_ = 0;
    scale_ = row_scale(A).cwiseInverse();
    if (!scale_.allFinite()) return LuStatus::Singular;
    const Index n = A.rows();
    lu_.setZero(n, n);
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(A, j); it; ++it) lu_(it.row(), j) = scale_[it.row()] * it.value();
    rows_.resize(at(n));
    std::iota(rows_.begin(), rows_.end(), 0);
    double least = infinity;
    double most = 0;
    for (Index k = 0; k < n; ++k) {
      const double pivot = std::abs(eliminate(k));
      if (!(pivot > 0)) return LuStatus::Singular;
      least = std::min(least, pivot);
      most = std::max(most, pivot);
    }
    if (std::isfinite(most)) pivot_ratio_ = least / most;
    return pivot_ratio_ > 0 ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
    const Index n = A.rows();
    if (!transposed) {
      for (Index k = 0; k < n; ++k) x[k] = b[rows_[at(k)]] * scale_[rows_[at(k)]];
      for (Index k = 0; k < n; ++k)
        if (x[k] != 0) x.tail(n - k - 1) -= x[k] * lu_.col(k).tail(n - k - 1);
      for (Index k = n; k-- > 0;) {
        if (x[k] == 0) continue;
        x[k] /= lu_(k, k);
        x.head(k) -= x[k] * lu_.col(k).head(k);
      }
      return;
    }
    Vec y = b;  // (P' L U)' = U' L' P
    for (Index k = 0; k < n; ++k) y[k] = (y[k] - lu_.col(k).head(k).dot(y.head(k))) / lu_(k, k);
    for (Index k = n; k-- > 0;) y[k] -= lu_.col(k).tail(n - k - 1).dot(y.tail(n - k - 1));
    for (Index k = 0; k < n; ++k) x[rows_[at(k)]] = y[k] * scale_[rows_[at(k)]];
  }

  double pivot_ratio() const override { return pivot_ratio_; }
  bool gives_factors() const override { return false; }

 private:
  /// Step k; returns the pivot.
  double eliminate(Index k) {
    const Index n = lu_.rows();
    Index p = k;
    for (Index i = k + 1; i < n; ++i)
      if (std::abs(lu_(i, k)) > std::abs(lu_(p, k))) p = i;
    const double pivot = lu_(p, k);
    if (pivot == 0) return 0;
    if (p != k) {
      lu_.row(p).swap(lu_.row(k));
      std::swap(rows_[at(p)], rows_[at(k)]);
    }
    auto l = lu_.col(k).tail(n - k - 1);
    l /= pivot;
    for (Index j = k + 1; j < n; ++j)
      if (const double u = lu_(k, j); u != 0) lu_.col(j).tail(n - k - 1) -= u * l;
    return pivot;
  }

  double pivot_ratio_ = 0;
  Vec scale_;
  ::Eigen::MatrixXd lu_;   // L - I + U
  std::vector<int> rows_;  // step k has the pivot in this row
};

}  // namespace

std::unique_ptr<LuLibrary> make_dense() { return std::make_unique<DenseLu>(); }

}  // namespace perp::lcp
