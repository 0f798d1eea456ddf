// SPDX-License-Identifier: Apache-2.0
#include "extension/jacobian.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "ncp/problem/mcp.hpp"

namespace perp::python {

namespace {

const char* bytes_of(const py::array& array) { return static_cast<const char*>(array.data()); }
std::size_t byte_count(const py::array& array) { return static_cast<std::size_t>(array.nbytes()); }

bool same(const std::string& bytes, const py::array& array) {
  return bytes.size() == byte_count(array) && std::memcmp(bytes.data(), bytes_of(array), bytes.size()) == 0;
}

/// Entry k of integers of either width.
Index integer(const py::array& array, Index k) {
  return array.itemsize() == 4 ? static_cast<const std::int32_t*>(array.data())[k]
                               : static_cast<Index>(static_cast<const std::int64_t*>(array.data())[k]);
}

void check_square(py::handle J, Index n, const std::string& name, const std::string& has) {
  const auto shape = shape_of(J, name);
  if (shape != std::pair(n, n))
    refuse(name, fmt::format("{} shape ({}, {}), and must {} shape ({}, {})", has, shape.first, shape.second,
                             has == "has" ? "have" : "return", n, n));
}

}  // namespace

void JacobianReader::read(py::handle J, double* value) {
  if (!is_sparse(J)) {
    read_dense(J, value);
    return;
  }
  try {
    read_sparse(py::reinterpret_borrow<py::object>(J), value);
  } catch (py::error_already_set& error) {
    refuse_as(error, "jac");
  }
}

void JacobianReader::read_dense(py::handle J, double* value) const {
  const Index n = pattern_.rows();
  const Doubles numbers = doubles_of(J, "jac");
  if (numbers.ndim() != 2 || numbers.shape(0) != n || numbers.shape(1) != n)
    refuse("jac", fmt::format("returned shape {}, and must return shape ({}, {})", shape_text(numbers), n, n));
  const double* rows = numbers.data();
  for (Index j = 0; j < n; ++j)
    for (Index k = pattern_.outerIndexPtr()[j]; k < pattern_.outerIndexPtr()[j + 1]; ++k)
      value[k] = rows[pattern_.innerIndexPtr()[k] * n + j];
  if (pattern_.nonZeros() == n * n) return;
  const auto given = std::count_if(rows, rows + n * n, [](double v) { return v != 0; });
  if (given <= std::count_if(value, value + pattern_.nonZeros(), [](double v) { return v != 0; })) return;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (rows[i * n + j] != 0) (void)place_of(i, j);
}

Index JacobianReader::place_of(Index i, Index j) const {
  const int* begin = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[j];
  const int* end = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[j + 1];
  const int* found = std::lower_bound(begin, end, static_cast<int>(i));
  if (found == end || *found != i)
    refuse("jac", fmt::format("returned an entry [{}, {}] that is not in the pattern, which is that of jac at the "
                              "start unless `pattern` gives it: give a `pattern` with all entries that can be nonzero",
                              i, j));
  return found - pattern_.innerIndexPtr();
}

bool JacobianReader::known(const py::array& start, const py::array& index, bool by_columns) const {
  return count_ >= 0 && by_columns == by_columns_ && same(start_, start) && same(index_, index);
}

void JacobianReader::learn(const py::array& start, const py::array& index, bool by_columns) {
  count_ = -1;
  const Index n = pattern_.rows();
  if (start.size() != n + 1 || integer(start, 0) != 0) refuse("jac", "its result's indptr makes no sense");
  const Index count = integer(start, n);
  if (count < 0 || count > index.size()) refuse("jac", "its result's indptr ends beyond its entries");
  place_.clear();
  place_.reserve(static_cast<std::size_t>(count));
  bool in_order = count == pattern_.nonZeros();
  for (Index outer = 0; outer < n; ++outer) {
    if (integer(start, outer + 1) < integer(start, outer) || integer(start, outer + 1) > count)
      refuse("jac", "its result's indptr does not ascend");
    for (Index k = integer(start, outer); k < integer(start, outer + 1); ++k) {
      const Index inner = integer(index, k);
      if (inner < 0 || inner >= n)
        refuse("jac", fmt::format("its result's indices[{}] is {}, and must be within 0 and {}", k, inner, n - 1));
      place_.push_back(by_columns ? place_of(inner, outer) : place_of(outer, inner));
      in_order = in_order && place_.back() == k;
    }
  }
  if (in_order) place_.clear();
  start_.assign(bytes_of(start), byte_count(start));
  index_.assign(bytes_of(index), byte_count(index));
  by_columns_ = by_columns;
  count_ = count;
}

void JacobianReader::read_sparse(const py::object& given, double* value) {
  check_square(given, pattern_.rows(), "jac", "returned");
  const bool by_columns = std::string(py::str(given.attr("format"))) != "csr";
  const py::object J = by_columns ? columns_of(given, "jac") : given;
  const py::array start = index_array(J, "indptr", "jac");
  const py::array index = index_array(J, "indices", "jac");
  const Doubles data = doubles_of(J.attr("data"), "jac");
  if (data.ndim() != 1) refuse("jac", "its result's data has shape " + shape_text(data));
  if (!known(start, index, by_columns)) learn(start, index, by_columns);
  if (data.size() < count_) refuse("jac", fmt::format("returned {} values for {} entries", data.size(), count_));
  if (place_.empty() && count_ == pattern_.nonZeros()) {
    std::copy_n(data.data(), count_, value);
    return;
  }
  std::fill_n(value, pattern_.nonZeros(), 0.0);
  for (Index k = 0; k < count_; ++k) value[place_[static_cast<std::size_t>(k)]] += data.data()[k];
}

SpMat pattern_of(py::handle J, Index n, const std::string& name, bool stored) {
  if (!is_sparse(J)) {
    if (stored) return ncp::dense_pattern(n);
    return MatrixArgument(J, name, n, n).entries();
  }
  try {
    check_square(J, n, name, stored ? "returned" : "has");
    // Ones in place of the values: their sums do not vanish, and may be anything where J is not defined.
    const py::object columns = columns_of(py::reinterpret_borrow<py::object>(J), name).attr("copy")();
    columns.attr("data") = py::module_::import("numpy").attr("ones")(py::array(columns.attr("data")).size());
    return MatrixArgument(columns, name, n, n).entries();
  } catch (py::error_already_set& error) {
    refuse_as(error, name);
  }
}

}  // namespace perp::python
