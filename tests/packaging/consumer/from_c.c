// SPDX-License-Identifier: Apache-2.0
#include <perp.h>
#include <stdio.h>

/* F(x) = (x1^2 + x2 - 2, x1 - x2 + 1) */
static int32_t F(int64_t n, const double* x, double* F, void* user) {
  (void)n, (void)user;
  F[0] = x[0] * x[0] + x[1] - 2;
  F[1] = x[0] - x[1] + 1;
  return PERP_DEFINED;
}

/* By columns: dF1/dx1, dF2/dx1, dF1/dx2, dF2/dx2 */
static int32_t J(int64_t n, int64_t nonzeros, const double* x, double* value, void* user) {
  (void)n, (void)nonzeros, (void)user;
  value[0] = 2 * x[0];
  value[1] = 1;
  value[2] = 1;
  value[3] = -1;
  return PERP_DEFINED;
}

int main(void) { /* 0 <= x _|_ F(x) >= 0 */
  const int32_t start[] = {0, 2, 4}, row[] = {0, 1, 0, 1};
  const perp_matrix pattern = {PERP_COLUMNS_INT32, 0, 2, 2, start, row, NULL};
  const double x0[] = {1, 1};
  perp_problem* problem;
  perp_solver* solver;
  perp_result* result;
  perp_error error;
  if (perp_problem_create(PERP_INTERFACE, 2, NULL, NULL, &pattern, F, J, NULL, &problem, &error) ||
      perp_solver_create(PERP_INTERFACE, &solver, &error) || perp_solver_set(solver, "method", "path", &error) ||
      perp_solve(solver, problem, x0, &result, &error)) {
    fprintf(stderr, "%s: %s\n", perp_code_name(error.code), error.message);
    return 1;
  }
  printf("%s: %s\n", perp_result_text(result, "status", 0), perp_result_text(result, "message", 0));
  printf("x = %g %g\n", perp_result_reals(result, "x")[0], perp_result_reals(result, "x")[1]);
  perp_result_free(result);
  perp_solver_free(solver);
  perp_problem_free(problem);
  return 0;
}
