/* SPDX-License-Identifier: Apache-2.0 */
/* Variational inequalities over polyhedra from C, one and many. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "perp.h"

static const double identity[4] = {1, 0, 0, 1};

static perp_matrix dense(int64_t rows, int64_t columns, const double* values) {
  perp_matrix matrix;
  memset(&matrix, 0, sizeof matrix);
  matrix.form = PERP_DENSE_ROWS;
  matrix.rows = rows;
  matrix.columns = columns;
  matrix.value = values;
  return matrix;
}

/* min x^2 / 2 + y^2 / 2 over x + y >= 1 is at (1/2, 1/2), by hand, with multiplier 1/2. Catches sides and signs mixed
 * up. */
static void finds_the_nearest_point(void) {
  const double q[2] = {0, 0}, row[2] = {1, 1}, one = 1, free_below[2] = {-INFINITY, -INFINITY};
  const perp_matrix M = dense(2, 2, identity), A = dense(1, 2, row);
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  perp_error error;
  CHECK(perp_problem_affine(PERP_INTERFACE, &M, q, free_below, NULL, &problem, &error) == PERP_OK);
  CHECK(perp_vi(NULL, problem, &A, &one, NULL, NULL, &result, &error) == PERP_OK);
  CHECK(perp_result_status(result) == PERP_SOLVED);
  CHECK(fabs(perp_result_reals(result, "x")[0] - 0.5) < 1e-12 && fabs(perp_result_reals(result, "x")[1] - 0.5) < 1e-12);
  CHECK(fabs(perp_result_reals(result, "multipliers")[0] - 0.5) < 1e-12);
  CHECK(perp_result_cells(result, "rows")[0] == PERP_BELOW);
  CHECK(perp_result_real(result, "residual") < 1e-9);
  perp_result_free(result);
  CHECK(perp_vi(NULL, problem, NULL, NULL, NULL, NULL, &result, &error) == PERP_BAD_ARGUMENT && result == NULL);
  CHECK(strncmp(error.message, "A", 1) == 0);
  perp_problem_free(problem);
}

/* x + y >= 1 and x + y <= 0. Catches an empty set that is called a failure. */
static void proves_emptiness(void) {
  const double q[2] = {0, 0}, rows[4] = {1, 1, -1, -1}, sides[2] = {1, 0}, free_below[2] = {-INFINITY, -INFINITY};
  const perp_matrix M = dense(2, 2, identity), A = dense(2, 2, rows);
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  CHECK(perp_problem_affine(PERP_INTERFACE, &M, q, free_below, NULL, &problem, NULL) == PERP_OK);
  CHECK(perp_vi(NULL, problem, &A, sides, NULL, NULL, &result, NULL) == PERP_OK);
  CHECK(perp_result_status(result) == PERP_INFEASIBLE && perp_result_integer(result, "empty") == 1);
  CHECK(perp_result_length(result, "certificate") == 4);
  perp_result_free(result);
  perp_problem_free(problem);
}

/* The nearest points of x + y >= b to (-q), for three q; in threads, and one by one. Catches steps taken wrongly. */
static void solves_many(void) {
  const double q[6] = {0, 0, -1, 0, 3, -1}, row[2] = {1, 1}, one = 1, low[2] = {-INFINITY, -INFINITY};
  const perp_varying M = {identity, 0}, qs = {q, 2}, A = {row, 0}, b = {&one, 0}, lower = {low, 0};
  const double expected[6] = {0.5, 0.5, 1, 0, -1.5, 2.5};
  double x[6], multipliers[3], residual[3];
  int32_t status[3];
  int i;
  CHECK(perp_batch_vi(PERP_INTERFACE, 3, 2, 1, &M, &qs, &A, &b, NULL, &lower, NULL, 1e-9, 2, x, multipliers, status,
                      residual, NULL) == PERP_OK);
  for (i = 0; i < 6; ++i) CHECK(fabs(x[i] - expected[i]) < 1e-12);
  for (i = 0; i < 3; ++i) CHECK(status[i] == PERP_SOLVED && residual[i] < 1e-9);
  CHECK(fabs(multipliers[2] - 1.5) < 1e-12);
  CHECK(perp_batch_vi(PERP_INTERFACE, 3, 2, 1, NULL, &qs, &A, &b, NULL, &lower, NULL, 1e-9, 2, x, NULL, NULL, NULL,
                      NULL) == PERP_BAD_ARGUMENT);
}

int main(void) {
  finds_the_nearest_point();
  proves_emptiness();
  solves_many();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
