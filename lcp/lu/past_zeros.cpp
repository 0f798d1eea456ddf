// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/past_zeros.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {

Vec row_scale(const SpMat& A) {
  Vec largest = Vec::Zero(A.rows());
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) largest[it.row()] = std::max(largest[it.row()], std::abs(it.value()));
  return largest;
}

PastZeros::PastZeros(const SpMat& A, std::span<const int> order, double zero) : A_(A), scale_(row_scale(A)) {
  const Index n = A.rows();
  for (double& s : scale_) s = s > 0 ? 1 / s : 1;
  row_entries_.assign(at(n), 0);
  for (Index k = 0; k < A.nonZeros(); ++k) ++row_entries_[at(A.innerIndexPtr()[k])];
  step_of_row_.assign(at(n), -1);
  seen_.assign(at(n), -1);
  x_ = Vec::Zero(n);
  for (std::size_t k = 0; k < order.size(); ++k) eliminate(order[k], static_cast<int>(k), zero);
}

std::vector<int> PastZeros::rows_left() const {
  std::vector<int> rows;
  for (std::size_t i = 0; i < step_of_row_.size(); ++i)
    if (step_of_row_[i] < 0) rows.push_back(static_cast<int>(i));
  return rows;
}

void PastZeros::extract(LuFactors& out) {
  for (const int i : rows_left()) {
    step_of_row_[at(i)] = static_cast<int>(pivot_row_.size());
    pivot_row_.push_back(i);
  }
  for (int& i : L_.row) i = step_of_row_[at(i)];
  const std::size_t regular = order_.size();
  for (std::size_t k = 0; k < dependent_.size(); ++k) L_.end_column();
  order_.insert(order_.end(), dependent_.begin(), dependent_.end());
  for (std::size_t j = 0; j < dependent_.size(); ++j) {
    for (int k = U_dependent_.start[j]; k < U_dependent_.start[j + 1]; ++k)
      U_.push(U_dependent_.row[at(k)], U_dependent_.value[at(k)]);
    U_.end_column();
  }
  out.diagonal = Vec::Zero(A_.rows());
  std::copy_n(pivot_.begin(), regular, out.diagonal.begin());
  out.L = std::move(L_);
  out.U = std::move(U_);
  out.L_transposed = out.L.transpose();
  out.U_transposed = Triangle{};
  out.P = pivot_row_;
  out.Q = order_;
  out.R = scale_;
  out.finish();
}

/// The row of the pivot of the column in x_; -1 if none is above `least`.
int PastZeros::pivot(double least) const {
  double largest = 0;
  for (const int i : reached_)
    if (step_of_row_[at(i)] < 0) largest = std::max(largest, std::abs(x_[i]));
  if (!(largest > least)) return -1;
  constexpr double large_enough = 0.1;
  const auto better = [this](int i, int than) {
    const int fewer = row_entries_[at(than)] - row_entries_[at(i)];
    return fewer > 0 || (fewer == 0 && std::abs(x_[i]) > std::abs(x_[than]));
  };
  int best = -1;
  for (const int i : reached_)
    if (step_of_row_[at(i)] < 0 && std::abs(x_[i]) > least && std::abs(x_[i]) >= large_enough * largest &&
        (best < 0 || better(i, best)))
      best = i;
  return best;
}

void PastZeros::eliminate(int column, int mark, double zero) {
  reached_.clear();
  double size = 0;
  for (SpMat::InnerIterator it(A_, column); it; ++it) {
    x_[it.row()] = it.value() * scale_[it.row()];
    size = std::max(size, std::abs(x_[it.row()]));
    reach(static_cast<int>(it.row()), mark);
  }
  std::vector<std::pair<int, double>> upper;
  for (auto i = reached_.rbegin(); i != reached_.rend(); ++i) {
    const int step = step_of_row_[at(*i)];
    const double value = x_[*i];
    if (step < 0 || value == 0) continue;
    upper.emplace_back(step, value);
    size = std::max(size, std::abs(value));
    for (int k = L_.start[at(step)]; k < L_.start[at(step) + 1]; ++k) x_[L_.row[at(k)]] -= L_.value[at(k)] * value;
  }
  const int best = pivot(zero * size);
  Triangle& U = best < 0 ? U_dependent_ : U_;
  for (const auto& [step, value] : upper) U.push(step, value);
  U.end_column();
  if (best < 0) {
    dependent_.push_back(column);
  } else {
    const double value = x_[best];
    step_of_row_[at(best)] = static_cast<int>(order_.size());
    pivot_row_.push_back(best);
    pivot_.push_back(value);
    order_.push_back(column);
    for (const int i : reached_)
      if (step_of_row_[at(i)] < 0 && x_[i] != 0) L_.push(i, x_[i] / value);
    L_.end_column();
  }
  for (const int i : reached_) x_[i] = 0;
}

/// Appends what `root` leads to through L, each row after those it leads to.
void PastZeros::reach(int root, int mark) {
  if (seen_[at(root)] == mark) return;
  const auto begin_of = [this](int i) {
    const int step = step_of_row_[at(i)];
    return step < 0 ? 0 : L_.start[at(step)];
  };
  const auto end_of = [this](int i) {
    const int step = step_of_row_[at(i)];
    return step < 0 ? 0 : L_.start[at(step) + 1];
  };
  seen_[at(root)] = mark;
  stack_.assign(1, {root, begin_of(root)});
  while (!stack_.empty()) {
    const int i = stack_.back().first;
    if (stack_.back().second == end_of(i)) {
      reached_.push_back(i);
      stack_.pop_back();
      continue;
    }
    const int next = L_.row[at(stack_.back().second++)];
    if (std::exchange(seen_[at(next)], mark) != mark) stack_.emplace_back(next, begin_of(next));
  }
}

}  // namespace perp::lcp
