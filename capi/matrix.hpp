// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Matrices and vectors of the caller's, checked and copied.
#include <cstdint>
#include <string>
#include <vector>

#include "lcp/box.hpp"

namespace perp::capi {

using lcp::Index;
using lcp::SpMat;
using lcp::Vec;

/// As the caller gave it.
template <class Integer>
struct Columns {
  std::string name;  ///< in messages: "M" of M_start, M_row, M_value; "" of start, row, value
  Index rows = 0;
  Index columns = 0;
  const Integer* start = nullptr;
  const Integer* row = nullptr;
  const double* value = nullptr;  ///< may be null in a pattern
  bool pattern = false;
};

struct Matrix {
  SpMat entries;             ///< rows in ascending order
  std::vector<Index> place;  ///< of the caller's entry k among them; empty: k
};

/// Refuses what is no matrix, naming the argument, place and value.
Matrix matrix_of(const Columns<std::int32_t>& given);
Matrix matrix_of(const Columns<std::int64_t>& given);

/// Refuses sizes that do not fit the library's indices.
void check_size(std::int64_t n, const char* argument);
/// n finite entries.
Vec vector_of(const double* values, Index n, const char* argument);
/// lower null: 0; upper null: infinity. Refuses what is no box.
lcp::Box box_of(const double* lower, const double* upper, Index n);

}  // namespace perp::capi
