// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/lu_factors.hpp"

#include <algorithm>
#include <utility>

namespace perp::lcp {

Triangle Triangle::transpose() const {
  const auto n = static_cast<std::size_t>(size());
  Triangle T;
  T.start.assign(n + 1, 0);
  for (const int i : row) ++T.start[static_cast<std::size_t>(i) + 1];
  for (std::size_t i = 0; i < n; ++i) T.start[i + 1] += T.start[i];
  T.row.resize(row.size());
  T.value.resize(value.size());
  std::vector<int> next(T.start.begin(), T.start.end() - 1);
  for (std::size_t j = 0; j < n; ++j)
    for (auto k = static_cast<std::size_t>(start[j]); k < static_cast<std::size_t>(start[j + 1]); ++k) {
      const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(row[k])]++);
      T.row[at] = static_cast<int>(j);
      T.value[at] = value[k];
    }
  return T;
}

void LuFactors::finish() {
  const auto inverse = [](const std::vector<int>& permutation) {
    std::vector<int> result(permutation.size());
    for (std::size_t k = 0; k < permutation.size(); ++k)
      result[static_cast<std::size_t>(permutation[k])] = static_cast<int>(k);
    return result;
  };
  P_inverse = inverse(P);
  Q_inverse = inverse(Q);
}

LuSolver::LuSolver(LuFactors factors)
    : factors_(std::move(factors)),
      work_(factors_.size()),
      next_(static_cast<std::size_t>(factors_.size())),
      seen_(static_cast<std::size_t>(factors_.size()), 0) {}

/// The places that T^-1 may make nonzero, in an order in which every one comes before those it changes (reversed in
/// order_). False if they are so many that going through all columns is cheaper.
bool LuSolver::reach(const Triangle& T) {
  const std::size_t most = static_cast<std::size_t>(size()) / 5;
  order_.clear();
  bool few = true;
  for (const int root : work_.places()) {
    if (seen_[static_cast<std::size_t>(root)]) continue;
    stack_.assign(1, root);
    seen_[static_cast<std::size_t>(root)] = 1;
    next_[static_cast<std::size_t>(root)] = T.start[static_cast<std::size_t>(root)];
    while (!stack_.empty()) {
      const auto j = static_cast<std::size_t>(stack_.back());
      if (next_[j] == T.start[j + 1]) {
        order_.push_back(stack_.back());
        stack_.pop_back();
        continue;
      }
      const int i = T.row[static_cast<std::size_t>(next_[j]++)];
      if (seen_[static_cast<std::size_t>(i)]) continue;
      seen_[static_cast<std::size_t>(i)] = 1;
      next_[static_cast<std::size_t>(i)] = T.start[static_cast<std::size_t>(i)];
      stack_.push_back(i);
    }
    if (order_.size() > most) {
      few = false;
      break;
    }
  }
  for (const auto* visited : {&order_, &stack_})
    for (const int i : *visited) seen_[static_cast<std::size_t>(i)] = 0;
  stack_.clear();
  return few;
}

/// work_ <- T^-1 work_, with the diagonal given or unit.
void LuSolver::eliminate(const Triangle& T, bool ascending, const Vec* diagonal, double& density) {
  constexpr double dense = 0.1;
  double* x = work_.data();
  Index nonzeros = 0;
  const auto column = [&](std::size_t j) {
    if (x[j] == 0) return;
    ++nonzeros;
    if (diagonal != nullptr) x[j] /= (*diagonal)[static_cast<Index>(j)];
    const double xj = x[j];
    for (auto k = static_cast<std::size_t>(T.start[j]); k < static_cast<std::size_t>(T.start[j + 1]); ++k)
      x[T.row[k]] -= T.value[k] * xj;
  };
  const auto learn = [&] {
    density = 0.75 * density + 0.25 * static_cast<double>(nonzeros) / static_cast<double>(size());
  };
  if (!work_.full() && density < dense && reach(T)) {
    for (auto j = order_.rbegin(); j != order_.rend(); ++j) column(static_cast<std::size_t>(*j));
    for (const int i : order_) work_.list(i);
    learn();
    return;
  }
  work_.set_full();
  const auto n = static_cast<std::size_t>(size());
  if (ascending)
    for (std::size_t j = 0; j < n; ++j) column(j);
  else
    for (std::size_t j = n; j-- > 0;) column(j);
  learn();
}

void LuSolver::solve(const SparseVector& b, SparseVector& x) {
  const LuFactors& f = factors_;
  work_.clear();
  b.for_each([&](Index i, double v) { work_.set(f.P_inverse[static_cast<std::size_t>(i)], v * f.R[i]); });
  eliminate(f.L, true, nullptr, dense_L_);
  eliminate(f.U, false, &f.diagonal, dense_U_);
  x.clear();
  work_.for_each([&](Index k, double v) { x.set(f.Q[static_cast<std::size_t>(k)], v); });
}

void LuSolver::solve_transposed(const SparseVector& b, SparseVector& x) {
  LuFactors& f = factors_;
  if (f.U_transposed.size() != f.size()) f.U_transposed = f.U.transpose();
  work_.clear();
  b.for_each([&](Index j, double v) { work_.set(f.Q_inverse[static_cast<std::size_t>(j)], v); });
  eliminate(f.U_transposed, true, &f.diagonal, dense_Ut_);
  eliminate(f.L_transposed, false, nullptr, dense_Lt_);
  x.clear();
  work_.for_each([&](Index k, double v) {
    const int i = f.P[static_cast<std::size_t>(k)];
    x.set(i, v * f.R[i]);
  });
}

}  // namespace perp::lcp
