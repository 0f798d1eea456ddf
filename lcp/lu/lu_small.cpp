// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "lcp/lu/lu_backend.hpp"
#include "lcp/lu/markowitz.hpp"
#include "lcp/lu/past_zeros.hpp"

namespace perp::lcp {
namespace {

/// 1 / the largest entry of each row. False if one of them is no number.
bool inverse_row_scale(const SpMat& A, Vec& scale) {
  scale = row_scale(A).cwiseInverse();
  return scale.allFinite();
}

/// 0 where no factors with these pivots are Ok.
double ratio_of_pivots(double least, double most) { return least > 0 && std::isfinite(most) ? least / most : 0; }

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

double largest(const std::vector<double>& values) {
  double found = 0;
  for (const double v : values) found = std::max(found, std::abs(v));
  return found;
}

/// Row-scaled dense LU with partial pivoting: for matrices so small that the bookkeeping of the sparse codes is most of
/// their work. Most entries are zero all the same, and a column with a zero in the row of the pivot is left alone.
class DenseLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat&) override { return LuStatus::Ok; }

  LuStatus factor(const SpMat& A) override {
    pivot_ratio_ = 0;
    if (!inverse_row_scale(A, scale_)) return LuStatus::Singular;
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
    pivot_ratio_ = ratio_of_pivots(least, most);
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

/// Of matrices of some hundred rows: the libraries' own analysis takes longer than these factors.
class SmallLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat&) override {
    known_ = false;
    return LuStatus::Ok;
  }

  LuStatus factor(const SpMat& A) override {
    pivot_ratio_ = 0;
    const bool known = std::exchange(known_, false);
    if (!inverse_row_scale(A, scale_)) return LuStatus::Singular;
    known_ =
        (reuse_ && known && lu_.factor_again(A, scale_) && !grown() && usable()) || (lu_.factor(A, scale_) && usable());
    return known_ ? LuStatus::Ok : LuStatus::Singular;
  }

  void reuse_pivots() override { reuse_ = true; }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
    const Index n = A.rows();
    Vec y(n);
    if (transposed) {
      for (Index k = 0; k < n; ++k) y[k] = (b[lu_.Q[at(k)]] - product(lu_.U, k, y)) / lu_.diagonal[at(k)];
      for (Index k = n; k-- > 0;) y[k] -= product(lu_.L, k, y);
      for (Index k = 0; k < n; ++k) x[lu_.P[at(k)]] = y[k] * scale_[lu_.P[at(k)]];
      return;
    }
    for (Index k = 0; k < n; ++k) y[k] = b[lu_.P[at(k)]] * scale_[lu_.P[at(k)]];
    for (Index k = 0; k < n; ++k) subtract(lu_.L, k, y);
    for (Index k = n; k-- > 0;) {
      y[k] /= lu_.diagonal[at(k)];
      subtract(lu_.U, k, y);
    }
    for (Index k = 0; k < n; ++k) x[lu_.Q[at(k)]] = y[k];
  }

  double pivot_ratio() const override { return pivot_ratio_; }

  bool factors(LuFactors& out) const override {
    if (!(pivot_ratio_ > 0)) return false;
    const auto n = static_cast<Index>(lu_.diagonal.size());
    out.L = lu_.L;
    out.U = lu_.U;
    out.L_transposed = out.U_transposed = Triangle{};
    out.diagonal = Eigen::Map<const Vec>(lu_.diagonal.data(), n);
    out.P = lu_.P;
    out.Q = lu_.Q;
    out.R = scale_;
    out.blocks = {0, static_cast<int>(n)};
    out.finish();
    return true;
  }

 private:
  /// Whether the factors are numbers: a pivot that is the only entry of its row may be so small that L has infinities.
  bool usable() {
    pivot_ratio_ = 0;
    if (!finite(lu_.diagonal) || !finite(lu_.L.value) || !finite(lu_.U.value)) return false;
    const auto pivots = Eigen::Map<const Vec>(lu_.diagonal.data(), static_cast<Index>(lu_.diagonal.size())).cwiseAbs();
    pivot_ratio_ = ratio_of_pivots(pivots.minCoeff(), pivots.maxCoeff());
    return pivot_ratio_ > 0;
  }
  /// Whether entries of U are large beside those of the scaled matrix, which are at most one: digits are lost then.
  bool grown() const { return std::max(largest(lu_.diagonal), largest(lu_.U.value)) > most_growth_again; }

  static double product(const Triangle& T, Index k, const Vec& y) {
    double sum = 0;
    for (auto e = at(T.start[at(k)]); e < at(T.start[at(k) + 1]); ++e) sum += T.value[e] * y[T.row[e]];
    return sum;
  }
  static void subtract(const Triangle& T, Index k, Vec& y) {
    const double yk = y[k];
    if (yk == 0) return;
    for (auto e = at(T.start[at(k)]); e < at(T.start[at(k) + 1]); ++e) y[T.row[e]] -= T.value[e] * yk;
  }

  Vec scale_;
  Markowitz lu_;
  bool reuse_ = false;
  bool known_ = false;  // the pivots of a matrix with this pattern
  double pivot_ratio_ = 0;
};

}  // namespace

std::unique_ptr<LuLibrary> make_dense() { return std::make_unique<DenseLu>(); }
std::unique_ptr<LuLibrary> make_small() { return std::make_unique<SmallLu>(); }

}  // namespace perp::lcp
