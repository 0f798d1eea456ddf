// SPDX-License-Identifier: Apache-2.0
/* Matrices of arrays, and what tests ask of results. */
#ifndef PERP_TESTS_HELPERS_H
#define PERP_TESTS_HELPERS_H

#include "perp.h"

static inline perp_matrix matrix(int32_t form, int64_t rows, int64_t columns, const void* start, const void* index,
                                 const double* value) {
  const perp_matrix made = {form, 0, rows, columns, start, index, value};
  return made;
}
static inline perp_matrix csc32(int64_t n, const int32_t* start, const int32_t* row, const double* value) {
  return matrix(PERP_COLUMNS_INT32, n, n, start, row, value);
}
static inline perp_matrix csc64(int64_t n, const int64_t* start, const int64_t* row, const double* value) {
  return matrix(PERP_COLUMNS_INT64, n, n, start, row, value);
}

static inline int solved(const perp_result* result) { return perp_result_integer(result, "success") == 1; }
/* Of a part of the result, "stats" or "residual". */
static inline double number(const perp_result* result, const char* part, const char* name) {
  return perp_result_real(perp_result_part(result, part, 0), name);
}

#endif
