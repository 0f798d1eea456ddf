// SPDX-License-Identifier: Apache-2.0
/// The library of Cholesky in a build without CHOLMOD (PERP_GPL=OFF): AMD's ordering, then L row by row, each by a
/// triangular solve along the elimination tree (Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134).
#include <amd.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "lcp/cholesky/cholesky_library.hpp"

namespace perp::lcp {
namespace {

class UpLooking final : public CholeskyLibrary {
 public:
  void set_signs(std::vector<signed char> signs) override { signs_ = std::move(signs); }
  CholeskyStatus analyze(const SpMat& A) override {
    n_ = A.rows();
    order_.resize(at(n_));
    // AMD orders the pattern of A + A'; what A holds above its diagonal is no part of the matrix.
    const SpMat lower = A.triangularView<Eigen::Lower>();
    const int code =
        amd_order(static_cast<int>(n_), lower.outerIndexPtr(), lower.innerIndexPtr(), order_.data(), nullptr, nullptr);
    if (code < AMD_OK) return CholeskyStatus::OutOfMemory;
    place_.resize(at(n_));
    for (Index k = 0; k < n_; ++k) place_[at(order_[at(k)])] = static_cast<int>(k);
    take(A);
    elimination_tree();
    return CholeskyStatus::Ok;
  }
  double entries() const override { return entries_; }
  double flops() const override { return flops_; }

  CholeskyStatus factor(const SpMat& A) override {
    take(A);
    start_.assign(at(n_) + 1, 0);
    for (Index k = 0; k < n_; ++k) start_[at(k) + 1] = start_[at(k)] + count_[at(k)];
    row_.resize(start_.back());
    value_.resize(start_.back());
    end_.assign(start_.begin(), start_.end() - 1);
    Vec y = Vec::Zero(n_);
    std::vector<int> mark(at(n_), -1);
    std::vector<int> path(at(n_));
    for (failed_ = 0; failed_ < n_; ++failed_)
      if (!eliminate(static_cast<int>(failed_), y, mark, path)) return CholeskyStatus::NotPositiveDefinite;
    return CholeskyStatus::Ok;
  }

  double rcond() override {
    double least = infinity;
    double most = 0;
    for (Index k = 0; k < n_; ++k) {
      const double pivot = value_[start_[at(k)]];
      if (!std::isfinite(pivot)) return 0;
      least = std::min(least, pivot);
      most = std::max(most, pivot);
    }
    return least / most * (least / most);
  }

  void solve(In b, Out x) const override {
    Vec y(n_);
    for (Index k = 0; k < n_; ++k) y[k] = b[order_[at(k)]];
    for (Index k = 0; k < n_; ++k) {
      Index e = start_[at(k)];
      const double yk = y[k] /= value_[e];
      for (++e; e < start_[at(k) + 1]; ++e) y[row_[e]] -= value_[e] * yk;
    }
    for (Index k = 0; k < n_; ++k) y[k] *= sign(k);
    back_substitute(y, n_);
    for (Index k = 0; k < n_; ++k) x[order_[at(k)]] = y[k];
  }

  CholeskyColumns columns() const override {
    CholeskyColumns L{.order = order_};
    L.start.assign(start_.begin(), start_.end());
    L.row.assign(row_.begin(), row_.end());
    L.value.assign(value_.begin(), value_.end());
    return L;
  }

  Index failed_column() const override { return order_[at(failed_)]; }

  /// With k the failed pivot and B = L L' the leading k x k block of P A P' = (B b; b' beta): d = P'(-B^-1 b, 1, 0) has
  /// d'A d = beta - b'B^-1 b, the pivot. L^-1 b is row k of the factor, which is there already.
  Vec witness(const SpMat&) override {
    Vec y = Vec::Zero(n_);
    for (Index j = 0; j < failed_; ++j)
      if (end_[at(j)] > start_[at(j)] && row_[end_[at(j)] - 1] == failed_) y[j] = -value_[--end_[at(j)]];
    back_substitute(y, failed_);
    y[failed_] = 1;
    Vec d = Vec::Zero(n_);
    for (Index k = 0; k <= failed_; ++k) d[order_[at(k)]] = y[k];
    return d.allFinite() ? d : Vec();
  }

 private:
  /// The upper triangle of P A P', by columns.
  void take(const SpMat& A) {
    upper_start_.assign(at(n_) + 1, 0);
    for_lower(A, [&](int, int j, double) { ++upper_start_[at(j) + 1]; });
    for (Index j = 0; j < n_; ++j) upper_start_[at(j) + 1] += upper_start_[at(j)];
    upper_.resize(at(upper_start_.back()));
    std::vector<int> next(upper_start_.begin(), upper_start_.end() - 1);
    for_lower(A, [&](int i, int j, double v) { upper_[at(next[at(j)]++)] = {i, v}; });
  }
  std::span<const std::pair<int, double>> upper(int j) const {
    return {upper_.data() + upper_start_[at(j)], upper_.data() + upper_start_[at(j) + 1]};
  }
  template <class F>
  void for_lower(const SpMat& A, F f) const {  // f(row, column, value), row <= column
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator it(A, j); it; ++it) {
        if (it.row() < j) continue;
        const int a = place_[at(it.row())];
        const int b = place_[at(j)];
        f(std::min(a, b), std::max(a, b), it.value());
      }
  }

  void elimination_tree() {
    parent_.assign(at(n_), -1);
    count_.assign(at(n_), 1);
    std::vector<int> mark(at(n_), -1);
    for (int k = 0; k < n_; ++k) {
      mark[at(k)] = k;
      for (const auto& [row, value] : upper(k))
        for (int i = row; mark[at(i)] != k; i = parent_[at(i)]) {
          if (parent_[at(i)] < 0) parent_[at(i)] = k;
          ++count_[at(i)];
          mark[at(i)] = k;
        }
    }
    entries_ = flops_ = 0;
    for (const Index c : count_) {
      entries_ += static_cast<double>(c);
      flops_ += static_cast<double>(c) * static_cast<double>(c);
    }
  }

  /// Row k of L. False: its pivot is not positive.
  bool eliminate(int k, Vec& y, std::vector<int>& mark, std::vector<int>& path) {
    Index top = n_;
    double pivot = 0;
    mark[at(k)] = k;
    for (const auto& [row, value] : upper(k)) {
      if (row == k) {
        pivot = value;
        continue;
      }
      y[row] = value;
      int i = row;
      Index length = 0;
      for (; mark[at(i)] != k; i = parent_[at(i)]) {
        path[at(length++)] = i;
        mark[at(i)] = k;
      }
      while (length > 0) path[at(--top)] = path[at(--length)];
    }
    for (; top < n_; ++top) {
      const auto i = at(path[at(top)]);
      Index e = start_[i];
      const double value = std::exchange(y[path[at(top)]], 0.0) / value_[e];  // times the column's sign: L_ki
      for (++e; e < end_[i]; ++e) y[row_[e]] -= value_[e] * value;
      const double s = sign(path[at(top)]);
      pivot -= s * value * value;
      row_[e] = k;
      value_[e] = s * value;
      end_[i] = e + 1;
    }
    pivot *= sign(k);
    if (pivot <= 0) return false;  // not a number: rcond() tells
    row_[start_[at(k)]] = k;
    value_[start_[at(k)]] = std::sqrt(pivot);
    end_[at(k)] = start_[at(k)] + 1;
    return true;
  }

  /// y <- L^-T y with the first `size` rows.
  void back_substitute(Vec& y, Index size) const {
    for (Index k = size - 1; k >= 0; --k) {
      double sum = y[k];
      const Index end = size == n_ ? start_[at(k) + 1] : end_[at(k)];
      for (Index e = start_[at(k)] + 1; e < end; ++e) sum -= value_[e] * y[row_[e]];
      y[k] = sum / value_[start_[at(k)]];
    }
  }

  double sign(Index k) const { return signs_.empty() ? 1 : signs_[at(order_[at(k)])]; }

  Index n_ = 0;
  std::vector<signed char> signs_;  // of A's rows; empty: all positive
  std::vector<int> order_, place_;
  std::vector<int> upper_start_;
  std::vector<std::pair<int, double>> upper_;
  std::vector<int> parent_;
  std::vector<Index> count_;
  double entries_ = 0;
  double flops_ = 0;
  // L by columns, the diagonal first. end_: of what there is of them.
  std::vector<Index> start_, end_;
  ::Eigen::VectorXi row_;
  Vec value_;
  Index failed_ = 0;
};

}  // namespace

std::unique_ptr<CholeskyLibrary> make_cholesky(CholeskyOrdering) { return std::make_unique<UpLooking>(); }

}  // namespace perp::lcp
