// SPDX-License-Identifier: Apache-2.0
/* The problem of Kojima & Shindo (1986), n = 4, with its two solutions (sqrt(6)/2, 0, 0, 1/2) and (1, 0, 3, 0), and the
   counts of its evaluations. */
#ifndef PERP_TESTS_KOJIMA_H
#define PERP_TESTS_KOJIMA_H

#include <stddef.h>
#include <stdint.h>

#include "perp.h"

enum { kojima_n = 4, kojima_nonzeros = 16 };
static const int32_t kojima_start[] = {0, 4, 8, 12, 16};
static const int32_t kojima_row[] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
static const perp_matrix kojima_pattern = {PERP_COLUMNS_INT32, 0, kojima_n, kojima_n, kojima_start, kojima_row, NULL};

static int32_t kojima_F(int64_t n, const double* x, double* F, void* user) {
  (void)n;
  (void)user;
  F[0] = 3 * x[0] * x[0] + 2 * x[0] * x[1] + 2 * x[1] * x[1] + x[2] + 3 * x[3] - 6;
  F[1] = 2 * x[0] * x[0] + x[0] + x[1] * x[1] + 10 * x[2] + 2 * x[3] - 2;
  F[2] = 3 * x[0] * x[0] + x[0] * x[1] + 2 * x[1] * x[1] + 2 * x[2] + 9 * x[3] - 9;
  F[3] = x[0] * x[0] + 3 * x[1] * x[1] + 2 * x[2] + 3 * x[3] - 3;
  return PERP_DEFINED;
}

/* By columns. */
static int32_t kojima_J(int64_t n, int64_t nonzeros, const double* x, double* value, void* user) {
  static const double constant[] = {1, 10, 2, 2, 3, 2, 9, 3};
  int k;
  (void)n;
  (void)nonzeros;
  (void)user;
  value[0] = 6 * x[0] + 2 * x[1];
  value[1] = 4 * x[0] + 1;
  value[2] = 6 * x[0] + x[1];
  value[3] = 2 * x[0];
  value[4] = 2 * x[0] + 4 * x[1];
  value[5] = 2 * x[1];
  value[6] = x[0] + 4 * x[1];
  value[7] = 6 * x[1];
  for (k = 0; k < 8; ++k) value[8 + k] = constant[k];
  return PERP_DEFINED;
}

static inline int kojima_solved(const double* x) {
  static const double known[2][4] = {{1.224744871391589, 0, 0, 0.5}, {1, 0, 3, 0}};
  int s, i, near;
  for (s = 0; s < 2; ++s) {
    near = 0;
    for (i = 0; i < 4; ++i)
      if (x[i] > known[s][i] - 1e-6 && x[i] < known[s][i] + 1e-6) ++near;
    if (near == 4) return 1;
  }
  return 0;
}

#endif
