// SPDX-License-Identifier: Apache-2.0
#include "extension/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace perp::python {

namespace {

/// The members of Eigen's storage that its classes keep for themselves and their heirs.
struct Reach : SpMat::Storage {
  static constexpr auto values = &Reach::m_values;
  static constexpr auto indices = &Reach::m_indices;
  static constexpr auto size = &Reach::m_size;
  static constexpr auto allocated = &Reach::m_allocatedSize;
};

template <class Integer>
using Integers = py::array_t<Integer, py::array::c_style>;

/// One index of a matrix in coordinate format.
void check_coordinates(const py::object& coo, const char* part, Index below, const std::string& name) {
  const py::array index = index_array(coo, part, name);
  if (index.size() != py::cast<py::array>(coo.attr("data")).size())
    refuse(name, fmt::format("{} has {} entries, another number than data", part, index.size()));
  if (index.size() == 0) return;
  const auto least = py::cast<Index>(index.attr("min")());
  const auto most = py::cast<Index>(index.attr("max")());
  if (least < 0 || most >= below)
    refuse(name,
           fmt::format("{} has the index {}, and must be within 0 and {}", part, least < 0 ? least : most, below - 1));
}

/// Starts within the arrays, and ascending.
template <class Integer>
void check_starts(const Integers<Integer>& start, Index columns, Index stored, const std::string& name) {
  if (start.size() != columns + 1)
    refuse(name, fmt::format("indptr has {} entries, and must have {}", start.size(), columns + 1));
  const Integer* at = start.data();
  if (at[0] != 0) refuse(name, fmt::format("indptr[0] is {}, and must be 0", at[0]));
  for (Index j = 0; j < columns; ++j)
    if (at[j + 1] < at[j]) refuse(name, fmt::format("indptr[{}] is {}, less than the one before", j + 1, at[j + 1]));
  if (at[columns] > stored)
    refuse(name, fmt::format("indptr ends at {}, and there are {} entries", at[columns], stored));
  if (at[columns] >= std::numeric_limits<int>::max()) refuse(name, "has more than 2^31 - 2 entries");
}

/// Whether rows ascend in each column; refuses those that are none.
template <class Integer>
bool check_rows(const Integer* start, const Integer* row, Index rows, Index columns, const std::string& name) {
  bool ascending = true;
  for (Index j = 0; j < columns; ++j)
    for (auto k = start[j]; k < start[j + 1]; ++k) {
      if (row[k] < 0 || row[k] >= rows)
        refuse(name, fmt::format("indices[{}] is {}, and must be within 0 and {}", k, row[k], rows - 1));
      if (k > start[j] && row[k - 1] >= row[k]) ascending = false;
    }
  return ascending;
}

template <class Integer>
void check_values(const Integer* start, const Integer* row, const double* value, Index columns,
                  const std::string& name) {
  if (Eigen::Map<const Vec>(value, start[columns]).allFinite()) return;
  for (Index j = 0; j < columns; ++j)
    for (auto k = start[j]; k < start[j + 1]; ++k)
      if (!std::isfinite(value[k]))
        refuse(name, fmt::format("entry [{}, {}] is {}, no finite number", row[k], j, value[k]));
}

}  // namespace

BorrowedMatrix::BorrowedMatrix() {
  std::free(m_outerIndex);  // Eigen's own, of an empty matrix
  lend(0, 0, nullptr, nullptr, nullptr);
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

py::array index_array(const py::object& matrix, const char* part, const std::string& name) {
  const auto array = py::array::ensure(matrix.attr(part), py::array::c_style);
  const char kind = array ? array.dtype().kind() : '?';
  if (!array || array.ndim() != 1 || (kind != 'i' && kind != 'u'))
    refuse(name, std::string(part) + " is no array of integers");
  if (kind == 'i' && (array.itemsize() == 4 || array.itemsize() == 8)) return array;
  return array.attr("astype")("int64");
}

std::pair<Index, Index> shape_of(py::handle matrix, const std::string& name) {
  try {
    return py::cast<std::pair<Index, Index>>(matrix.attr("shape"));
  } catch (const py::cast_error&) {
    refuse(name, "has shape " + std::string(py::str(matrix.attr("shape"))) + ", and must have two dimensions");
  }
}

py::object columns_of(const py::object& matrix, const std::string& name) {
  const std::string format = py::str(matrix.attr("format"));
  if (format == "csc") return matrix;
  if (format == "csr" || format == "bsr") {
    matrix.attr("check_format")(true);
    return matrix.attr("tocsc")();
  }
  const py::object coo = format == "coo" ? matrix : matrix.attr("tocoo")();
  const auto [rows, columns] = shape_of(coo, name);
  check_coordinates(coo, "row", rows, name);
  check_coordinates(coo, "col", columns, name);
  return coo.attr("tocsc")();
}

bool is_sparse(py::handle object) {
  return !py::isinstance<py::array>(object) && py::hasattr(object, "tocsc") && py::hasattr(object, "format");
}

MatrixArgument::MatrixArgument(py::handle given, const std::string& name, Index rows, Index columns) {
  if (!is_sparse(given)) {
    take_dense(given, name, rows, columns);
    return;
  }
  try {
    const auto shape = shape_of(given, name);
    if (shape != std::pair(rows, columns))
      refuse(name,
             fmt::format("has shape ({}, {}), and must have shape ({}, {})", shape.first, shape.second, rows, columns));
    take_columns(columns_of(py::reinterpret_borrow<py::object>(given), name), name, rows, columns, false);
  } catch (py::error_already_set& error) {
    refuse_as(error, name);
  }
}

void MatrixArgument::take_dense(py::handle given, const std::string& name, Index rows, Index columns) {
  const Doubles numbers = doubles_of(given, name);
  if (numbers.ndim() != 2 || numbers.shape(0) != rows || numbers.shape(1) != columns)
    refuse(name, fmt::format("has shape {}, and must have shape ({}, {})", shape_text(numbers), rows, columns));
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Rows> dense(numbers.data(), rows, columns);
  if (!dense.allFinite())
    for (Index i = 0; i < rows; ++i)
      for (Index j = 0; j < columns; ++j)
        if (!std::isfinite(dense(i, j)))
          refuse(name, fmt::format("entry [{}, {}] is {}, no finite number", i, j, dense(i, j)));
  own_.emplace(rows, columns);
  own_->reserve((dense.array() != 0).count());
  for (Index j = 0; j < columns; ++j) {
    own_->startVec(j);
    for (Index i = 0; i < rows; ++i)
      if (dense(i, j) != 0) own_->insertBack(i, j) = dense(i, j);
  }
  own_->finalize();
}

template <class Integer>
bool MatrixArgument::take(const py::object& csc, const std::string& name, Index rows, Index columns) {
  const auto start = Integers<Integer>::ensure(index_array(csc, "indptr", name));
  const auto row = Integers<Integer>::ensure(index_array(csc, "indices", name));
  const Doubles value = doubles_of(csc.attr("data"), name);
  if (value.ndim() != 1) refuse(name, "data has shape " + shape_text(value) + ", and must have one dimension");
  check_starts(start, columns, std::min<Index>(row.size(), value.size()), name);
  const bool ascending = check_rows(start.data(), row.data(), rows, columns, name);
  check_values(start.data(), row.data(), value.data(), columns, name);
  if (!ascending) return false;
  if constexpr (std::is_same_v<Integer, std::int32_t>) {
    keep_start_ = start;
    keep_row_ = row;
    keep_value_ = value;
    borrowed_.borrow(rows, columns, start.data(), row.data(), value.data());
  } else {
    own_.emplace(rows, columns);
    const Index count = start.data()[columns];
    own_->resizeNonZeros(count);
    std::transform(start.data(), start.data() + columns + 1, own_->outerIndexPtr(),
                   [](Integer k) { return static_cast<int>(k); });
    std::transform(row.data(), row.data() + count, own_->innerIndexPtr(),
                   [](Integer i) { return static_cast<int>(i); });
    std::copy_n(value.data(), count, own_->valuePtr());
  }
  return true;
}

void MatrixArgument::take_columns(const py::object& csc, const std::string& name, Index rows, Index columns,
                                  bool again) {
  const auto is = [&](const char* part, py::ssize_t bytes) { return index_array(csc, part, name).itemsize() == bytes; };
  const bool narrow = is("indptr", 4) && is("indices", 4);
  if (narrow ? take<std::int32_t>(csc, name, rows, columns) : take<std::int64_t>(csc, name, rows, columns)) return;
  if (again) refuse(name, "its rows do not ascend after sum_duplicates()");
  const py::object sorted = csc.attr("copy")();
  sorted.attr("has_sorted_indices") = false;  // a flag that somebody may have set wrongly
  sorted.attr("has_canonical_format") = false;
  sorted.attr("sum_duplicates")();
  take_columns(sorted, name, rows, columns, true);
}

py::object scipy_of(const SpMat& matrix) {
  const Index count = matrix.nonZeros();
  const py::array_t<double> value(count, matrix.valuePtr());
  const py::array_t<int> row(count, matrix.innerIndexPtr());
  const py::array_t<int> start(matrix.cols() + 1, matrix.outerIndexPtr());
  return py::module_::import("scipy.sparse")
      .attr("csc_matrix")(py::make_tuple(value, row, start),
                          py::arg("shape") = py::make_tuple(matrix.rows(), matrix.cols()));
}

}  // namespace perp::python
