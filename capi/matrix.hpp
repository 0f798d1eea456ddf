// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Matrices and vectors of the caller's, checked and copied.
#include <cstdint>
#include <string>
#include <vector>

#include "capi/perp.h"
#include "lcp/box.hpp"
#include "lcp/vi/batch.hpp"

namespace perp::capi {

using lcp::Index;
using lcp::SpMat;
using lcp::Vec;

struct Matrix {
  SpMat entries;             ///< by columns, rows ascending, each place once
  std::vector<Index> place;  ///< of the caller's entry k among them; empty: k
};

/// The caller's matrix. `name` is for messages, which name the array, the place in it and the value; rows and columns
/// that must be so many, or any number where they are -1. Refuses what is no matrix and values that are not finite. The
/// zeros of a dense matrix are left out.
Matrix matrix_of(const perp_matrix* given, const char* name, Index rows, Index columns);
/// The same without values, of which each place may be given once.
Matrix pattern_of(const perp_matrix* given, const char* name, Index n);

/// An Eigen matrix over arrays that are not its own, and are not written to.
class BorrowedMatrix final : public SpMat {
 public:
  BorrowedMatrix();
  BorrowedMatrix(const BorrowedMatrix&) = delete;
  BorrowedMatrix& operator=(const BorrowedMatrix&) = delete;
  ~BorrowedMatrix() { lend(0, 0, nullptr, nullptr, nullptr); }
  /// Takes the arrays of a matrix that is lent and needs no conversion, checked as by matrix_of(); false: it does.
  bool borrow(const perp_matrix& given, const char* name);

 private:
  void lend(Index rows, Index columns, int* start, int* row, double* value);
};

/// For the caller: by columns with indices of 32 bits.
perp_matrix matrix_view(const SpMat& matrix);

/// Refuses sizes that do not fit the library's indices.
void check_size(std::int64_t n, const char* argument);
/// n finite entries.
Vec vector_of(const double* values, Index n, const char* argument);
/// `size` numbers of each of many problems, or `otherwise` for all where the caller has none.
lcp::Varying varying_of(const perp_varying* given, std::int64_t size, const char* argument,
                        const std::vector<double>* otherwise = nullptr);
/// lower null: 0; upper null: infinity. Refuses what is no box.
lcp::Box box_of(const double* lower, const double* upper, Index n);

}  // namespace perp::capi
