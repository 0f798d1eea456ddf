// SPDX-License-Identifier: Apache-2.0
#include "capi/matrix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "capi/guard.hpp"
#include "lcp/memory.hpp"

namespace perp::capi {

namespace {

constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max() - 1;

bool is_dense(const perp_matrix& given) { return given.form == PERP_DENSE_COLUMNS || given.form == PERP_DENSE_ROWS; }
bool is_wide(const perp_matrix& given) { return given.form == PERP_COLUMNS_INT64 || given.form == PERP_ROWS_INT64; }
bool by_rows(const perp_matrix& given) { return given.form >= PERP_ROWS_INT32 && given.form != PERP_DENSE_COLUMNS; }

void check_shape(const perp_matrix* given, const char* name, Index rows, Index columns) {
  require(given, name);
  if (given->form < PERP_COLUMNS_INT32 || given->form > PERP_DENSE_ROWS)
    refuse(name, fmt::format("form is {}, which is no perp_form", given->form));
  check_size(given->rows, name);
  check_size(given->columns, name);
  if ((rows >= 0 && given->rows != rows) || (columns >= 0 && given->columns != columns))
    refuse(name, fmt::format("is {} x {}, and must be {} x {}", given->rows, given->columns,
                             rows < 0 ? given->rows : rows, columns < 0 ? given->columns : columns));
}

/// A compressed matrix, by outer (columns or rows) and inner index.
template <class Integer>
struct Compressed {
  const perp_matrix& given;
  const char* name;
  Index outer = by_rows(given) ? given.rows : given.columns;
  Index inner = by_rows(given) ? given.columns : given.rows;
  const Integer* start = static_cast<const Integer*>(given.start);
  const Integer* index = static_cast<const Integer*>(given.index);

  Index count() const { return static_cast<Index>(start[outer]); }
  std::string part(const char* what, Index k) const { return fmt::format("{}[{}]", what, k); }
  /// "row 3, column 4" of entry k.
  std::string place(Index k) const {
    const Index o = std::upper_bound(start, start + outer + 1, static_cast<Integer>(k)) - start - 1;
    const auto i = static_cast<Index>(index[k]);
    return fmt::format("row {}, column {}", by_rows(given) ? o : i, by_rows(given) ? i : o);
  }

  /// Whether the inner indices ascend everywhere. Refuses what is no matrix.
  bool check() const {
    if (start == nullptr) refuse(name, "start is NULL");
    if (start[0] != 0) refuse(name, fmt::format("start[0] is {}, and must be 0", start[0]));
    for (Index j = 0; j < outer; ++j)
      if (start[j + 1] < start[j])
        refuse(name, fmt::format("start[{}] is {}, less than the one before, {}", j + 1, start[j + 1], start[j]));
    if (start[outer] > most) refuse(name, fmt::format("there are {} entries, more than 2^31 - 2", start[outer]));
    if (count() > 0 && index == nullptr) refuse(name, "index is NULL");
    bool ascending = true;
    for (Index j = 0; j < outer; ++j)
      for (Integer k = start[j]; k < start[j + 1]; ++k) {
        const Integer i = index[k];
        if (i < 0 || i >= inner)
          refuse(name, fmt::format("index[{}] ({} {}) is {}, and must be within 0 and {}", k,
                                   by_rows(given) ? "of row" : "of column", j, i, inner - 1));
        if (k > start[j] && index[k - 1] >= i) ascending = false;
      }
    return ascending;
  }

  void check_values() const {
    if (count() > 0 && given.value == nullptr) refuse(name, "value is NULL");
    if (Eigen::Map<const Vec>(given.value, count()).allFinite()) return;
    for (Index k = 0; k < count(); ++k)
      if (!std::isfinite(given.value[k]))
        refuse(name, fmt::format("value[{}] ({}) is {}, no finite number", k, place(k), given.value[k]));
  }
};

/// The caller's entries column by column, and the row of each.
struct ByColumns {
  std::vector<Index> start, entry;
  std::vector<int> row;
};

template <class Integer>
ByColumns by_columns(const Compressed<Integer>& given) {
  const auto count = static_cast<std::size_t>(given.count());
  ByColumns sorted{std::vector<Index>(static_cast<std::size_t>(given.given.columns) + 1), std::vector<Index>(count),
                   std::vector<int>(count)};
  if (!by_rows(given.given)) {
    std::copy_n(given.start, sorted.start.size(), sorted.start.begin());
    std::iota(sorted.entry.begin(), sorted.entry.end(), Index{0});
    std::transform(given.index, given.index + count, sorted.row.begin(), [](Integer i) { return static_cast<int>(i); });
    return sorted;
  }
  for (std::size_t k = 0; k < count; ++k) ++sorted.start[static_cast<std::size_t>(given.index[k]) + 1];
  std::partial_sum(sorted.start.begin(), sorted.start.end(), sorted.start.begin());
  std::vector<Index> next(sorted.start.begin(), sorted.start.end() - 1);
  for (Index i = 0; i < given.outer; ++i)
    for (Integer k = given.start[i]; k < given.start[i + 1]; ++k) {
      const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(given.index[k])]++);
      sorted.entry[at] = static_cast<Index>(k);
      sorted.row[at] = static_cast<int>(i);
    }
  return sorted;
}

/// Rows in order, entries of one place together: their places, and the pattern.
template <class Integer>
Matrix ordered(const Compressed<Integer>& given, bool once) {
  ByColumns sorted = by_columns(given);
  const Index columns = given.given.columns;
  Matrix matrix;
  matrix.place.resize(sorted.entry.size());
  matrix.entries.resize(given.given.rows, columns);
  matrix.entries.resizeNonZeros(given.count());
  Index kept = 0;
  std::vector<std::pair<int, Index>> column;
  matrix.entries.outerIndexPtr()[0] = 0;
  for (Index j = 0; j < columns; ++j) {
    column.clear();
    for (Index k = sorted.start[lcp::at(j)]; k < sorted.start[lcp::at(j) + 1]; ++k)
      column.emplace_back(sorted.row[lcp::at(k)], sorted.entry[lcp::at(k)]);
    std::sort(column.begin(), column.end());
    const Index first = kept;
    for (const auto& [i, k] : column) {
      const bool again = kept > first && matrix.entries.innerIndexPtr()[kept - 1] == i;
      if (again && once) refuse(given.name, fmt::format("row {}, column {} is given twice", i, j));
      if (!again) matrix.entries.innerIndexPtr()[kept++] = i;
      matrix.place[lcp::at(k)] = kept - 1;
    }
    matrix.entries.outerIndexPtr()[j + 1] = static_cast<int>(kept);
  }
  matrix.entries.resizeNonZeros(kept);
  matrix.entries.coeffs().setZero();
  return matrix;
}

template <class Integer>
Matrix compressed(const perp_matrix& given, const char* name, bool pattern) {
  const Compressed<Integer> checked{given, name};
  const bool ascending = checked.check();
  if (!pattern) checked.check_values();
  const bool sorts = !ascending || by_rows(given);
  constexpr double an_entry = sizeof(double) + sizeof(int);
  lcp::require_memory((an_entry + (sorts ? 2 * sizeof(Index) + sizeof(int) : 0)) * static_cast<double>(checked.count()),
                      fmt::format("{}: its {} entries", name, checked.count()));
  if (sorts) {
    Matrix matrix = ordered(checked, pattern);
    if (!pattern)
      for (Index k = 0; k < checked.count(); ++k) matrix.entries.valuePtr()[matrix.place[lcp::at(k)]] += given.value[k];
    return matrix;
  }
  Matrix matrix;
  SpMat& M = matrix.entries;
  M.resize(given.rows, given.columns);
  M.resizeNonZeros(checked.count());
  const auto narrow = [](Integer i) { return static_cast<int>(i); };
  std::transform(checked.start, checked.start + checked.outer + 1, M.outerIndexPtr(), narrow);
  std::transform(checked.index, checked.index + checked.count(), M.innerIndexPtr(), narrow);
  if (pattern)
    M.coeffs().setZero();
  else
    std::copy_n(given.value, checked.count(), M.valuePtr());
  return matrix;
}

Matrix dense_values(const perp_matrix& given, const char* name) {
  const Index rows = given.rows, columns = given.columns;
  if (rows * columns > 0 && given.value == nullptr) refuse(name, "value is NULL");
  const Index down = by_rows(given) ? columns : 1, right = by_rows(given) ? 1 : rows;
  const Eigen::Map<const Vec> values(given.value, rows * columns);
  if (!values.allFinite())
    for (Index j = 0; j < columns; ++j)
      for (Index i = 0; i < rows; ++i)
        if (const double a = values[i * down + j * right]; !std::isfinite(a))
          refuse(name, fmt::format("entry [{}, {}] is {}, no finite number", i, j, a));
  const Index count = (values.array() != 0).count();
  check_size(count, name);
  Matrix matrix;
  SpMat& M = matrix.entries;
  M.resize(rows, columns);
  M.resizeNonZeros(count + 1);  // the last entry may be followed by zeros, which are written and left behind
  Index k = 0;
  for (Index j = 0; j < columns; ++j) {
    for (Index i = 0; i < rows; ++i) {
      const double a = values[i * down + j * right];
      M.valuePtr()[k] = a;
      M.innerIndexPtr()[k] = static_cast<int>(i);
      k += a != 0 ? 1 : 0;
    }
    M.outerIndexPtr()[j + 1] = static_cast<int>(k);
  }
  M.resizeNonZeros(count);
  return matrix;
}

Matrix dense_pattern(const perp_matrix& given, const char* name) {
  const Index n = given.columns;
  if (n > 0 && given.rows > most / n) refuse(name, "has more than 2^31 - 2 entries");
  lcp::require_memory((sizeof(double) + sizeof(int)) * static_cast<double>(given.rows) * static_cast<double>(n),
                      fmt::format("{}: a full pattern of {} x {}", name, given.rows, n));
  Matrix matrix;
  matrix.entries.resize(given.rows, n);
  matrix.entries.resizeNonZeros(given.rows * n);
  for (Index j = 0; j <= n; ++j) matrix.entries.outerIndexPtr()[j] = static_cast<int>(j * given.rows);
  for (Index j = 0; j < n; ++j)
    std::iota(matrix.entries.innerIndexPtr() + j * given.rows, matrix.entries.innerIndexPtr() + (j + 1) * given.rows,
              0);
  matrix.entries.coeffs().setZero();
  if (!by_rows(given)) return matrix;
  matrix.place.resize(lcp::at(given.rows * n));
  for (Index i = 0; i < given.rows; ++i)
    for (Index j = 0; j < n; ++j) matrix.place[lcp::at(i * n + j)] = i + j * given.rows;
  return matrix;
}

/// The members of Eigen's storage that its classes keep for themselves and their heirs.
struct Reach : SpMat::Storage {
  static constexpr auto values = &Reach::m_values;
  static constexpr auto indices = &Reach::m_indices;
  static constexpr auto size = &Reach::m_size;
  static constexpr auto allocated = &Reach::m_allocatedSize;
};

}  // namespace

Matrix matrix_of(const perp_matrix* given, const char* name, Index rows, Index columns) {
  check_shape(given, name, rows, columns);
  if (is_dense(*given)) return dense_values(*given, name);
  return is_wide(*given) ? compressed<std::int64_t>(*given, name, false)
                         : compressed<std::int32_t>(*given, name, false);
}

Matrix pattern_of(const perp_matrix* given, const char* name, Index n) {
  const perp_matrix all{PERP_DENSE_COLUMNS, 0, n, n, nullptr, nullptr, nullptr};
  const perp_matrix* pattern = given == nullptr ? &all : given;
  check_shape(pattern, name, n, n);
  if (is_dense(*pattern)) return dense_pattern(*pattern, name);
  return is_wide(*pattern) ? compressed<std::int64_t>(*pattern, name, true)
                           : compressed<std::int32_t>(*pattern, name, true);
}

BorrowedMatrix::BorrowedMatrix() {
  std::free(m_outerIndex);  // Eigen's own, of an empty matrix
  lend(0, 0, nullptr, nullptr, nullptr);
}

bool BorrowedMatrix::borrow(const perp_matrix& given, const char* name) {
  if (given.lent == 0 || given.form != PERP_COLUMNS_INT32) return false;
  const Compressed<std::int32_t> checked{given, name};
  if (!checked.check()) return false;
  checked.check_values();
  lend(given.rows, given.columns, const_cast<int*>(checked.start), const_cast<int*>(checked.index),
       const_cast<double*>(given.value));
  return true;
}

void BorrowedMatrix::lend(Index rows, Index columns, int* start, int* row, double* value) {
  m_innerSize = rows;
  m_outerSize = columns;
  m_outerIndex = start;
  m_innerNonZeros = nullptr;
  const Index count = start == nullptr ? 0 : start[columns];
  m_data.*Reach::values = value;
  m_data.*Reach::indices = row;
  m_data.*Reach::size = count;
  m_data.*Reach::allocated = count;
}

perp_matrix matrix_view(const SpMat& matrix) {
  return {.form = PERP_COLUMNS_INT32,
          .lent = 0,
          .rows = matrix.rows(),
          .columns = matrix.cols(),
          .start = matrix.outerIndexPtr(),
          .index = matrix.innerIndexPtr(),
          .value = matrix.valuePtr()};
}

void check_size(std::int64_t n, const char* argument) {
  if (n < 0 || n > most) refuse(argument, std::to_string(n) + " is not within 0 and 2^31 - 2");
}

Vec vector_of(const double* values, Index n, const char* argument) {
  if (n > 0) require(values, argument);
  Vec copy(n);
  std::copy_n(values, n, copy.data());
  if (!copy.allFinite())
    for (Index i = 0; i < n; ++i)
      if (!std::isfinite(copy[i])) refuse(argument, fmt::format("entry [{}] is {}, no finite number", i, copy[i]));
  return copy;
}

lcp::Varying varying_of(const perp_varying* given, std::int64_t size, const char* argument,
                        const std::vector<double>* otherwise) {
  if (size == 0) return {};
  if (given == nullptr || given->values == nullptr) {
    if (otherwise == nullptr) require(nullptr, argument);
    return {otherwise->data(), 0};
  }
  if (given->step < 0) refuse(argument, "its step is " + std::to_string(given->step) + ", negative");
  return {given->values, static_cast<Index>(given->step)};  // as wide as an address
}

lcp::Box box_of(const double* lower, const double* upper, Index n) {
  lcp::require_memory(2 * sizeof(double) * static_cast<double>(n), "the bounds of " + std::to_string(n) + " variables");
  lcp::Box box = lcp::Box::nonnegative(n);
  if (lower != nullptr) std::copy_n(lower, n, box.lower.data());
  if (upper != nullptr) std::copy_n(upper, n, box.upper.data());
  if (const auto i = box.first_invalid()) {
    const bool low = std::isnan(box.lower[*i]) || box.lower[*i] == lcp::infinity;
    refuse(low ? "lower" : "upper",
           fmt::format("entry [{}]: [{}, {}] is no interval", *i, box.lower[*i], box.upper[*i]));
  }
  return box;
}

}  // namespace perp::capi
