// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/markowitz.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::lcp {
namespace {

/// A pivot is at least this part of the largest entry in its column.
constexpr double large_enough = 0.1;
/// The same of a pivot that is taken again, where its row eliminates anything.
constexpr double still_large_enough = 0.03;
/// Lines with a pivot that are looked at before the best one is taken.
constexpr int enough_lines = 4;
/// What is left is factored as a full matrix from so many rows and this density on.
constexpr std::size_t least_full = 8;
constexpr double full_density = 0.6;
/// For fill, beside a line's own entries.
constexpr int spare = 4;

}  // namespace

void Markowitz::Lines::clear(std::size_t lines) {
  head_.assign(lines + 1, -1);
  next_.resize(lines);
  previous_.resize(lines);
  entries_.resize(lines);
}

void Markowitz::Lines::insert(int line, int entries) {
  int& head = head_[at(entries)];
  entries_[at(line)] = entries;
  next_[at(line)] = head;
  previous_[at(line)] = -1;
  if (head >= 0) previous_[at(head)] = line;
  head = line;
}

void Markowitz::Lines::remove(int line) {
  const int next = next_[at(line)];
  const int previous = previous_[at(line)];
  if (next >= 0) previous_[at(next)] = previous;
  (previous >= 0 ? next_[at(previous)] : head_[at(entries_[at(line)])]) = next;
}

void Markowitz::load(const SpMat& A, const Vec& R) {
  const std::size_t n = at(A.rows());
  n_ = A.rows();
  entries_ = at(A.nonZeros());
  columns_.resize(n);
  rows_.assign(n, {});
  for (std::size_t k = 0; k < entries_; ++k) ++rows_[at(A.innerIndexPtr()[k])].size;
  const auto place = [](Slot& slot, std::size_t& end) {
    slot.start = end;
    slot.room = slot.size + spare;
    end += at(slot.room);
  };
  std::size_t end = 0;
  for (Slot& row : rows_) place(row, end), row.size = 0;
  column_of_.resize(end);
  end = 0;
  for (std::size_t j = 0; j < n; ++j) {
    columns_[j].size = A.outerIndexPtr()[j + 1] - A.outerIndexPtr()[j];
    place(columns_[j], end);
  }
  row_of_.resize(end);
  value_.resize(end);
  for (std::size_t j = 0; j < n; ++j) {
    std::size_t to = columns_[j].start;
    for (int k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k, ++to) {
      const int i = A.innerIndexPtr()[k];
      row_of_[to] = i;
      value_[to] = A.valuePtr()[k] * R[i];
      Slot& row = rows_[at(i)];
      column_of_[row.start + at(row.size++)] = static_cast<int>(j);
    }
  }
}

/// All lines are left, and there are no factors yet.
void Markowitz::begin() {
  const std::size_t n = at(n_);
  short_columns_.clear(n);
  short_rows_.clear(n);
  for (std::size_t i = n; i-- > 0;) {
    short_columns_.insert(static_cast<int>(i), columns_[i].size);
    short_rows_.insert(static_cast<int>(i), rows_[i].size);
  }
  largest_.assign(n, -1);
  multiplier_.resize(n);
  has_multiplier_.assign(n, 0);
  met_.assign(n, 0);
  updates_ = 0;
  step_of_row_.assign(n, -1);
  step_of_column_.assign(n, -1);
  for (Triangle* T : {&L, &U_rows_}) {
    T->start.assign(1, 0);
    T->row.clear();
    T->value.clear();
  }
  P.clear();
  Q.clear();
  diagonal.clear();
}

double Markowitz::largest(int column) {
  double& known = largest_[at(column)];
  if (known >= 0) return known;
  const Slot& slot = columns_[at(column)];
  double found = 0;
  for (std::size_t k = slot.start; k < slot.start + at(slot.size); ++k) found = std::max(found, std::abs(value_[k]));
  return known = found;
}

/// Takes the column's best pivot if it is better than the one known.
void Markowitz::look_at_column(int column, double& best, Pivot& pivot) {
  const Slot& slot = columns_[at(column)];
  const double least = slot.size == 1 ? 0 : large_enough * largest(column);
  double size = 0;
  for (std::size_t k = slot.start; k < slot.start + at(slot.size); ++k) {
    const double a = std::abs(value_[k]);
    if (!(a > 0) || a < least) continue;
    const double cost = static_cast<double>(slot.size - 1) * (rows_[at(row_of_[k])].size - 1);
    if (cost > best || (cost == best && a <= size)) continue;
    best = cost;
    size = a;
    pivot = {.row = row_of_[k], .column = column};
  }
}

/// The same for a row. An only entry is the pivot whatever its size: nothing is eliminated with its row.
void Markowitz::look_at_row(int row, double& best, Pivot& pivot) {
  const Slot& slot = rows_[at(row)];
  for (std::size_t k = slot.start; k < slot.start + at(slot.size); ++k) {
    const int column = column_of_[k];
    const Slot& entries = columns_[at(column)];
    const double cost = static_cast<double>(slot.size - 1) * (entries.size - 1);
    if (cost >= best) continue;
    std::size_t e = entries.start;
    while (row_of_[e] != row) ++e;
    const double a = std::abs(value_[e]);
    if (!(a > 0) || (slot.size > 1 && a < large_enough * largest(column))) continue;
    best = cost;
    pivot = {.row = row, .column = column};
  }
}

/// None if the matrix is singular.
Markowitz::Pivot Markowitz::choose() {
  Pivot pivot;
  if (short_columns_.first(0) >= 0 || short_rows_.first(0) >= 0) return pivot;
  double best = infinity;
  int lines = 0;
  const auto left = static_cast<int>(at(n_) - P.size());
  for (int k = 1; k <= left; ++k) {
    const double others = k - 1;
    if (best <= others * others) return pivot;
    for (int j = short_columns_.first(k); j >= 0; j = short_columns_.after(j)) {
      look_at_column(j, best, pivot);
      if (best <= others * others || (++lines >= enough_lines && pivot.row >= 0)) return pivot;
    }
    if (best <= others * k) return pivot;
    for (int i = short_rows_.first(k); i >= 0; i = short_rows_.after(i)) {
      look_at_row(i, best, pivot);
      if (best <= others * k || (++lines >= enough_lines && pivot.row >= 0)) return pivot;
    }
  }
  return pivot;
}

void Markowitz::forget_in_row(int row, int column) {
  Slot& slot = rows_[at(row)];
  int* entry = column_of_.data() + slot.start;
  while (*entry != column) ++entry;
  *entry = column_of_[slot.start + at(--slot.size)];
}

/// The column of the pivot goes to L.
void Markowitz::take_pivot_column(const Pivot& pivot) {
  const Slot& slot = columns_[at(pivot.column)];
  const std::size_t end = slot.start + at(slot.size);
  std::size_t own = slot.start;
  while (row_of_[own] != pivot.row) ++own;
  const double value = value_[own];
  pivot_column_ = L.row.size();
  const int step = static_cast<int>(P.size());
  for (std::size_t k = slot.start; k < end; ++k) {
    const int i = row_of_[k];
    forget_in_row(i, pivot.column);
    if (k == own) continue;
    multiplier_[at(i)] = value_[k] / value;
    has_multiplier_[at(i)] = step + 1;
    L.push(i, multiplier_[at(i)]);
  }
  L.end_column();
  entries_ -= at(slot.size);
  diagonal.push_back(value);
  step_of_row_[at(pivot.row)] = step_of_column_[at(pivot.column)] = step;
  P.push_back(pivot.row);
  Q.push_back(pivot.column);
  short_columns_.remove(pivot.column);
  short_rows_.remove(pivot.row);
}

void Markowitz::append(int column, int row, double value) {
  Slot& slot = columns_[at(column)];
  if (slot.size == slot.room) {  // to the end, with as much again
    const std::size_t start = row_of_.size();
    slot.room *= 2;
    row_of_.resize(start + at(slot.room));
    value_.resize(start + at(slot.room));
    std::copy_n(row_of_.begin() + static_cast<Index>(slot.start), slot.size,
                row_of_.begin() + static_cast<Index>(start));
    std::copy_n(value_.begin() + static_cast<Index>(slot.start), slot.size, value_.begin() + static_cast<Index>(start));
    slot.start = start;
  }
  row_of_[slot.start + at(slot.size)] = row;
  value_[slot.start + at(slot.size++)] = value;
  Slot& of_row = rows_[at(row)];
  if (of_row.size == of_row.room) {
    const std::size_t start = column_of_.size();
    of_row.room *= 2;
    column_of_.resize(start + at(of_row.room));
    std::copy_n(column_of_.begin() + static_cast<Index>(of_row.start), of_row.size,
                column_of_.begin() + static_cast<Index>(start));
    of_row.start = start;
  }
  column_of_[of_row.start + at(of_row.size++)] = column;
  ++entries_;
}

/// Column <- column - u l, l in multiplier_. Entries that come out zero stay: they are those of the pattern, too.
void Markowitz::update(int column, double u) {
  const Slot& slot = columns_[at(column)];
  const std::size_t multipliers = L.row.size() - pivot_column_;
  const int step = static_cast<int>(P.size());
  ++updates_;
  std::size_t met = 0;
  for (std::size_t k = slot.start; k < slot.start + at(slot.size); ++k) {
    const auto i = at(row_of_[k]);
    if (has_multiplier_[i] != step) continue;
    value_[k] -= multiplier_[i] * u;
    met_[i] = updates_;
    ++met;
  }
  if (met == multipliers) return;
  for (std::size_t k = pivot_column_; k < L.row.size(); ++k)
    if (const int i = L.row[k]; met_[at(i)] != updates_) append(column, i, -L.value[k] * u);
}

void Markowitz::eliminate(const Pivot& pivot) {
  take_pivot_column(pivot);
  const Slot row = rows_[at(pivot.row)];
  entries_ -= at(row.size);
  for (int k = 0; k < row.size; ++k) {
    const int j = column_of_[row.start + at(k)];
    Slot& slot = columns_[at(j)];
    std::size_t e = slot.start;
    while (row_of_[e] != pivot.row) ++e;
    const double u = value_[e];
    --slot.size;
    row_of_[e] = row_of_[slot.start + at(slot.size)];
    value_[e] = value_[slot.start + at(slot.size)];
    U_rows_.push(j, u);
    update(j, u);
    largest_[at(j)] = -1;
    short_columns_.move(j, slot.size);
  }
  U_rows_.end_column();
  for (std::size_t k = pivot_column_; k < L.row.size(); ++k) {
    const int i = L.row[k];
    short_rows_.move(i, rows_[at(i)].size);
  }
}

bool Markowitz::mostly_full(std::size_t steps) const {
  const std::size_t left = at(n_) - steps;
  return left >= least_full && static_cast<double>(entries_) >= full_density * static_cast<double>(left * left);
}

/// The part that is left, by partial pivoting. False if a pivot is zero.
bool Markowitz::finish_full() {
  const std::size_t base = P.size();
  const Index m = n_ - static_cast<Index>(base);
  std::vector<int> rows;
  std::vector<int> place(at(n_));
  for (std::size_t i = 0; i < at(n_); ++i)
    if (step_of_row_[i] < 0) {
      place[i] = static_cast<int>(rows.size());
      rows.push_back(static_cast<int>(i));
    }
  ::Eigen::MatrixXd full = ::Eigen::MatrixXd::Zero(m, m);
  for (std::size_t j = 0; j < at(n_); ++j) {
    if (step_of_column_[j] >= 0) continue;
    const auto k = static_cast<Index>(Q.size() - base);
    const Slot& slot = columns_[j];
    for (std::size_t e = slot.start; e < slot.start + at(slot.size); ++e) full(place[at(row_of_[e])], k) = value_[e];
    step_of_column_[j] = static_cast<int>(Q.size());
    Q.push_back(static_cast<int>(j));
  }
  const ::Eigen::PartialPivLU<::Eigen::Ref<::Eigen::MatrixXd>> lu(full);  // in place
  P.resize(at(n_));
  for (Index i = 0; i < m; ++i) {
    const std::size_t step = base + at(lu.permutationP().indices()[i]);
    P[step] = rows[at(i)];
    step_of_row_[at(rows[at(i)])] = static_cast<int>(step);
  }
  for (Index k = 0; k < m; ++k) {
    diagonal.push_back(full(k, k));
    for (Index i = k + 1; i < m; ++i) L.push(P[base + at(i)], full(i, k));
    L.end_column();
    for (Index j = k + 1; j < m; ++j) U_rows_.push(Q[base + at(j)], full(k, j));
    U_rows_.end_column();
  }
  return (full.diagonal().array() != 0).all();
}

void Markowitz::number_by_steps() {
  for (int& i : L.row) i = step_of_row_[at(i)];
  for (int& j : U_rows_.row) j = step_of_column_[at(j)];
  U = U_rows_.transpose();
}

bool Markowitz::factor(const SpMat& A, const Vec& R) {
  load(A, R);
  begin();
  while (P.size() < at(n_)) {
    if (mostly_full(P.size())) {
      if (!finish_full()) return false;
      break;
    }
    const Pivot pivot = choose();
    if (pivot.row < 0) return false;
    eliminate(pivot);
  }
  number_by_steps();
  return true;
}

/// Column by column, as their pattern is known.
bool Markowitz::factor_again(const SpMat& A, const Vec& R) {
  work_.assign(at(n_), 0);
  double* x = work_.data();
  for (std::size_t k = 0; k < at(n_); ++k) {
    for (SpMat::InnerIterator it(A, Q[k]); it; ++it) x[step_of_row_[at(it.row())]] = it.value() * R[it.row()];
    for (auto e = at(U.start[k]); e < at(U.start[k + 1]); ++e) {
      const auto j = at(U.row[e]);
      const double u = U.value[e] = std::exchange(x[j], 0.0);
      if (u == 0) continue;
      for (auto i = at(L.start[j]); i < at(L.start[j + 1]); ++i) x[L.row[i]] -= L.value[i] * u;
    }
    const double pivot = diagonal[k] = std::exchange(x[k], 0.0);
    double largest = 0;
    for (auto i = at(L.start[k]); i < at(L.start[k + 1]); ++i) {
      const double a = std::exchange(x[L.row[i]], 0.0);
      largest = std::max(largest, std::abs(a));
      L.value[i] = a / pivot;
    }
    const bool eliminates = U_rows_.start[k] != U_rows_.start[k + 1];
    if (!(std::abs(pivot) > 0) || (eliminates && std::abs(pivot) < still_large_enough * largest)) return false;
  }
  return true;
}

}  // namespace perp::lcp
