// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/scaled_mcp.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {

ScaledMcp::ScaledMcp(const AffineMcp& problem) : problem_(problem) {
  const Box& box = problem.box;
  std::vector<int> place(at(problem.size()), -1);
  whole_ = project(box, Vec::Zero(problem.size()));
  for (Index i = 0; i < problem.size(); ++i)
    if (box.lower[i] != box.upper[i]) {
      place[at(i)] = static_cast<int>(kept_.size());
      kept_.push_back(i);
      whole_[i] = 0;
    }
  const Vec shifted = problem.q + problem.M * whole_;  // whole_: the fixed variables
  const auto n = static_cast<Index>(kept_.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(problem.M.nonZeros() + n));
  for (Index j = 0; j < n; ++j) {
    entries.emplace_back(static_cast<int>(j), static_cast<int>(j), 0.0);
    for (SpMat::InnerIterator it(problem.M, kept_[at(j)]); it; ++it)
      if (place[at(it.row())] >= 0) entries.emplace_back(place[at(it.row())], static_cast<int>(j), it.value());
  }
  M = SpMat(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  equilibrate();
  q = Vec(n);
  for (Index k = 0; k < n; ++k) q[k] = D_[k] * shifted[kept_[at(k)]];
  const double size = n > 0 ? q.cwiseAbs().maxCoeff() : 0;
  unit_ = size > 0 && std::isfinite(size) ? size : 1;
  q /= unit_;
  l = Vec(n);
  u = Vec(n);
  for (Index k = 0; k < n; ++k) {
    l[k] = box.lower[kept_[at(k)]] / (D_[k] * unit_);
    u[k] = box.upper[kept_[at(k)]] / (D_[k] * unit_);
  }
}

Vec ScaledMcp::expand(const Vec& x) const {
  Vec z = whole_;
  for (Index k = 0; k < size(); ++k) z[kept_[at(k)]] = D_[k] * unit_ * x[k];
  return z;
}

double ScaledMcp::natural_residual(const Vec& x, const Vec& F) const {
  double worst = 0;
  for (Index k = 0; k < size(); ++k) {
    const Index i = kept_[at(k)];
    const Box& box = problem_.box;
    const double z = std::min(std::max(D_[k] * unit_ * x[k], box.lower[i]), box.upper[i]);
    const double row = std::max(z - box.upper[i], std::min(F[k] * unit_ / D_[k], z - box.lower[i]));
    worst = std::max(worst, std::abs(row));
  }
  return worst;
}

Vec ScaledMcp::expand_direction(const Vec& x) const {
  Vec d = Vec::Zero(problem_.size());
  for (Index k = 0; k < size(); ++k) d[kept_[at(k)]] = D_[k] * x[k];
  return d;
}

/// D_i of powers of two such that the largest entry of row and column i is about one.
void ScaledMcp::equilibrate() {
  const Index n = M.rows();
  D_ = Vec::Ones(n);
  for (int pass = 0; pass < 4; ++pass) {
    Vec peak = Vec::Zero(n);
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(M, j); it; ++it) {
        peak[j] = std::max(peak[j], std::abs(it.value()));
        peak[it.row()] = std::max(peak[it.row()], std::abs(it.value()));
      }
    Vec factor = Vec::Ones(n);
    for (Index i = 0; i < n; ++i)
      if (peak[i] > 0) factor[i] = std::exp2(-std::round(std::log2(peak[i]) / 2));
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(M, j); it; ++it) it.valueRef() *= factor[it.row()] * factor[j];
    D_ = D_.cwiseProduct(factor);
  }
}

}  // namespace perp::lcp
