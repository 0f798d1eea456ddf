// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Matrices from Python: scipy.sparse of any format, or dense arrays.
#include <optional>
#include <string>
#include <utility>

#include "extension/arguments.hpp"

namespace perp::python {

/// Looks like one of scipy.sparse?
bool is_sparse(py::handle object);
/// Rows and columns.
std::pair<Index, Index> shape_of(py::handle matrix, const std::string& name);
/// The matrix by columns: itself if it is in CSC. Checks indices of other formats, which scipy would follow wherever
/// they point; those of CSC are for the caller to check.
py::object columns_of(const py::object& matrix, const std::string& name);
/// An array of indices of 4 or 8 bytes: "indptr", "indices", ...
py::array index_array(const py::object& matrix, const char* part, const std::string& name);

/// An Eigen matrix over arrays that are not its own.
class BorrowedMatrix final : public SpMat {
 public:
  BorrowedMatrix();
  BorrowedMatrix(const BorrowedMatrix&) = delete;
  BorrowedMatrix& operator=(const BorrowedMatrix&) = delete;
  ~BorrowedMatrix() { lend(0, 0, nullptr, nullptr, nullptr); }
  /// The arrays outlive this object and are not written to.
  void borrow(Index rows, Index columns, const int* start, const int* row, const double* value) {
    lend(rows, columns, const_cast<int*>(start), const_cast<int*>(row), const_cast<double*>(value));
  }

 private:
  void lend(Index rows, Index columns, int* start, int* row, double* value);
};

/// A matrix argument. CSC with int32 indices whose rows ascend, each place once, is used where it is; whatever else is
/// copied once: other formats, int64 indices, unsorted rows; entries given twice are added, which is what scipy means.
/// Refuses shapes other than rows x columns, indices out of range, and values that are not finite.
class MatrixArgument {
 public:
  MatrixArgument(py::handle given, const std::string& name, Index rows, Index columns);
  const SpMat& entries() const { return own_ ? *own_ : borrowed_; }
  bool copied() const { return own_.has_value(); }

 private:
  void take_dense(py::handle given, const std::string& name, Index rows, Index columns);
  void take_columns(const py::object& csc, const std::string& name, Index rows, Index columns, bool again);
  template <class Integer>
  bool take(const py::object& csc, const std::string& name, Index rows, Index columns);

  py::object keep_start_, keep_row_, keep_value_;
  BorrowedMatrix borrowed_{};
  std::optional<SpMat> own_{};
};

/// As scipy.sparse.csc_matrix.
py::object scipy_of(const SpMat& matrix);

}  // namespace perp::python
