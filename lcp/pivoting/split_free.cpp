// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/split_free.hpp"

#include <algorithm>
#include <utility>

#include "lcp/judge/result.hpp"

namespace perp::lcp {
namespace {

constexpr Index unsplit = -1;

/// [M, -M_S; -M_S', M_SS] in the signs of z+ and z-: row and column of z-_k are those of split[k], negated.
SpMat split_matrix(const SpMat& M, const std::vector<Index>& split) {
  const Index n = M.rows();
  std::vector<Index> number(at(n), unsplit);
  for (std::size_t k = 0; k < split.size(); ++k) number[at(split[k])] = static_cast<Index>(k);
  const Index m = n + static_cast<Index>(split.size());
  SpMat A(m, m);
  A.reserve(2 * M.nonZeros());
  const auto column = [&](Index from, Index to, double sign) {
    A.startVec(to);
    for (SpMat::InnerIterator it(M, from); it; ++it) A.insertBack(it.row(), to) = sign * it.value();
    for (SpMat::InnerIterator it(M, from); it; ++it)  // the numbers ascend with the rows
      if (const Index k = number[at(it.row())]; k != unsplit) A.insertBack(n + k, to) = -sign * it.value();
  };
  for (Index j = 0; j < n; ++j) column(j, j, 1);
  for (std::size_t k = 0; k < split.size(); ++k) column(split[k], n + static_cast<Index>(k), -1);
  A.finalize();
  return A;
}

}  // namespace

SplitFree::SplitFree(const AffineMcp& problem, std::vector<Index> dependent, const LemkeOptions& options)
    : problem_(problem),
      split_(std::move(dependent)),
      tolerance_(options.residual_tol * (1 + problem.q.lpNorm<::Eigen::Infinity>())) {
  const auto is_free = [&](Index i) { return problem.box.is_free(i); };
  if (!std::ranges::all_of(split_, is_free)) {
    split_.clear();
    for (Index i = 0; i < problem.size(); ++i)
      if (is_free(i)) split_.push_back(i);
  }
  const Index n = problem.size();
  const auto extra = static_cast<Index>(split_.size());
  const auto extended = [&](const Vec& v) {
    Vec longer(n + extra);
    longer.head(n) = v;
    return longer;
  };
  split_problem_ = {
      split_matrix(problem.M, split_), extended(problem.q), {extended(problem.box.lower), extended(problem.box.upper)}};
  for (Index k = 0; k < extra; ++k) {
    const Index i = split_[at(k)];
    split_problem_.q[n + k] = -problem.q[i];
    split_problem_.box.lower[i] = split_problem_.box.lower[n + k] = 0;
    split_problem_.box.upper[n + k] = infinity;
  }
}

Vec SplitFree::there(In x) const {
  const Index n = problem_.size();
  Vec longer(split_problem_.size());
  longer.head(n) = x;
  for (std::size_t k = 0; k < split_.size(); ++k) {
    const double z = x[split_[k]];
    longer[split_[k]] = std::max(z, 0.0);
    longer[n + static_cast<Index>(k)] = std::max(-z, 0.0);
  }
  return longer;
}

LemkeOptions SplitFree::there(const LemkeOptions& options) const {
  LemkeOptions longer = options;
  longer.cells.clear();  // a ray has cells of its own
  if (options.cover != Cover::Given) return longer;
  longer.covering.conservativeResize(split_problem_.size());
  for (std::size_t k = 0; k < split_.size(); ++k)
    longer.covering[problem_.size() + static_cast<Index>(k)] = options.covering[split_[k]];
  return longer;
}

/// At a solution F_i = 0 of a free variable, and its x_i is z_i.
Vec SplitFree::back(const Vec& x) const {
  const Index n = problem_.size();
  if (x.size() != split_problem_.size()) return x;
  Vec shorter = x.head(n);
  for (std::size_t k = 0; k < split_.size(); ++k)
    shorter[split_[k]] = std::max(x[split_[k]], 0.0) - std::max(x[n + static_cast<Index>(k)], 0.0);
  return shorter;
}

PivotResult SplitFree::back(PivotResult result) const {
  const Index n = problem_.size();
  const auto extra = static_cast<Index>(split_.size());
  const auto difference = [&](const Vec& y) {
    Vec shorter = y.head(n);
    for (Index k = 0; k < extra; ++k) shorter[split_[at(k)]] -= y[n + k];
    return shorter;
  };
  if (result.certificate.size() > 0) {
    const Vec y = difference(result.certificate);
    const double size = y.lpNorm<::Eigen::Infinity>();
    result.certificate = size > 0 ? exact_certificate(problem_, y / size) : Vec();
  }
  if (result.ray.size() > 0) {
    for (Index k = 0; k < extra; ++k)  // outside its box a part of the pair stands still
      for (const Index i : {split_[at(k)], n + k})
        if (result.cells[at(i)] != Cell::Inside) result.ray[i] = 0;
    result.ray = difference(result.ray);
  }
  result.x = back(result.x);
  result.best_x = back(result.best_x);
  for (Breakpoint& kink : result.path) kink.x = back(kink.x);
  if (result.cells.size() == at(n + extra)) {
    result.cells.resize(at(n));
    for (const Index i : split_) result.cells[at(i)] = Cell::Inside;
  }
  result.z = project(problem_.box, result.x);
  result.residual = natural_residual(problem_, result.z);
  if (result.solved() && !(result.residual <= tolerance_)) result.end = PivotEnd::Inaccurate;
  result.repaired += static_cast<int>(extra);
  result.last_piece.reset();  // its factors are those of the split problem
  return result;
}

}  // namespace perp::lcp
