// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What J of Python's returns, put into the places of a pattern.
#include <optional>
#include <string>
#include <vector>

#include "extension/matrix.hpp"

namespace perp::python {

/// Takes J's values, from dense arrays and from scipy.sparse of any format. As long as the arrays of indices stay the
/// same, which is compared, a sparse J costs one pass over its values.
class JacobianReader {
 public:
  explicit JacobianReader(const SpMat& pattern) : pattern_(pattern) {}

  /// value := the values of J in the pattern's order. A place given twice is added up. Throws ValueError or TypeError,
  /// naming jac, for other shapes and for entries outside of the pattern.
  void read(py::handle J, double* value);

 private:
  void read_dense(py::handle J, double* value) const;
  void read_sparse(const py::object& J, double* value);
  /// Works out the place of each entry of a CSC or CSR matrix.
  void learn(const py::array& start, const py::array& index, bool by_columns);
  bool known(const py::array& start, const py::array& index, bool by_columns) const;
  Index place_of(Index i, Index j) const;

  const SpMat& pattern_;
  // Of the arrays learnt last.
  bool by_columns_ = true;
  std::string start_{};  // their bytes
  std::string index_{};
  std::vector<Index> place_{};  // empty: entry k is k-th
  Index count_ = -1;
};

/// The pattern that a matrix has: all of a dense one, the stored entries of a sparse one; of a mask (`stored` false)
/// the entries that are not zero.
SpMat pattern_of(py::handle J, Index n, const std::string& name, bool stored);

}  // namespace perp::python
