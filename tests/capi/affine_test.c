// SPDX-License-Identifier: Apache-2.0
/* Affine problems through capi/perp.h, up to n = 100,000: would catch a matrix read by rows, bounds that do not arrive,
   refused or believed nonsense, and copies of the matrix beyond those that a solve needs. The obstacle-like problems
   have solutions in closed form. */
#include <stdlib.h>

#include "check.h"
#include "perp.h"

static perp_error error;

/* M unsymmetric: x = (1, 0) solves 0 <= x _|_ (2 x1 + 5 x2 - 2, -x1 + x2 + 3). By rows it would be (0.?, ...): row 2
   would be 5 x1 + x2 + 3 and row 1 2 x1 - x2 - 2. */
static void small(void) {
  const int32_t start[] = {0, 2, 4};
  const int32_t row[] = {0, 1, 0, 1};
  const double value[] = {2, -1, 5, 1};
  const double q[] = {-2, 3};
  const double lower[] = {-1, -HUGE_VAL};
  const double upper[] = {0.5, HUGE_VAL};
  double wrong[] = {2, -1, 5, 1};
  perp_result* result = NULL;
  perp_problem* problem = NULL;
  OK(perp_lcp_int32(PERP_INTERFACE, 2, start, row, value, q, &result, &error));
  CHECK(perp_result_solved(result));
  CHECK_NEAR(perp_result_x(result)[0], 1, 1e-9);
  CHECK_NEAR(perp_result_x(result)[1], 0, 1e-9);
  CHECK_NEAR(perp_result_F(result)[1], 2, 1e-9);
  perp_result_free(result);
  /* Free x2 = x1 - 3 and F1 = 7 x1 - 17 < 0: x1 is at its upper bound. */
  OK(perp_problem_affine_int32(PERP_INTERFACE, 2, start, row, value, q, lower, upper, &problem, &error));
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  CHECK_NEAR(perp_result_x(result)[0], 0.5, 1e-9);
  CHECK_NEAR(perp_result_x(result)[1], -2.5, 1e-9);
  perp_result_free(result);
  REFUSED(perp_problem_set_linear(problem, NULL, &error), PERP_BAD_ARGUMENT, "problem");
  perp_problem_free(problem);
  wrong[2] = nan("");
  REFUSED(perp_lcp_int32(PERP_INTERFACE, 2, start, row, wrong, q, &result, &error), PERP_BAD_ARGUMENT,
          "value: entry 3 (row 1, column 2) is nan");
  REFUSED(perp_lcp_int32(PERP_INTERFACE, 2, start, row, NULL, q, &result, &error), PERP_BAD_ARGUMENT, "value: is NULL");
  REFUSED(perp_lcp_int32(PERP_INTERFACE, 2, start, row, value, NULL, &result, &error), PERP_BAD_ARGUMENT, "q: is NULL");
  CHECK(result == NULL);
}

/* The solution (1, 0) is nondegenerate and M nonsingular there: it is the only one nearby, which verify proves. */
static void verified(void) {
  const int32_t start[] = {0, 2, 4};
  const int32_t row[] = {0, 1, 0, 1};
  const double value[] = {2, -1, 5, 1};
  const double q[] = {-2, 3};
  perp_problem* problem = NULL;
  perp_solver* solver = NULL;
  perp_result* result = NULL;
  OK(perp_problem_affine_int32(PERP_INTERFACE, 2, start, row, value, q, NULL, NULL, &problem, &error));
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_solve(solver, problem, NULL, &result, &error));
  CHECK(isnan(perp_result_verified_radius(result)));
  perp_result_free(result);
  OK(perp_solver_set(solver, "verify", "yes", &error));
  OK(perp_solve(solver, problem, NULL, &result, &error));
  CHECK(perp_result_verified_radius(result) >= 0 && perp_result_verified_radius(result) < 1e-6);
  perp_result_free(result);
  perp_solver_free(solver);
  perp_problem_free(problem);
}

/* 0 <= x _|_ -1 + x1 - ... : a linear complementarity problem without a solution, proven so: x1 + 1 cannot be, for
   M = [0 0; 0 0], q = (1, -1). */
static void infeasible(void) {
  const int32_t start[] = {0, 0, 0};
  const double q[] = {1, -1};
  perp_result* result = NULL;
  OK(perp_lcp_int32(PERP_INTERFACE, 2, start, NULL, NULL, q, &result, &error));
  CHECK_SAYING(perp_result_status(result) == PERP_INFEASIBLE, perp_result_message(result));
  CHECK(perp_result_advice(result)[0] != '\0');
  perp_result_free(result);
}

/* M = tridiag(-1, 2.5, -1) unsymmetric by its upper diagonal, -0.5; q_i = -1 for odd i, +4 for even ones. x is positive
   where i is odd only: 2.5 x_i = 1 there, and F_i = 4 - 1.5 * 0.4 > 0 elsewhere. */
static void large(void) {
  const int64_t n = 100000;
  int64_t* start = malloc((size_t)(n + 1) * sizeof *start);
  int64_t* row = malloc((size_t)(3 * n) * sizeof *row);
  double* value = malloc((size_t)(3 * n) * sizeof *value);
  double* q = malloc((size_t)n * sizeof *q);
  int64_t j, k = 0, wrong = 0;
  perp_result* result = NULL;
  CHECK(start != NULL && row != NULL && value != NULL && q != NULL);
  for (j = 0; j < n; ++j) {
    start[j] = k;
    if (j > 0) row[k] = j - 1, value[k++] = -0.5;
    row[k] = j, value[k++] = 2.5;
    if (j + 1 < n) row[k] = j + 1, value[k++] = -1;
    q[j] = j % 2 == 0 ? -1 : 4;
  }
  start[n] = k;
  OK(perp_lcp_int64(PERP_INTERFACE, n, start, row, value, q, &result, &error));
  CHECK_SAYING(perp_result_solved(result), perp_result_message(result));
  for (j = 0; j < n; ++j)
    if (fabs(perp_result_x(result)[j] - (j % 2 == 0 ? 0.4 : 0)) > 1e-8) ++wrong;
  CHECK(wrong == 0);
  perp_result_free(result);
  free(start);
  free(row);
  free(value);
  free(q);
}

int main(void) {
  small();
  verified();
  infeasible();
  large();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
