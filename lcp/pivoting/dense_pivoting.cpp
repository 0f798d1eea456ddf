// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/dense_pivoting.hpp"

#include <algorithm>

namespace perp::lcp {
namespace {

/// Rounds without fewer violated signs until the first one alone is exchanged.
constexpr int rounds_without_gain = 3;
/// Values within this x their terms are zero; pivots within this x their diagonal entry are.
constexpr double negligible = 1e-13;

}  // namespace

void DensePivoting::renew(const Eigen::MatrixXd& M) {
  largest_ = M.size() > 0 ? M.cwiseAbs().maxCoeff() : 0;
  factored_.clear();
}

bool DensePivoting::run(const DenseMcp& problem, Cells& cells, const Limits& limits) {
  const Index n = problem.size();
  Index fewest = n + 1;
  int left = rounds_without_gain;
  factorizations_ = 0;
  for (rounds_ = 0; rounds_ <= n + rounds_without_gain && !limits.reached();) {
    ++rounds_;
    if (!solve_cell(problem, cells)) return false;
    find_violated(problem, cells);
    const auto violated = static_cast<Index>(violated_.size());
    if (violated == 0) return true;
    if (violated < fewest) {
      fewest = violated;
      left = rounds_without_gain;
    } else if (left > 0) {
      --left;
    }
    if (left == 0) violated_.resize(1);
    for (const Index i : violated_) {
      const Cell beyond = z_[i] < problem.box.lower[i] ? Cell::Below : Cell::Above;
      cells[at(i)] = cells[at(i)] == Cell::Inside ? beyond : Cell::Inside;
    }
  }
  return false;
}

/// Sets z and F of the cell; false if it has none, or M is no P-matrix.
bool DensePivoting::solve_cell(const DenseMcp& problem, const Cells& cells) {
  const Index n = problem.size();
  z_.resize(n);
  F_ = problem.q;
  inside_.clear();
  for (Index j = 0; j < n; ++j) {
    if (cells[at(j)] == Cell::Inside) {
      inside_.push_back(j);
      continue;
    }
    z_[j] = cells[at(j)] == Cell::Below ? problem.box.lower[j] : problem.box.upper[j];
    if (z_[j] != 0) F_ += z_[j] * problem.M.col(j);
  }
  if (!factor(problem.M)) return false;
  x_.resize(static_cast<Index>(inside_.size()));
  for (Index k = 0; k < x_.size(); ++k) x_[k] = -F_[inside_[at(k)]];
  solve(x_);
  for (Index k = 0; k < x_.size(); ++k) {
    z_[inside_[at(k)]] = x_[k];
    F_ += x_[k] * problem.M.col(inside_[at(k)]);
  }
  return z_.allFinite() && F_.allFinite();
}

bool DensePivoting::factor(const Eigen::MatrixXd& M) {
  if (!factored_.empty() && factored_ == inside_) return true;
  factored_.clear();
  ++factorizations_;
  const auto size = static_cast<Index>(inside_.size());
  if (lu_.rows() < M.rows()) lu_.resize(M.rows(), M.rows());
  for (Index k = 0; k < size; ++k)
    for (Index i = 0; i < size; ++i) lu_(i, k) = M(inside_[at(i)], inside_[at(k)]);
  for (Index k = 0; k < size; ++k) {
    const Index i = inside_[at(k)];
    if (!(lu_(k, k) > negligible * M(i, i))) return false;
    const Index rest = size - k - 1;
    auto column = lu_.col(k).segment(k + 1, rest);
    column /= lu_(k, k);
    for (Index j = k + 1; j < size; ++j) lu_.col(j).segment(k + 1, rest) -= lu_(k, j) * column;
  }
  factored_ = inside_;
  return true;
}

void DensePivoting::solve(Vec& x) const {
  const Index size = x.size();
  for (Index k = 0; k < size; ++k) x.segment(k + 1, size - k - 1) -= x[k] * lu_.col(k).segment(k + 1, size - k - 1);
  for (Index k = size - 1; k >= 0; --k) {
    x[k] /= lu_(k, k);
    x.head(k) -= x[k] * lu_.col(k).head(k);
  }
}

void DensePivoting::find_violated(const DenseMcp& problem, const Cells& cells) {
  const double zero_F = negligible * (problem.q.lpNorm<Eigen::Infinity>() + largest_ * z_.lpNorm<1>());
  const double zero_z = largest_ > 0 ? zero_F / largest_ : 0;
  violated_.clear();
  for (Index i = 0; i < problem.size(); ++i) {
    const double l = problem.box.lower[i], u = problem.box.upper[i];
    const Cell cell = cells[at(i)];
    const bool violated = cell == Cell::Inside  ? z_[i] < l - zero_z || z_[i] > u + zero_z
                          : cell == Cell::Below ? F_[i] < -zero_F && l < u
                                                : F_[i] > zero_F;
    if (violated) violated_.push_back(i);
  }
}

void DensePivoting::correct(In F, Out z) {
  for (Index k = 0; k < x_.size(); ++k) x_[k] = F[inside_[at(k)]];
  solve(x_);
  for (Index k = 0; k < x_.size(); ++k) z[inside_[at(k)]] -= x_[k];
}

}  // namespace perp::lcp
