// SPDX-License-Identifier: Apache-2.0
/* Problems of functions and of files through capi/perp.h: would catch a wrong order of J's values, options that do not
   arrive, results that are not those of the solve, a log or a progress callback that is not called, a basis that is not
   used, an interruption that is lost. Expected numbers are from the papers' solutions (kojima.h) and, of the model,
   from data/models. */
#include <stdlib.h>

#include "check.h"
#include "helpers.h"
#include "kojima.h"

static perp_error error;

static perp_problem* kojima(void) {
  perp_problem* problem = NULL;
  OK(perp_problem_create(PERP_INTERFACE, kojima_n, NULL, NULL, &kojima_pattern, kojima_F, kojima_J, NULL, &problem,
                         &error));
  return problem;
}

static perp_solver* solver_with(const char* method) {
  perp_solver* solver = NULL;
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_solver_set(solver, "method", method, &error));
  return solver;
}

static void every_method_solves(void) {
  static const char* const methods[] = {
      "auto", "path", "semismooth", "smooth", "interior", "qpcomp", "first(josephy, semismooth)"};
  size_t m;
  const double x0[] = {1, 1, 1, 1};
  perp_problem* problem = kojima();
  for (m = 0; m < sizeof methods / sizeof *methods; ++m) {
    perp_solver* solver = solver_with(methods[m]);
    perp_result* result = NULL;
    double iterations = -1, natural = -1;
    int64_t worst = -2;
    OK(perp_solve(solver, problem, x0, &result, &error));
    CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
    CHECK(perp_result_status(result) == PERP_SOLVED && strcmp(perp_status_name(PERP_SOLVED), "Solved") == 0);
    CHECK(perp_result_length(result, "x") == 4 && kojima_solved(perp_result_reals(result, "x")));
    iterations = number(result, "stats", "iterations");
    CHECK(iterations >= 1);
    OK(perp_problem_residual(problem, perp_result_reals(result, "x"), &natural, &worst, &error));
    CHECK(natural == perp_result_real(result, "residual") && natural <= 1e-8);
    CHECK(perp_result_text(result, "message", 0)[0] != '\0' && perp_result_text(result, "advice", 0)[0] == '\0');
    perp_result_free(result);
    perp_solver_free(solver);
  }
  perp_problem_free(problem);
}

/* The last column's rows in another order, and 64-bit indices. */
static int32_t shuffled_J(int64_t n, int64_t nonzeros, const double* x, double* value, void* user) {
  double swap;
  kojima_J(n, nonzeros, x, value, user);
  swap = value[0];
  value[0] = value[3];
  value[3] = swap;
  return PERP_DEFINED;
}

/* Without J: by differences, in any order of the pattern, one evaluation of F for each of its four columns that are
   full (Curtis, Powell & Reid 1974). Would catch an order or a count of groups that is lost. */
static void without_J(void) {
  const int32_t row[] = {3, 1, 2, 0, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
  const double x0[] = {1, 1, 1, 1};
  const int8_t linear[16] = {0};
  const perp_matrix pattern = csc32(4, kojima_start, row, NULL);
  double colours = 0, F_evals = 0, J_evals = 0;
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  OK(perp_problem_create(PERP_INTERFACE, 4, NULL, NULL, &pattern, kojima_F, NULL, NULL, &problem, &error));
  OK(perp_check_jacobian(NULL, problem, x0, &result, &error));
  CHECK(perp_result_real(result, "worst") < 1e-4 && perp_result_text(result, "message", 0)[0] == '\0');
  perp_result_free(result);
  OK(perp_solve(NULL, problem, x0, &result, &error));
  CHECK_SAYING(solved(result) && kojima_solved(perp_result_reals(result, "x")), perp_result_text(result, "message", 0));
  colours = number(result, "stats", "J_colours");
  F_evals = number(result, "stats", "J_F_evals");
  J_evals = number(result, "stats", "J_evals");
  CHECK(colours == 4 && J_evals >= 1 && F_evals >= 4 * J_evals);
  REFUSED(perp_problem_set_linear(problem, linear, &error), PERP_BAD_ARGUMENT, "linear: J of the problem is NULL");
  perp_result_free(result);
  perp_problem_free(problem);
}

static void rows_in_any_order(void) {
  const int64_t start[] = {0, 4, 8, 12, 16};
  const int64_t row[] = {3, 1, 2, 0, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
  const double x0[] = {1, 1, 1, 1};
  const perp_matrix pattern = csc64(4, start, row, NULL);
  int64_t i;
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  OK(perp_problem_create(PERP_INTERFACE, 4, NULL, NULL, &pattern, kojima_F, shuffled_J, NULL, &problem, &error));
  OK(perp_check_jacobian(NULL, problem, x0, &result, &error));
  CHECK(perp_result_real(result, "worst") < 1e-6);
  perp_result_free(result);
  OK(perp_solve(NULL, problem, x0, &result, &error));
  CHECK(kojima_solved(perp_result_reals(result, "x")));
  perp_result_free(result);
  perp_problem_free(problem);
  /* In the other order J is wrong, which the check names. */
  OK(perp_problem_create(PERP_INTERFACE, 4, NULL, NULL, &pattern, kojima_F, kojima_J, NULL, &problem, &error));
  OK(perp_check_jacobian(NULL, problem, x0, &result, &error));
  i = perp_result_integer(result, "row");
  CHECK(perp_result_real(result, "worst") > 0.1 && perp_result_integer(result, "column") == 0 && (i == 0 || i == 3));
  CHECK(strstr(perp_result_text(result, "message", 0), "x[0]") != NULL);
  perp_result_free(result);
  perp_problem_free(problem);
}

static void options(void) {
  char value[64];
  int64_t i, found = 0;
  perp_result* list = NULL;
  perp_solver* solver = NULL;
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_solver_get(solver, "method", value, sizeof value, &error));
  CHECK(strcmp(value, "auto") == 0);
  OK(perp_solver_set(solver, "method", "path", &error));
  OK(perp_solver_set(solver, "conv_tol", "1e-10", &error)); /* shortened */
  OK(perp_solver_get(solver, "convergence_tolerance", value, sizeof value, &error));
  CHECK(strcmp(value, "1e-10") == 0);
  REFUSED(perp_solver_set(solver, "convergence_tolerance", "-1", &error), PERP_BAD_OPTION, "convergence_tolerance");
  REFUSED(perp_solver_set(solver, "no_such_option", "1", &error), PERP_BAD_OPTION, "no_such_option");
  REFUSED(perp_solver_set(solver, "method", "pth", &error), PERP_BAD_OPTION, "Did you mean 'path'");
  OK(perp_solver_get(solver, "convergence_tolerance", value, 4, &error)); /* what fits, and the refused are not in */
  CHECK(strcmp(value, "1e-") == 0);
  OK(perp_solver_set(solver, "logfile", "x.log", &error)); /* PATH's, without effect here: a note */
  CHECK(perp_solver_note(solver, 0) != NULL && strstr(perp_solver_note(solver, 0), "logfile") != NULL);
  CHECK(perp_solver_note(solver, 1) == NULL && perp_solver_note(solver, -1) == NULL);
  OK(perp_solver_clear_options(solver, &error));
  OK(perp_solver_get(solver, "convergence_tolerance", value, sizeof value, &error));
  CHECK(strcmp(value, "1e-08") == 0);
  REFUSED(perp_solver_read_options(solver, "/no/such/file", &error), PERP_BAD_FILE, "/no/such/file");
  OK(perp_list(PERP_INTERFACE, "options", &list, &error));
  for (i = 0; i < perp_result_length(list, "items"); ++i) {
    const perp_result* option = perp_result_part(list, "items", i);
    CHECK(perp_result_text(option, "takes", 0)[0] != '\0' && perp_result_text(option, "help", 0)[0] != '\0');
    if (strcmp(perp_result_text(option, "key", 0), "convergence_tolerance") == 0) ++found;
  }
  CHECK(found == 1 && perp_result_part(list, "items", i) == NULL);
  perp_result_free(list);
  perp_solver_free(solver);
}

struct Heard {
  int lines;
  int iterations;
  int last_k;
  int stop_at;
  int with_x;
  perp_solver* solver;
};

static void hear(const char* line, void* user) {
  CHECK(strchr(line, '\n') == NULL);
  ++((struct Heard*)user)->lines;
}

static int32_t see(const perp_iteration* iteration, void* user) {
  struct Heard* heard = user;
  CHECK(iteration->struct_size == (int64_t)sizeof *iteration && iteration->n == 4);
  if (iteration->x != NULL) ++heard->with_x;
  ++heard->iterations;
  heard->last_k = (int)iteration->k;
  return heard->iterations == heard->stop_at;
}

static void listening_and_stopping(void) {
  const double x0[] = {1, 1, 1, 1};
  struct Heard heard = {0, 0, 0, 0, 0, NULL};
  perp_problem* problem = kojima();
  perp_solver* solver = solver_with("semismooth");
  perp_result* result = NULL;
  double iterations = -1;
  OK(perp_solver_set_log(solver, hear, &heard, &error));
  OK(perp_solver_set_progress(solver, see, &heard, &error));
  OK(perp_solve(solver, problem, x0, &result, &error));
  iterations = number(result, "stats", "iterations");
  CHECK(heard.iterations == (int)iterations + 1 && heard.last_k == (int)iterations); /* the start, too */
  CHECK(heard.lines >= heard.iterations && heard.with_x == heard.iterations);
  CHECK(perp_result_length(result, "log") == heard.iterations);
  CHECK(perp_result_iterations(result, "log")[heard.iterations - 1].residual == perp_result_real(result, "residual"));
  perp_result_free(result);
  /* The options that make PATH silent make this silent. */
  OK(perp_solver_set(solver, "output", "no", &error));
  heard.lines = 0;
  OK(perp_solve(solver, problem, x0, &result, &error));
  CHECK(heard.lines == 0);
  perp_result_free(result);
  /* A progress callback that stops. */
  heard.iterations = 0;
  heard.stop_at = 2;
  OK(perp_solve(solver, problem, x0, &result, &error));
  CHECK(perp_result_status(result) == PERP_INTERRUPTED && heard.iterations == 2 &&
        perp_result_length(result, "x") == 4);
  perp_result_free(result);
  /* An interruption before the solve ends it, and holds for one solve. */
  heard.stop_at = 0;
  perp_solver_interrupt(solver);
  OK(perp_solve(solver, problem, x0, &result, &error));
  CHECK(perp_result_status(result) == PERP_INTERRUPTED);
  perp_result_free(result);
  OK(perp_solve(solver, problem, x0, &result, &error));
  CHECK(solved(result));
  perp_result_free(result);
  perp_solver_free(solver);
  perp_problem_free(problem);
}

/* From a basis of the solution's, path needs no pivot for the solution's linearised problem; from none it needs some.
 */
static void warm_basis(void) {
  const double x0[] = {1, 1, 1, 1};
  const int8_t outside[] = {7, 0, 0, 0};
  perp_problem* problem = kojima();
  perp_solver* solver = solver_with("path");
  perp_result* cold = NULL;
  perp_result* warm = NULL;
  double pivots = -1;
  OK(perp_solve(solver, problem, x0, &cold, &error));
  CHECK(perp_result_cells(cold, "basis") != NULL);
  OK(perp_solver_set_basis(solver, 4, perp_result_cells(cold, "basis"), &error));
  OK(perp_solve(solver, problem, perp_result_reals(cold, "x"), &warm, &error));
  pivots = number(warm, "stats", "pivots");
  CHECK(solved(warm) && pivots == 0);
  CHECK(memcmp(perp_result_reals(warm, "x"), perp_result_reals(cold, "x"), 4 * sizeof(double)) == 0);
  REFUSED(perp_solver_set_basis(solver, 4, outside, &error), PERP_BAD_ARGUMENT, "cells: entry [0] is 7");
  perp_result_free(warm);
  OK(perp_solver_set_basis(solver, 3, perp_result_cells(cold, "basis"), &error));
  REFUSED(perp_solve(solver, problem, x0, &warm, &error), PERP_BAD_ARGUMENT, "3 cells");
  CHECK(warm == NULL);
  OK(perp_solver_set(solver, "method", "smooth", &error));
  REFUSED(perp_solve(solver, problem, x0, &warm, &error), PERP_BAD_ARGUMENT, "basis");
  OK(perp_solver_set_basis(solver, 0, NULL, &error));
  OK(perp_solve(solver, problem, x0, &warm, &error));
  CHECK(solved(warm));
  perp_result_free(warm);
  perp_result_free(cold);
  perp_solver_free(solver);
  perp_problem_free(problem);
}

static void names_and_bounds(void) {
  const char* const variables[] = {"bread", "butter", "jam", "tea"};
  const int8_t linear[kojima_nonzeros] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
  const double lower[] = {0, 1, -HUGE_VAL, 0};
  const double upper[] = {5, 1, HUGE_VAL, HUGE_VAL};
  double low[4], high[4], start[4];
  char name[8];
  perp_problem* problem = NULL;
  OK(perp_problem_create(PERP_INTERFACE, 4, lower, upper, &kojima_pattern, kojima_F, kojima_J, NULL, &problem, &error));
  CHECK(perp_problem_size(problem) == 4 && perp_problem_nonzeros(problem) == 16);
  OK(perp_problem_bounds(problem, low, high, &error));
  CHECK(memcmp(low, lower, sizeof low) == 0 && memcmp(high, upper, sizeof high) == 0);
  OK(perp_problem_start(problem, 0, start, &error));
  REFUSED(perp_problem_start(problem, 1, start, &error), PERP_BAD_ARGUMENT, "k: 1");
  CHECK(start[0] == 0 && start[1] == 1 && start[2] == 0);
  OK(perp_problem_variable_name(problem, 1, name, sizeof name, &error));
  CHECK(strcmp(name, "x[1]") == 0);
  OK(perp_problem_count_from(problem, 1, &error));
  OK(perp_problem_variable_name(problem, 1, name, sizeof name, &error));
  CHECK(strcmp(name, "x[2]") == 0);
  OK(perp_problem_set_name(problem, "breakfast", &error));
  OK(perp_problem_set_names(problem, variables, NULL, &error));
  OK(perp_problem_variable_name(problem, 1, name, sizeof name, &error));
  CHECK(strcmp(name, "butter") == 0);
  OK(perp_problem_equation_name(problem, 3, name, sizeof name, &error));
  CHECK(strcmp(name, "F[4]") == 0);
  REFUSED(perp_problem_variable_name(problem, 4, name, sizeof name, &error), PERP_BAD_ARGUMENT, "i: 4");
  OK(perp_problem_set_linear(problem, linear, &error));
  OK(perp_problem_set_linear(problem, NULL, &error));
  perp_problem_free(problem);
}

static void model_from_file(void) {
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  char name[64];
  double x0 = -1;
  (void)x0;
  OK(perp_problem_read_nl(PERP_INTERFACE, PERP_SOURCE_DIR "/data/models/cournot.nl", &problem, &error));
  OK(perp_problem_variable_name(problem, 0, name, sizeof name, &error));
  CHECK(name[0] != 'x');
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
  perp_result_free(result);
  perp_problem_free(problem);
  REFUSED(perp_problem_read_nl(PERP_INTERFACE, "/no/such.nl", &problem, &error), PERP_BAD_FILE, "/no/such");
  CHECK(problem == NULL);
}

static void versions(void) {
  perp_solver* solver = (perp_solver*)&error; /* anything but NULL */
  CHECK(perp_interface() == PERP_INTERFACE && perp_version()[0] != '\0');
  REFUSED(perp_solver_create(PERP_INTERFACE + 1, &solver, &error), PERP_BAD_INTERFACE, "interface: ");
  CHECK(solver == NULL);
  REFUSED(perp_solver_create(PERP_INTERFACE + 1000, &solver, &error), PERP_BAD_INTERFACE, "interface: ");
  REFUSED(perp_solver_create(0, &solver, &error), PERP_BAD_INTERFACE, "interface: ");
  CHECK(strcmp(perp_code_name(PERP_BAD_FILE), "bad file") == 0 && strcmp(perp_code_name(99), "?") == 0);
  CHECK(strcmp(perp_status_name(-1), "?") == 0 && strcmp(perp_status_name(PERP_NO_MEMORY), "OutOfMemory") == 0);
}

/* Both solutions, the derivative x(p) = max(0, p) of F = x - p, a proof, and what is wrong with a problem. */
static int32_t shifted_F(int64_t n, const double* x, double* F, void* user) {
  int64_t i;
  for (i = 0; i < n; ++i) F[i] = x[i] - ((const double*)user)[i];
  return PERP_DEFINED;
}

static void more_than_a_solution(void) {
  const double x0[] = {1, 1, 1, 1};
  double p[] = {2, -1};
  const double x[] = {2, 0};
  const double minus_one[] = {-1, 0, 0, -1};
  const perp_matrix dF = matrix(PERP_DENSE_ROWS, 2, 2, NULL, NULL, minus_one);
  perp_problem* problem = kojima();
  perp_result* result = NULL;
  OK(perp_solve_all(NULL, problem, x0, 10, &result, &error));
  CHECK(perp_result_length(result, "found") == 2);
  CHECK(kojima_solved(perp_result_reals(perp_result_part(result, "found", 1), "x")));
  CHECK(perp_result_text(perp_result_part(result, "found", 1), "how", 0)[0] != '\0');
  perp_result_free(result);
  OK(perp_verify(NULL, problem, x0, &result, &error));
  CHECK(perp_result_integer(result, "unique") == 0 && perp_result_text(result, "why_not", 0)[0] != '\0');
  perp_result_free(result);
  perp_problem_free(problem);
  OK(perp_problem_create(PERP_INTERFACE, 2, NULL, NULL, NULL, shifted_F, NULL, p, &problem, &error));
  OK(perp_sensitivity(NULL, problem, x, &dF, NULL, NULL, NULL, &result, &error));
  CHECK_SAYING(perp_result_integer(result, "known") == 1, perp_result_text(result, "message", 0));
  CHECK(perp_result_length(result, "dx") == 4 && perp_result_integer(result, "directions") == 2);
  CHECK_NEAR(perp_result_reals(result, "dx")[0], 1, 1e-6);
  CHECK_NEAR(perp_result_reals(result, "dx")[3], 0, 1e-6);
  CHECK_NEAR(perp_result_reals(result, "dF")[3], -1, 1e-6);
  perp_result_free(result);
  OK(perp_inspect(NULL, problem, NULL, &result, &error));
  CHECK(perp_result_integer(result, "structural_rank") == 2 && number(result, "bounds", "lower") == 2);
  perp_result_free(result);
  p[0] = nan("");
  OK(perp_inspect(NULL, problem, NULL, &result, &error));
  CHECK(perp_result_length(result, "warnings") >= 1 && strstr(perp_result_text(result, "warnings", 0), "F[0]") != NULL);
  perp_result_free(result);
  perp_problem_free(problem);
}

static void the_collection(void) {
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  char name[32];
  OK(perp_problem_collection(PERP_INTERFACE, "josephy", &problem, &error));
  CHECK(perp_problem_size(problem) == 4 && perp_problem_starts(problem) > 1);
  CHECK(strcmp(perp_problem_name(problem), "josephy") == 0 && perp_problem_source(problem)[0] != '\0');
  OK(perp_problem_equation_name(problem, 0, name, sizeof name, &error));
  CHECK(strcmp(name, "F[1]") == 0);
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  CHECK(solved(result));
  perp_result_free(result);
  perp_problem_free(problem);
  OK(perp_problem_collection(PERP_INTERFACE, "obstacle:7x5", &problem, &error));
  CHECK(perp_problem_size(problem) == 35);
  perp_problem_free(problem);
  REFUSED(perp_problem_collection(PERP_INTERFACE, "obstacle:0x5", &problem, &error), PERP_BAD_ARGUMENT, "name: ");
  REFUSED(perp_problem_collection(PERP_INTERFACE, "josephy:3", &problem, &error), PERP_BAD_ARGUMENT, "one size");
}

int main(void) {
  more_than_a_solution();
  the_collection();
  every_method_solves();
  without_J();
  rows_in_any_order();
  options();
  listening_and_stopping();
  warm_basis();
  names_and_bounds();
  model_from_file();
  versions();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
