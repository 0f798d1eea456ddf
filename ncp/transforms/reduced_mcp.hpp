// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A part of a problem as a problem. Private to ncp/.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "ncp/problem/counted_mcp.hpp"

namespace perp::ncp {

/// The original with some variables held, and their pairs left out. Equation k is row rows[k], times signs[k] if there
/// are signs, and variable k column columns[k].
class ReducedMcp final : public Mcp {
 public:
  /// `start`: a point of the original, with F and J there if they are known.
  ReducedMcp(const Mcp& base, Point start, std::vector<Index> columns, std::vector<Index> rows, Vec signs = {})
      : base_(base),
        counted_(base),
        columns_(std::move(columns)),
        rows_(std::move(rows)),
        signs_(std::move(signs)),
        x_(std::move(start.x)),
        F_(std::move(start.F)),
        knows_F_(F_.size() > 0),
        knows_J_(start.J.size() > 0) {
    if (knows_J_)
      J_.swap(start.J);
    else
      J_ = base.jacobian_pattern();
    const auto n = static_cast<Index>(columns_.size());
    box_ = Box::free(n);
    for (Index k = 0; k < n; ++k) {
      box_.lower[k] = base.box().lower[columns_[at(k)]];
      box_.upper[k] = base.box().upper[columns_[at(k)]];
    }
    find_entries();
  }

  const Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  bool eval(In x, Out F) const override {
    put(x);
    const bool defined = knows_F_ || counted_.eval(x_, F_);
    knows_F_ = defined;
    for (Index k = 0; k < size(); ++k) F[k] = sign(k) * F_[rows_[at(k)]];
    return defined;
  }
  bool jacobian(In x, SpMat& J) const override {
    put(x);
    const bool defined = knows_J_ || counted_.jacobian(x_, J_);
    knows_J_ = defined;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const double value = J_.valuePtr()[entries_[k]];
      J.valuePtr()[k] = signs_.size() > 0 ? signs_[J.innerIndexPtr()[k]] * value : value;
    }
    return defined;
  }
  bool is_affine() const override { return base_.is_affine(); }
  std::vector<bool> linear_entries() const override {
    const std::vector<bool> all = base_.linear_entries();
    std::vector<bool> mine;
    if (all.empty()) return mine;
    for (const int p : entries_) mine.push_back(all[at(p)]);
    return mine;
  }
  std::string name() const override { return base_.name(); }
  std::string variable_name(Index i) const override { return base_.variable_name(columns_[at(i)]); }
  std::string equation_name(Index i) const override { return base_.equation_name(rows_[at(i)]); }

 private:
  double sign(Index k) const { return signs_.size() > 0 ? signs_[k] : 1; }
  void put(In x) const {
    bool same = true;
    for (Index k = 0; k < size(); ++k) {
      double& there = x_[columns_[at(k)]];
      same = same && there == x[k] && std::signbit(there) == std::signbit(x[k]);
      there = x[k];
    }
    if (!same) knows_F_ = knows_J_ = false;
  }
  void find_entries() {
    std::vector<int> place(at(base_.size()), -1);
    for (Index k = 0; k < size(); ++k) place[at(rows_[at(k)])] = static_cast<int>(k);
    pattern_.resize(size(), size());
    pattern_.reserve(J_.nonZeros());
    entries_.reserve(at(J_.nonZeros()));
    std::vector<std::pair<int, int>> column;  // (row, entry of the original)
    for (Index k = 0; k < size(); ++k) {
      column.clear();
      const Index j = columns_[at(k)];
      for (int p = J_.outerIndexPtr()[j]; p < J_.outerIndexPtr()[j + 1]; ++p)
        if (const int i = place[at(J_.innerIndexPtr()[p])]; i >= 0) column.emplace_back(i, p);
      if (!std::is_sorted(column.begin(), column.end())) std::sort(column.begin(), column.end());
      pattern_.startVec(k);
      for (const auto& [i, p] : column) {
        pattern_.insertBack(i, k) = 1;
        entries_.push_back(p);
      }
    }
    pattern_.finalize();
  }

  const Mcp& base_;
  mutable CountedMcp counted_;  // refuses a J that left its pattern
  std::vector<Index> columns_, rows_;
  Vec signs_;
  Box box_;
  SpMat pattern_;
  std::vector<int> entries_;  // of the original's J, in the order of the pattern
  mutable Vec x_, F_;         // of the original
  mutable SpMat J_;
  mutable bool knows_F_, knows_J_;  // at x_
};

}  // namespace perp::ncp
