// SPDX-License-Identifier: Apache-2.0
#include "ncp/transforms/presolve_reducer.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/words.hpp"

namespace perp::ncp {
namespace {

constexpr int max_evaluations = 50;  // of F, for rows whose nonlinear variables are fixed one after the other
constexpr double broken = 1e-6;      // relative: F differs from what its declared linearity says

}  // namespace

Reducer::Reducer(const Mcp& mcp, In x0)
    : mcp_(mcp),
      counted_(mcp),
      x_(lcp::project(mcp.box(), x0)),
      F_(Vec::Zero(mcp.size())),
      column_state_(at(mcp.size()), State::Kept),
      row_kept_(at(mcp.size()), 1),
      row_of_(at(mcp.size())),
      column_of_(at(mcp.size())) {
  for (Index i = 0; i < mcp.size(); ++i) row_of_[at(i)] = column_of_[at(i)] = i;
}

void Reducer::run(bool everything) {
  const bool known = everything && know_values();
  if (known) count_entries();
  for (Index c = 0; c < mcp_.size(); ++c) {
    if (box().lower[c] != box().upper[c]) continue;
    ++counts.fixed;
    if (known) {
      fix(c, x_[c]);
      drop(c);
    } else {
      column_state_[at(c)] = State::Fixed;
    }
  }
  if (!known) return;
  row_queue_.reserve(at(mcp_.size()));
  column_queue_.reserve(at(mcp_.size()));
  for (Index i = 0; i < mcp_.size(); ++i) {
    push_row(i);
    push_column(i);
  }
  do drain();
  while (infeasible.empty() && (reevaluate(false) || parallel_rows()));
  if (infeasible.empty() && moved_) reevaluate(true);
}

// J and F at x_, if anything about them is constant and they are defined there.
bool Reducer::know_values() {
  const std::vector<bool> linear = mcp_.linear_entries();
  if (linear.empty()) return false;
  const SpMat& pattern = mcp_.jacobian_pattern();
  if (static_cast<Index>(linear.size()) != pattern.nonZeros())
    refuse_input(mcp_.name(), ": ", linear.size(), " flags of linear entries for a Jacobian pattern of ",
                 pattern.nonZeros(), " nonzeros");
  J_ = pattern;
  if (!counted_.eval(x_, F_) || !counted_.jacobian(x_, J_)) return false;
  list_entries(linear);
  return true;
}

Point Reducer::evaluated() {
  Point point;
  point.x = x_;
  if (moved_ || rows_.start.empty()) return point;
  point.F.swap(F_);
  point.J.swap(J_);
  return point;
}

void Reducer::list_entries(const std::vector<bool>& linear) {
  const std::size_t n = at(mcp_.size());
  const auto matters = [&](std::size_t p) { return !linear[p] || J_.valuePtr()[p] != 0; };
  const int* row = J_.innerIndexPtr();
  rows_.start.assign(n + 1, 0);
  columns_.start.assign(n + 1, 0);
  columns_.entry.resize(linear.size());
  std::size_t count = 0;
  for (std::size_t j = 0; j < n; ++j) {
    for (auto p = at(J_.outerIndexPtr()[j]); p < at(J_.outerIndexPtr()[j + 1]); ++p) {
      if (!matters(p)) continue;
      columns_.entry[count++] = {J_.valuePtr()[p], row[p], linear[p]};
      ++rows_.start[at(row[p]) + 1];
    }
    columns_.start[j + 1] = count;
  }
  columns_.entry.resize(count);
  for (std::size_t i = 0; i < n; ++i) rows_.start[i + 1] += rows_.start[i];
  rows_.entry.resize(columns_.entry.size());
  std::vector<std::size_t> next(rows_.start.begin(), rows_.start.end() - 1);
  for (std::size_t j = 0; j < n; ++j)
    for (const Entry& e : columns_[j]) rows_.entry[next[at(e.index)]++] = {e.a, static_cast<int>(j), e.linear};
}

void Reducer::count_entries() {
  const std::size_t n = at(mcp_.size());
  for (auto* flags : {&stale_, &row_queued_, &column_queued_}) flags->assign(n, 0);
  for (auto* numbers : {&unfixed_, &nonlinear_, &kept_rows_, &looks_}) numbers->assign(n, 0);
  for (auto* indices : {&lower_by_, &upper_by_, &set_by_}) indices->assign(n, -1);
  linear_column_.assign(n, 1);
  implied_lower_ = box().lower;
  implied_upper_ = box().upper;
  size_ = F_.cwiseAbs();
  for (Index i = 0; i < mcp_.size(); ++i)
    for (const Entry& e : rows_[at(i)]) {
      ++unfixed_[at(i)];
      ++kept_rows_[at(e.index)];
      size_[i] += std::abs(e.a * x_[e.index]);
      if (e.linear) continue;
      ++nonlinear_[at(i)];
      linear_column_[at(e.index)] = 0;
    }
  for (Index i = 0; i < mcp_.size(); ++i)
    if (nonlinear_[at(i)] > 0) size_[i] = std::max(size_[i], 1.0);  // their terms are not known
}

void Reducer::fix(Index column, double value) {
  const double step = value - x_[column];
  x_[column] = value;
  column_state_[at(column)] = State::Fixed;
  moved_ |= step != 0;
  for (const Entry& e : columns_[at(column)]) {
    --unfixed_[at(e.index)];
    if (e.linear) {
      F_[e.index] += e.a * step;
      size_[e.index] = std::max(size_[e.index], std::abs(e.a * value));
    } else {
      --nonlinear_[at(e.index)];
      if (step != 0) stale_[at(e.index)] = 1;
    }
    push_row(e.index);
  }
}

void Reducer::drop(Index row) {
  row_kept_[at(row)] = 0;
  for (const Entry& e : rows_[at(row)]) {
    --kept_rows_[at(e.index)];
    push_column(e.index);
  }
}

void Reducer::pair(Index row, Index column) {
  row_of_[at(column)] = row;
  column_of_[at(row)] = column;
  push_row(row);
  push_column(column);
}

void Reducer::postpone(Index row, Index column, double a) {
  postponed.push_back({row, column, a});
  column_state_[at(column)] = State::Postponed;
  ++counts.singleton_columns;
  drop(row);
}

void Reducer::push_row(Index row) {
  if (row_kept_[at(row)] == 0 || row_queued_[at(row)] != 0) return;
  row_queued_[at(row)] = 1;
  row_queue_.push_back(row);
}

void Reducer::push_column(Index column) {
  if (!kept(column) || column_queued_[at(column)] != 0 || kept_rows_[at(column)] > 1) return;
  column_queued_[at(column)] = 1;
  column_queue_.push_back(column);
}

void Reducer::drain() {
  while (infeasible.empty() && (!row_queue_.empty() || !column_queue_.empty())) {
    const bool row = !row_queue_.empty();  // rows first: what they settle needs no postsolve
    const Index index = (row ? row_queue_ : column_queue_).take();
    (row ? row_queued_ : column_queued_)[at(index)] = 0;
    row ? examine_row(index) : examine_column(index);
  }
}

// F at x_ anew, for rows whose nonlinear variables are all fixed by now. False: nothing new is known.
bool Reducer::reevaluate(bool at_the_end) {
  const auto waits = [&](Index i) { return row_kept_[at(i)] != 0 && nonlinear_[at(i)] == 0 && stale_[at(i)] != 0; };
  std::vector<Index> waiting;
  for (Index i = 0; i < mcp_.size(); ++i)
    if (waits(i)) waiting.push_back(i);
  if (blocked_ || (!at_the_end && (counted_.F_evals() >= max_evaluations || waiting.empty()))) return false;
  Vec F;
  blocked_ = !counted_.eval(x_, F);
  if (blocked_) return false;
  for (Index i = 0; i < mcp_.size(); ++i) {
    if (stale_[at(i)] != 0 || std::abs(F[i] - F_[i]) <= broken * (1 + size_[i])) continue;
    refuse_input(mcp_.name(), ": equation ", mcp_.equation_name(i), " is not as linear as the problem declares: it is ",
                 F[i], " where its linear entries make it ", F_[i]);
  }
  F_ = F;
  size_ = size_.cwiseMax(F_.cwiseAbs());
  std::fill(stale_.begin(), stale_.end(), 0);
  polish();
  for (const Index i : waiting) push_row(i);
  return !waiting.empty();
}

// A variable was set by -F_i / a, with the rounding of whatever x_ was then; F_i has been evaluated since.
void Reducer::polish() {
  for (const Postponed& s : set_) {
    const double step = -F_[s.row] / s.coefficient;
    if (step == 0 || !(std::abs(F_[s.row]) <= rounding(s.row))) continue;
    x_[s.col] = lcp::project(box(), s.col, x_[s.col] + step);
    for (const Entry& e : columns_[at(s.col)]) F_[e.index] += e.a * step;
  }
}

}  // namespace perp::ncp
