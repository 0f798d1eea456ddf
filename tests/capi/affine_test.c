// SPDX-License-Identifier: Apache-2.0
/* Affine problems through capi/perp.h, up to n = 100,000: would catch a matrix read by rows, bounds that do not arrive,
   refused or believed nonsense, and copies of the matrix beyond those that a solve needs. The obstacle-like problems
   have solutions in closed form. */
#include <stdlib.h>

#include "check.h"
#include "helpers.h"

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
  const perp_matrix M = csc32(2, start, row, value);
  const perp_matrix no_values = csc32(2, start, row, NULL);
  const perp_matrix not_finite = csc32(2, start, row, wrong);
  perp_result* result = NULL;
  perp_problem* problem = NULL;
  OK(perp_lcp(PERP_INTERFACE, &M, q, &result, &error));
  CHECK(solved(result));
  CHECK_NEAR(perp_result_reals(result, "x")[0], 1, 1e-9);
  CHECK_NEAR(perp_result_reals(result, "x")[1], 0, 1e-9);
  CHECK_NEAR(perp_result_reals(result, "F")[1], 2, 1e-9);
  perp_result_free(result);
  /* Free x2 = x1 - 3 and F1 = 7 x1 - 17 < 0: x1 is at its upper bound. */
  OK(perp_problem_affine(PERP_INTERFACE, &M, q, lower, upper, &problem, &error));
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  CHECK_NEAR(perp_result_reals(result, "x")[0], 0.5, 1e-9);
  CHECK_NEAR(perp_result_reals(result, "x")[1], -2.5, 1e-9);
  perp_result_free(result);
  REFUSED(perp_problem_set_linear(problem, NULL, &error), PERP_BAD_ARGUMENT, "problem");
  perp_problem_free(problem);
  wrong[2] = nan("");
  REFUSED(perp_lcp(PERP_INTERFACE, &not_finite, q, &result, &error), PERP_BAD_ARGUMENT,
          "M: value[2] (row 0, column 1) is nan");
  REFUSED(perp_lcp(PERP_INTERFACE, &no_values, q, &result, &error), PERP_BAD_ARGUMENT, "M: value is NULL");
  REFUSED(perp_lcp(PERP_INTERFACE, &M, NULL, &result, &error), PERP_BAD_ARGUMENT, "q: is NULL");
  REFUSED(perp_lcp(PERP_INTERFACE, NULL, q, &result, &error), PERP_BAD_ARGUMENT, "M: is NULL");
  CHECK(result == NULL);
}

/* The solution (1, 0) is nondegenerate and M nonsingular there: it is the only one nearby, which verify proves. */
static void verified(void) {
  const int32_t start[] = {0, 2, 4};
  const int32_t row[] = {0, 1, 0, 1};
  const double value[] = {2, -1, 5, 1};
  const double q[] = {-2, 3};
  const perp_matrix M = csc32(2, start, row, value);
  const perp_result* proof = NULL;
  perp_problem* problem = NULL;
  perp_solver* solver = NULL;
  perp_result* result = NULL;
  OK(perp_problem_affine(PERP_INTERFACE, &M, q, NULL, NULL, &problem, &error));
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_solve(solver, problem, NULL, &result, &error));
  CHECK(perp_result_part(result, "verified", 0) == NULL && perp_result_kind(result, "verified") == PERP_NONE);
  perp_result_free(result);
  OK(perp_solver_set(solver, "verify", "yes", &error));
  OK(perp_solve(solver, problem, NULL, &result, &error));
  proof = perp_result_part(result, "verified", 0);
  CHECK(perp_result_integer(proof, "unique") == 1 && perp_result_reals(proof, "radius")[0] < 1e-6);
  perp_result_free(result);
  perp_solver_free(solver);
  perp_problem_free(problem);
}

/* 0 <= x _|_ -1 + x1 - ... : a linear complementarity problem without a solution, proven so: x1 + 1 cannot be, for
   M = [0 0; 0 0], q = (1, -1). */
static void infeasible(void) {
  const int32_t start[] = {0, 0, 0};
  const double q[] = {1, -1};
  const perp_matrix M = csc32(2, start, NULL, NULL);
  perp_result* result = NULL;
  OK(perp_lcp(PERP_INTERFACE, &M, q, &result, &error));
  CHECK_SAYING(perp_result_status(result) == PERP_INFEASIBLE, perp_result_text(result, "message", 0));
  CHECK(perp_result_text(result, "advice", 0)[0] != '\0');
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
  perp_matrix M;
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
  M = csc64(n, start, row, value);
  OK(perp_lcp(PERP_INTERFACE, &M, q, &result, &error));
  CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
  for (j = 0; j < n; ++j)
    if (fabs(perp_result_reals(result, "x")[j] - (j % 2 == 0 ? 0.4 : 0)) > 1e-8) ++wrong;
  CHECK(wrong == 0);
  perp_result_free(result);
  free(start);
  free(row);
  free(value);
  free(q);
}

/* The same M in every form: [2 5; -1 1], rows in another order, an entry in halves, dense. Would catch a form that is
   read as another, and halves of which one is lost. Lent, the arrays are used where they are: what is written into them
   afterwards shows. */
static void every_form(void) {
  const int32_t start[] = {0, 3, 5}, row[] = {1, 0, 0, 0, 1};
  const double value[] = {-1, 1.5, 0.5, 5, 1};
  const int64_t row_start[] = {0, 2, 4}, column[] = {1, 0, 0, 1};
  const double by_rows[] = {5, 2, -1, 1};
  const double columns[] = {2, -1, 5, 1}, rows[] = {2, 5, -1, 1};
  const int32_t plain_start[] = {0, 2, 4}, plain_row[] = {0, 1, 0, 1};
  double lent_value[] = {2, -1, 5, 1};
  const double q[] = {-2, 3};
  const double x[] = {1, 2};
  double F[2], J[4];
  int f;
  perp_problem* problem = NULL;
  perp_matrix forms[6], pattern;
  forms[0] = csc32(2, start, row, value);
  forms[1] = matrix(PERP_ROWS_INT64, 2, 2, row_start, column, by_rows);
  forms[2] = matrix(PERP_DENSE_COLUMNS, 2, 2, NULL, NULL, columns);
  forms[3] = matrix(PERP_DENSE_ROWS, 2, 2, NULL, NULL, rows);
  forms[4] = csc32(2, plain_start, plain_row, lent_value);
  forms[4].lent = 1;
  forms[5] = csc32(2, start, row, value); /* that has to be converted, lent or not */
  forms[5].lent = 1;
  for (f = 0; f < 6; ++f) {
    OK(perp_problem_affine(PERP_INTERFACE, &forms[f], q, NULL, NULL, &problem, &error));
    OK(perp_problem_evaluate(problem, x, F, J, &error));
    CHECK(F[0] == 10 && F[1] == 4 && J[0] == 2 && J[1] == -1 && J[2] == 5 && J[3] == 1);
    CHECK(perp_problem_is_affine(problem));
    OK(perp_problem_pattern(problem, &pattern, &error));
    CHECK(pattern.form == PERP_COLUMNS_INT32 && pattern.value == NULL && ((const int32_t*)pattern.start)[2] == 4);
    if (f == 4) {
      lent_value[0] = 3;
      OK(perp_problem_evaluate(problem, x, F, NULL, &error));
      CHECK(F[0] == 11 && pattern.index == (const void*)plain_row);
    }
    perp_problem_free(problem);
  }
  forms[0].form = 9;
  REFUSED(perp_problem_affine(PERP_INTERFACE, &forms[0], q, NULL, NULL, &problem, &error), PERP_BAD_ARGUMENT,
          "M: form is 9");
  forms[1].rows = 3;
  REFUSED(perp_problem_affine(PERP_INTERFACE, &forms[1], q, NULL, NULL, &problem, &error), PERP_BAD_ARGUMENT,
          "M: is 3 x 2, not square");
}

/* Matrix Market files, and a kept solver on a changing q: x = max(0, 1/M q) moves with it, and the second solve needs
   no method (the active set stays). */
static void files_and_a_kept_solver(void) {
  static const char* const where[] = {"perp_capi_M.mtx", "perp_capi_q.mtx"};
  static const char* const text[] = {
      "%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 2\n2 1 -1\n1 2 5\n2 2 1\n",
      "%%MatrixMarket matrix array real general\n2 1\n-2\n3\n"};
  const double columns[] = {2, -1, 5, 1};
  double q[] = {-2, 3};
  const perp_matrix M = matrix(PERP_DENSE_COLUMNS, 2, 2, NULL, NULL, columns);
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  perp_solver* solver = NULL;
  int k;
  for (k = 0; k < 2; ++k) {
    FILE* file = fopen(where[k], "w");
    CHECK(file != NULL && fputs(text[k], file) >= 0 && fclose(file) == 0);
  }
  OK(perp_problem_read_matrix(PERP_INTERFACE, where[0], where[1], NULL, NULL, &problem, &error));
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  CHECK_NEAR(perp_result_reals(result, "x")[0], 1, 1e-9);
  CHECK(strcmp(perp_problem_source(problem), where[0]) == 0);
  perp_result_free(result);
  perp_problem_free(problem);
  REFUSED(perp_problem_read_matrix(PERP_INTERFACE, where[0], where[0], NULL, NULL, &problem, &error), PERP_BAD_FILE,
          where[0]);
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  for (k = 0; k < 4; ++k) {
    q[0] = -2 - k;
    OK(perp_problem_affine(PERP_INTERFACE, &M, q, NULL, NULL, &problem, &error));
    OK(perp_solve_kept(solver, problem, NULL, &result, &error));
    CHECK(solved(result));
    CHECK_NEAR(perp_result_reals(result, "x")[0], 1 + 0.5 * k, 1e-9);
    CHECK(strcmp(perp_result_text(result, "kept_by", 0), k == 0 ? "anew" : "kept") == 0);
    perp_result_free(result);
    perp_problem_free(problem);
  }
  perp_solver_free(solver);
}

/* 2 x_1 = 2 and x_2 = x_1 - 1/2, or x_1 = 1/2 at its upper bound. M is not symmetric, which tells a transposed one. */
static void dense(void) {
  const double M[] = {2, 0, -1, 1}, q[] = {-2, 0.5}, upper[] = {0.5, 9}, broken[] = {2, 0, -1, NAN};
  double x[2], residual = -1;
  int32_t status = -1;
  perp_dense* solver = NULL;
  int k;
  OK(perp_dense_create(PERP_INTERFACE, &solver, &error));
  for (k = 0; k < 3; ++k) {
    OK(perp_dense_solve(solver, 2, M, q, NULL, NULL, 1e-9, x, &status, &residual, &error));
    CHECK(status == PERP_SOLVED && residual <= 1e-9);
    CHECK_NEAR(x[0], 1, 1e-12);
    CHECK_NEAR(x[1], 0.5, 1e-12);
    if (k == 1) perp_dense_forget(solver);
  }
  OK(perp_dense_solve(solver, 2, M, q, NULL, upper, 1e-9, x, NULL, NULL, &error));
  CHECK_NEAR(x[0], 0.5, 1e-12);
  CHECK_NEAR(x[1], 0, 1e-12);
  REFUSED(perp_dense_solve(solver, 2, broken, q, NULL, NULL, 1e-9, x, NULL, NULL, &error), PERP_BAD_ARGUMENT,
          "M: entry [1, 1]");
  REFUSED(perp_dense_solve(solver, 2, M, NULL, NULL, NULL, 1e-9, x, NULL, NULL, &error), PERP_BAD_ARGUMENT, "q:");
  REFUSED(perp_dense_solve(NULL, 2, M, q, NULL, NULL, 1e-9, x, NULL, NULL, &error), PERP_BAD_ARGUMENT, "solver:");
  perp_dense_free(solver);
  perp_dense_free(NULL);
}

int main(void) {
  dense();
  every_form();
  files_and_a_kept_solver();
  small();
  verified();
  infeasible();
  large();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
