// SPDX-License-Identifier: Apache-2.0
#include "ncp/transforms/presolve.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "ncp/transforms/presolve_reducer.hpp"

namespace perp::ncp {
namespace {

/// The original with some variables held, and their pairs left out. Equation k is row rows[k], variable k column
/// columns[k].
class ReducedMcp final : public Mcp {
 public:
  /// `start`: a point of the original, with F and J there if they are known.
  ReducedMcp(const Mcp& base, Point start, std::vector<Index> columns, std::vector<Index> rows)
      : base_(base),
        counted_(base),
        columns_(std::move(columns)),
        rows_(std::move(rows)),
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
    for (Index k = 0; k < size(); ++k) F[k] = F_[rows_[at(k)]];
    return defined;
  }
  bool jacobian(In x, SpMat& J) const override {
    put(x);
    const bool defined = knows_J_ || counted_.jacobian(x_, J_);
    knows_J_ = defined;
    for (std::size_t k = 0; k < entries_.size(); ++k) J.valuePtr()[k] = J_.valuePtr()[entries_[k]];
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
  Box box_;
  SpMat pattern_;
  std::vector<int> entries_;  // of the original's J, in the order of the pattern
  mutable Vec x_, F_;         // of the original
  mutable SpMat J_;
  mutable bool knows_F_, knows_J_;  // at x_
};

/// A solution t of  l <= t <= u  _|_  F + a (t - here); see Presolved for when there is one.
double scalar_solution(double a, double F, double here, double lower, double upper) {
  const double root = a != 0 ? here - F / a : here;
  if (a > 0 || (a < 0 && lower == -infinity && upper == infinity))
    return std::isfinite(root) ? std::min(std::max(root, lower), upper) : here;
  return F + a * (lower - here) >= 0 ? lower : upper;  // a <= 0: F is no larger at the upper bound
}

void expect_size(const Mcp& mcp, const char* what, Index given, Index expected) {
  if (given != expected)
    throw std::invalid_argument(mcp.name() + ": " + what + " of a point with " + std::to_string(given) +
                                " entries for " + std::to_string(expected) + " variables");
}

}  // namespace

Vec Presolved::reduce(In x) const {
  expect_size(*original_, "reduction", x.size(), original_->size());
  return Vec::NullaryExpr(static_cast<Index>(columns_.size()), [&](Index k) { return x[columns_[at(k)]]; });
}

// A postponed variable is in its own row and in rows that went before: the last one is computed first. Rounding of one
// pass is taken out by the second.
Vec Presolved::postsolve(In x) const {
  expect_size(*original_, "postsolve", x.size(), static_cast<Index>(columns_.size()));
  Vec full = base_;
  for (Index k = 0; k < x.size(); ++k) full[columns_[at(k)]] = x[k];
  if (postponed_.empty()) return full;
  const Box& box = original_->box();
  Vec F(original_->size());
  CountedMcp counted(*original_);
  for (int pass = 0; pass < 2; ++pass) {
    if (!counted.eval(full, F)) return full;
    for (std::size_t k = postponed_.size(); k-- > 0;) {
      const auto& [row, c, a] = postponed_[k];
      const double value = scalar_solution(a, F[row], full[c], box.lower[c], box.upper[c]);
      const double step = value - full[c];
      full[c] = value;
      for (SpMat::InnerIterator it(J_, c); it; ++it) F[it.row()] += it.value() * step;
    }
  }
  return full;
}

Presolved presolve(const Mcp& mcp, In x0) {
  Presolved p;
  p.original_ = &mcp;
  auto reducer = std::make_unique<Reducer>(mcp, x0);
  reducer->run(true);
  p.F_evals_ = reducer->F_evals();
  p.J_evals_ = reducer->J_evals();
  if (reducer->infeasible.empty() && !reducer->defined()) {
    // F is defined at x0, but not where presolve would start: x0 is worth more.
    reducer = std::make_unique<Reducer>(mcp, x0);
    reducer->run(false);
  }
  p.infeasible_ = std::move(reducer->infeasible);
  p.notes_ = std::move(reducer->notes);
  p.counts_ = reducer->counts;
  p.postponed_ = std::move(reducer->postponed);
  p.base_ = reducer->x();
  if (!p.postponed_.empty()) p.J_ = reducer->J();
  p.columns_.reserve(at(mcp.size()));
  p.rows_.reserve(at(mcp.size()));
  for (Index c = 0; c < mcp.size(); ++c) {
    if (!reducer->kept(c)) continue;
    p.columns_.push_back(c);
    p.rows_.push_back(reducer->row_of(c));
  }
  p.start_ = p.reduce(p.base_);
  if (p.counts_.total() > 0) p.reduced_ = std::make_unique<ReducedMcp>(mcp, reducer->evaluated(), p.columns_, p.rows_);
  return p;
}

}  // namespace perp::ncp
