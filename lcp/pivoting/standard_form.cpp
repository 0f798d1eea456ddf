// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/standard_form.hpp"

#include <algorithm>
#include <vector>

namespace perp::lcp {
namespace {

/// z_i = offset_i + sign_i x
double sign(const Box& box, Index i) { return !box.has_lower(i) && box.has_upper(i) ? -1 : 1; }
double offset(const Box& box, Index i) {
  if (box.has_lower(i)) return box.lower[i];
  return box.has_upper(i) ? box.upper[i] : 0;
}

}  // namespace

StandardForm::StandardForm(const AffineMcp& problem, bool split_free)
    : box_(problem.box), pair_(at(problem.size()), -1), opposite_(pair_) {
  const Index n = problem.size();
  Vec base(n);
  Index count = 0;
  for (Index i = 0; i < n; ++i) {
    base[i] = offset(box_, i);
    if (box_.lower[i] < box_.upper[i]) pair_[at(i)] = count++;
  }
  free.assign(at(count), 0);
  const Index single = count;
  for (Index i = 0; i < n; ++i) {
    if (pair_[at(i)] < 0) continue;
    const bool bounded = box_.has_lower(i) || box_.has_upper(i);
    if (box_.has_lower(i) == box_.has_upper(i) && (bounded || split_free)) opposite_[at(i)] = count++;
    if (!bounded && !split_free) free[at(pair_[at(i)])] = 1;
  }
  free.resize(at(count), 0);

  const Vec F = problem.M * base + problem.q;
  q = Vec::Zero(count);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(problem.M.nonZeros() + 2 * (count - single)));
  for (Index i = 0; i < n; ++i) {
    const Index k = pair_[at(i)];
    const Index second = opposite_[at(i)];
    if (k < 0) continue;
    q[k] = sign(box_, i) * F[i];
    if (second < 0) continue;
    if (box_.has_lower(i)) {
      q[second] = box_.upper[i] - box_.lower[i];
      entries.emplace_back(static_cast<int>(k), static_cast<int>(second), 1);
      entries.emplace_back(static_cast<int>(second), static_cast<int>(k), -1);
    } else {
      q[second] = -F[i];
    }
  }
  const auto is_split = [&](Index i) { return opposite_[at(i)] >= 0 && !box_.has_lower(i); };
  const auto add = [&](Index row, Index column, double value) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it) {
      const Index i = it.row();
      if (pair_[at(i)] < 0 || pair_[at(j)] < 0) continue;
      const double value = sign(box_, i) * it.value() * sign(box_, j);
      add(pair_[at(i)], pair_[at(j)], value);
      if (is_split(i)) add(opposite_[at(i)], pair_[at(j)], -value);
      if (is_split(j)) add(pair_[at(i)], opposite_[at(j)], -value);
      if (is_split(i) && is_split(j)) add(opposite_[at(i)], opposite_[at(j)], value);
    }
  M = SpMat(count, count);
  M.setFromTriplets(entries.begin(), entries.end());
}

Vec StandardForm::to_x(In z) const {
  Vec x = Vec::Zero(size());
  for (Index i = 0; i < z.size(); ++i) {
    if (pair_[at(i)] < 0) continue;
    const double value = sign(box_, i) * (z[i] - offset(box_, i));
    const bool split = opposite_[at(i)] >= 0 && !box_.has_lower(i);
    x[pair_[at(i)]] = split ? std::max(value, 0.0) : value;
    if (split) x[opposite_[at(i)]] = std::max(-value, 0.0);
  }
  return x;
}

Vec StandardForm::to_z(In x) const {
  Vec z(box_.size());
  for (Index i = 0; i < z.size(); ++i) {
    z[i] = offset(box_, i);
    if (pair_[at(i)] < 0) continue;
    z[i] += sign(box_, i) * x[pair_[at(i)]];
    if (opposite_[at(i)] >= 0 && !box_.has_lower(i)) z[i] -= x[opposite_[at(i)]];
  }
  return z;
}

Vec StandardForm::to_certificate(In y) const {
  Vec out = Vec::Zero(box_.size());
  for (Index i = 0; i < out.size(); ++i) {
    const bool two_bounds = box_.has_lower(i) && box_.has_upper(i);  // M'y <= 0 in x' forces y_i = 0
    if (pair_[at(i)] < 0 || two_bounds) continue;
    out[i] = sign(box_, i) * y[pair_[at(i)]];
    if (opposite_[at(i)] >= 0) out[i] -= y[opposite_[at(i)]];
  }
  return out;
}

}  // namespace perp::lcp
