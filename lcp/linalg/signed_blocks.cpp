// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/signed_blocks.hpp"

#include <amd.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lcp/linalg/quasi_definite.hpp"

namespace perp::lcp {
namespace {

/// Entries of L, of all of M, from which on blocks are better ordered each for itself.
constexpr Index most_fill = 20'000;
/// A pivot below this share of the terms it is the sum of has lost its digits.
constexpr double cancelled = 1e-10;

}  // namespace

bool SignedBlocks::order(const SpMat& M) {
  order_.resize(at(n_));
  if (amd_order(static_cast<int>(n_), M.outerIndexPtr(), M.innerIndexPtr(), order_.data(), nullptr, nullptr) < AMD_OK)
    return false;
  place_.resize(at(n_));
  for (Index k = 0; k < n_; ++k) place_[at(order_[at(k)])] = static_cast<int>(k);
  return true;
}

void SignedBlocks::take(const SpMat& M) {
  diagonal_ = Vec::Zero(n_);
  start_.assign(1, 0);
  upper_.clear();
  upper_.reserve(at(M.nonZeros() / 2));
  for (int k = 0; k < n_; ++k) {  // row k of S M is its column k
    const int j = order_[at(k)];
    for (int p = M.outerIndexPtr()[j]; p < M.outerIndexPtr()[j + 1]; ++p) {
      const int i = place_[at(M.innerIndexPtr()[p])];
      const double value = sign_[i] * M.valuePtr()[p];
      if (i == k)
        diagonal_[k] = value;
      else if (i < k && value != 0)
        upper_.push_back({i, value});
    }
    start_.push_back(static_cast<int>(upper_.size()));
  }
}

/// Counts the entries of L by its elimination tree.
bool SignedBlocks::fill_is_little() {
  parent_.assign(at(n_), -1);
  mark_.assign(at(n_), -1);
  std::vector<int> count(at(n_), 0);
  Index total = 0;
  for (int k = 0; k < n_; ++k) {
    mark_[at(k)] = k;
    for (int e = start_[at(k)]; e < start_[at(k) + 1]; ++e)
      for (int i = upper_[at(e)].row; mark_[at(i)] != k; i = parent_[at(i)]) {
        if (parent_[at(i)] < 0) parent_[at(i)] = k;
        ++count[at(i)];
        ++total;
        mark_[at(i)] = k;
      }
    if (total > most_fill) return false;
  }
  column_.assign(1, 0);
  for (const int c : count) column_.push_back(column_.back() + c);
  row_.resize(at(total));
  value_.resize(at(total));
  return true;
}

bool SignedBlocks::analyze(const SpMat& M) {
  n_ = M.rows();
  const std::optional<Vec> sigma = signs_of(M);
  if (!sigma || !order(M)) return false;
  sign_.resize(n_);
  for (Index k = 0; k < n_; ++k) sign_[k] = (*sigma)[order_[at(k)]];
  take(M);
  end_.resize(at(n_));
  D_.resize(at(n_));
  path_.resize(at(n_));
  y_.assign(at(n_), 0);
  in_.resize(at(n_));
  return fill_is_little();
}

template <class Use>
double SignedBlocks::eliminate(int k, double diagonal, Use use, double& size) {
  const auto n = static_cast<int>(n_);
  int top = n;
  mark_[at(k)] = k;
  for (int e = start_[at(k)]; e < start_[at(k) + 1]; ++e) {
    const auto [row, value] = upper_[at(e)];
    if (!use(row)) continue;
    y_[at(row)] = value;
    int length = 0;
    for (int i = row; mark_[at(i)] != k; i = parent_[at(i)]) {
      if (parent_[at(i)] < 0) parent_[at(i)] = k;
      path_[at(length++)] = i;
      mark_[at(i)] = k;
    }
    while (length > 0) path_[at(--top)] = path_[at(--length)];
  }
  double pivot = diagonal;
  size = std::abs(diagonal);
  for (; top < n; ++top) {
    const auto i = at(path_[at(top)]);
    const double yi = std::exchange(y_[i], 0.0);
    const double l = yi / D_[i];
    const int end = end_[i];
    for (int e = column_[i]; e < end; ++e) y_[at(row_[at(e)])] -= value_[at(e)] * yi;
    pivot -= l * yi;
    size += std::abs(l * yi);
    row_[at(end)] = k;
    value_[at(end)] = l;
    end_[i] = end + 1;
  }
  return pivot;
}

bool SignedBlocks::factor(const std::vector<bool>& in, double lambda) {
  lambda_ = lambda;
  parent_.assign(at(n_), -1);
  mark_.assign(at(n_), -1);
  for (Index k = 0; k < n_; ++k) in_[at(k)] = in[at(order_[at(k)])] ? 1 : 0;
  std::copy_n(column_.begin(), n_, end_.begin());
  for (int k = 0; k < n_; ++k) {
    if (in_[at(k)] == 0) continue;
    double size = 0;
    const double pivot = eliminate(
        k, diagonal_[k] + sign_[k] * lambda, [this](int row) { return in_[at(row)] != 0; }, size);
    if (!(std::abs(pivot) > cancelled * size) || !std::isfinite(size)) {
      std::fill(y_.begin(), y_.end(), 0);
      return false;
    }
    D_[at(k)] = pivot;
  }
  return true;
}

bool SignedBlocks::semidefinite() {
  constexpr double rounding = 1e-13;
  parent_.assign(at(n_), -1);
  mark_.assign(at(n_), -1);
  std::copy_n(column_.begin(), n_, end_.begin());
  const double shift = rounding * static_cast<double>(std::max<Index>(n_, 10));
  for (int k = 0; k < n_; ++k) {
    // The entries between rows of two signs cancel in M + M'; what is left has the signs of S.
    bool empty = true;
    bool beside_zero = false;
    const auto use = [&](int row) {
      if (sign_[row] != sign_[k]) return false;
      empty = false;
      beside_zero = beside_zero || D_[at(row)] == 0;
      return true;
    };
    for (int e = start_[at(k)]; e < start_[at(k) + 1]; ++e) (void)use(upper_[at(e)].row);
    const double diagonal = sign_[k] * diagonal_[k];
    if (beside_zero || diagonal < 0 || (diagonal == 0 && !empty)) return false;
    D_[at(k)] = 0;
    if (diagonal == 0) continue;  // good where no later row has an entry here
    double size = 0;
    const double pivot = eliminate(k, sign_[k] * diagonal * (1 + shift), use, size);
    if (!(sign_[k] * pivot > 0) || !std::isfinite(size)) {
      std::fill(y_.begin(), y_.end(), 0);
      return false;
    }
    D_[at(k)] = pivot;
  }
  return true;
}

/// r <- r - (S M_II + lambda S) x, in the order.
void SignedBlocks::residual(const Vec& x, Vec& r) const {
  for (int k = 0; k < n_; ++k) {
    if (in_[at(k)] == 0) continue;
    const double xk = x[k];
    double sum = (diagonal_[k] + sign_[k] * lambda_) * xk;
    for (int e = start_[at(k)]; e < start_[at(k) + 1]; ++e) {
      const auto [row, value] = upper_[at(e)];
      if (in_[at(row)] == 0) continue;
      sum += value * x[row];
      r[row] -= value * xk;
    }
    r[k] -= sum;
  }
}

bool SignedBlocks::solve(In b, double accuracy, Vec& x) const {
  constexpr int refinements = 2;
  Vec r = Vec::Zero(n_);
  for (Index k = 0; k < n_; ++k)
    if (in_[at(k)] != 0) r[k] = sign_[k] * b[order_[at(k)]];
  const Vec rhs = r;
  const double enough = accuracy * rhs.lpNorm<::Eigen::Infinity>();
  Vec sum = Vec::Zero(n_);
  for (int step = 0; step <= refinements; ++step) {
    for (Index k = 0; k < n_; ++k)
      if (in_[at(k)] != 0 && r[k] != 0)
        for (int e = column_[at(k)]; e < end_[at(k)]; ++e) r[row_[at(e)]] -= value_[at(e)] * r[k];
    for (Index k = n_ - 1; k >= 0; --k) {
      if (in_[at(k)] == 0) continue;
      double y = r[k] / D_[at(k)];
      for (int e = column_[at(k)]; e < end_[at(k)]; ++e) y -= value_[at(e)] * r[row_[at(e)]];
      r[k] = y;
    }
    sum += r;
    r = rhs;
    residual(sum, r);
    if (!(r.lpNorm<::Eigen::Infinity>() > enough)) break;  // not a number: the sum is none
  }
  if (!sum.allFinite() || !(r.lpNorm<::Eigen::Infinity>() <= enough)) return false;
  x.resize(n_);
  for (Index k = 0; k < n_; ++k) x[order_[at(k)]] = sum[k];
  return true;
}

}  // namespace perp::lcp
