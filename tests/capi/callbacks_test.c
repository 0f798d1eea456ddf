// SPDX-License-Identifier: Apache-2.0
/* Malformed callbacks and arguments (capi/perp.h): each ends in a code or a status with words that name it, and in no
   crash. Would catch a null pointer that is followed, an answer that is believed, values that were never set. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>

#include "check.h"
#include "helpers.h"
#include "kojima.h"
#include "little_memory.h"

static perp_error error;
static const double x0[] = {2, 2, 2, 2};

/* What the callbacks do wrong, and in which evaluation. */
struct Wrong {
  int32_t answer;
  double value; /* put into entry 2, if `put` */
  int put;
  int skip; /* entry 3 is not set */
  int from;
  int count;
};

static int due(struct Wrong* wrong) { return ++wrong->count >= wrong->from; }

static int32_t wrong_F(int64_t n, const double* x, double* F, void* user) {
  struct Wrong* wrong = user;
  double kept = F[2];
  kojima_F(n, x, F, NULL);
  if (!due(wrong)) return PERP_DEFINED;
  if (wrong->put) F[1] = wrong->value;
  if (wrong->skip) F[2] = kept;
  return wrong->answer;
}

static int32_t plain_J(int64_t n, int64_t nonzeros, const double* x, double* value, void* user) {
  (void)user;
  return kojima_J(n, nonzeros, x, value, NULL);
}

static int32_t plain_F(int64_t n, const double* x, double* F, void* user) {
  (void)user;
  return kojima_F(n, x, F, NULL);
}

static int32_t wrong_J(int64_t n, int64_t nonzeros, const double* x, double* value, void* user) {
  struct Wrong* wrong = user;
  double kept = value[2];
  kojima_J(n, nonzeros, x, value, NULL);
  if (!due(wrong)) return PERP_DEFINED;
  if (wrong->put) value[1] = wrong->value;
  if (wrong->skip) value[2] = kept;
  return wrong->answer;
}

/* The code; the status of a result goes to *status. */
static int32_t solve(perp_F F, perp_J J, struct Wrong* wrong, const char* method, int32_t* status) {
  perp_problem* problem = NULL;
  perp_solver* solver = NULL;
  perp_result* result = NULL;
  int32_t code;
  *status = -1;
  memset(&error, 0, sizeof error);
  OK(perp_problem_create(PERP_INTERFACE, kojima_n, NULL, NULL, &kojima_pattern, F, J, wrong, &problem, &error));
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_solver_set(solver, "method", method, &error));
  code = perp_solve(solver, problem, x0, &result, &error);
  CHECK((code == PERP_OK) == (result != NULL));
  if (result != NULL) {
    *status = perp_result_status(result);
    memcpy(error.message, perp_result_text(result, "message", 0), strlen(perp_result_text(result, "message", 0)) + 1);
    CHECK(perp_result_length(result, "x") == 4);
  }
  perp_result_free(result);
  perp_solver_free(solver);
  perp_problem_free(problem);
  return code;
}

static void bad_callbacks(const char* method) {
  int32_t status;
  int where, from;
  for (where = 0; where < 3; ++where) /* in F, in J, in F while J is taken by differences */
    for (from = 1; from <= 3; ++from) {
      const perp_F F = where == 1 ? plain_F : wrong_F;
      const perp_J J = where == 0 ? plain_J : where == 1 ? wrong_J : NULL;
      const char* name = where == 1 ? "J, in its evaluation" : "F, in its evaluation";
      struct Wrong answers = {77, 0, 0, 0, 0, 0};
      struct Wrong stops = {PERP_STOP, 0, 0, 0, 0, 0};
      struct Wrong undefined = {PERP_UNDEFINED, 0, 0, 0, 0, 0};
      struct Wrong nans = {PERP_DEFINED, 0, 1, 0, 0, 0};
      struct Wrong infinite = {PERP_DEFINED, HUGE_VAL, 1, 0, 0, 0};
      struct Wrong skips = {PERP_DEFINED, 0, 0, 1, 0, 0};
      answers.from = stops.from = undefined.from = nans.from = infinite.from = skips.from = from;
      nans.value = nan("");
      CHECK_SAYING(solve(F, J, &answers, method, &status) == PERP_BAD_CALLBACK, error.message);
      CHECK_SAYING(strstr(error.message, name) != NULL && strstr(error.message, "returned 77") != NULL, error.message);
      CHECK_SAYING(solve(F, J, &skips, method, &status) == PERP_BAD_CALLBACK, error.message);
      CHECK_SAYING(strstr(error.message, name) != NULL &&
                       strstr(error.message, where == 1 ? "left value[2]" : "left F[2]") != NULL,
                   error.message);
      CHECK_SAYING(solve(F, J, &stops, method, &status) == PERP_OK && status == PERP_INTERRUPTED, error.message);
      CHECK_SAYING(strstr(error.message, name) != NULL, error.message);
      CHECK(stops.count == from); /* it is not called again */
      CHECK_SAYING(solve(F, J, &undefined, method, &status) == PERP_OK && status > PERP_SOLVED_TO_ROUNDING,
                   error.message);
      CHECK_SAYING(solve(F, J, &nans, method, &status) == PERP_OK && status > PERP_SOLVED_TO_ROUNDING, error.message);
      CHECK_SAYING(solve(F, J, &infinite, method, &status) == PERP_OK && status > PERP_SOLVED_TO_ROUNDING,
                   error.message);
      if (from == 1) CHECK_SAYING(status == PERP_EVALUATION_FAILED, error.message);
    }
}

/* The message may be unwanted. */
static void silence(void) {
  CHECK(perp_solve(NULL, NULL, NULL, NULL, NULL) == PERP_BAD_ARGUMENT);
  CHECK(perp_problem_read_nl(PERP_INTERFACE, NULL, NULL, NULL) == PERP_BAD_ARGUMENT);
}

static void create(int64_t n, const double* lower, const double* upper, const int32_t* start, const int32_t* row,
                   const char* said) {
  const perp_matrix pattern = csc32(n, start, row, NULL);
  perp_problem* problem = (perp_problem*)&error; /* anything but NULL */
  REFUSED(perp_problem_create(PERP_INTERFACE, n, lower, upper, &pattern, kojima_F, kojima_J, NULL, &problem, &error),
          PERP_BAD_ARGUMENT, said);
  CHECK(problem == NULL);
}

static void bad_patterns(void) {
  const int32_t falling[] = {0, 4, 3, 12, 16};
  const int32_t from_one[] = {1, 5, 9, 13, 17};
  const int32_t short_start[] = {0, 2, 2, 2, 2};
  const int32_t beyond[] = {0, 4};
  const int32_t negative[] = {0, -1};
  const int32_t twice[] = {2, 2};
  const double crossed[] = {0, 0, 3, 0};
  const double above[] = {1, 1, 1, 1};
  double nan_bound[] = {0, 0, 0, 0};
  const double infinite[] = {0, HUGE_VAL, 0, 0};
  nan_bound[1] = nan("");
  create(-1, NULL, NULL, kojima_start, kojima_row, "n: -1");
  create(INT64_C(1) << 40, NULL, NULL, kojima_start, kojima_row, "n: 1099511627776");
  create(4, NULL, NULL, NULL, kojima_row, "pattern: start is NULL");
  create(4, NULL, NULL, kojima_start, NULL, "pattern: index is NULL");
  create(4, NULL, NULL, falling, kojima_row, "pattern: start[2] is 3");
  create(4, NULL, NULL, from_one, kojima_row, "pattern: start[0] is 1");
  create(4, NULL, NULL, short_start, beyond, "pattern: index[1] (of column 0) is 4");
  create(4, NULL, NULL, short_start, negative, "pattern: index[1] (of column 0) is -1");
  create(4, NULL, NULL, short_start, twice, "pattern: row 2, column 0 is given twice");
  create(4, crossed, above, kojima_start, kojima_row, "upper: entry [2]");
  create(4, nan_bound, above, kojima_start, kojima_row, "lower: entry [1]");
  create(4, infinite, NULL, kojima_start, kojima_row, "lower: entry [1]");
}

/* The bounds alone take 34 GB, and are refused before the arrays are looked at. */
static void too_large(void) {
  perp_problem* problem = NULL;
  struct rlimit before;
  if (limit_memory(&before)) {
    REFUSED(
        perp_problem_create(PERP_INTERFACE, 2147483646, NULL, NULL, NULL, kojima_F, kojima_J, NULL, &problem, &error),
        PERP_OUT_OF_MEMORY, "the bounds of 2147483646 variables need 34 GB");
    CHECK(problem == NULL);
  }
  setrlimit(RLIMIT_AS, &before);
}

static void null_pointers(void) {
  perp_problem *problem = NULL, *problem_of_a_name = NULL;
  perp_result* result = NULL;
  double number = 0;
  char text[8];
  double bad_x0[] = {0, 0, 0, 0};
  REFUSED(perp_problem_create(PERP_INTERFACE, 4, NULL, NULL, NULL, NULL, kojima_J, NULL, &problem, &error),
          PERP_BAD_ARGUMENT, "F: is NULL");
  REFUSED(perp_problem_create(PERP_INTERFACE, 4, NULL, NULL, NULL, kojima_F, kojima_J, NULL, NULL, &error),
          PERP_BAD_ARGUMENT, "problem: is NULL");
  OK(perp_problem_create(PERP_INTERFACE, 4, NULL, NULL, NULL, kojima_F, kojima_J, NULL, &problem, &error));
  REFUSED(perp_solve(NULL, problem, x0, NULL, &error), PERP_BAD_ARGUMENT, "result: is NULL");
  REFUSED(perp_solve(NULL, NULL, x0, &result, &error), PERP_BAD_ARGUMENT, "problem: is NULL");
  bad_x0[3] = nan("");
  REFUSED(perp_solve(NULL, problem, bad_x0, &result, &error), PERP_BAD_ARGUMENT, "x0: entry [3] is nan");
  REFUSED(perp_problem_residual(problem, NULL, &number, NULL, &error), PERP_BAD_ARGUMENT, "x: is NULL");
  REFUSED(perp_check_jacobian(NULL, problem, bad_x0, &result, &error), PERP_BAD_ARGUMENT, "x: entry [3] is nan");
  REFUSED(perp_verify(NULL, problem, NULL, &result, &error), PERP_BAD_ARGUMENT, "x: is NULL");
  REFUSED(perp_sensitivity(NULL, problem, x0, NULL, NULL, NULL, NULL, &result, &error), PERP_BAD_ARGUMENT,
          "dF: is NULL");
  REFUSED(perp_solve_all(NULL, problem, x0, 0, &result, &error), PERP_BAD_ARGUMENT, "solutions: 0");
  REFUSED(perp_solve_kept(NULL, problem, x0, &result, &error), PERP_BAD_ARGUMENT, "solver: is NULL");
  REFUSED(perp_list(PERP_INTERFACE, "nonsense", &result, &error), PERP_BAD_ARGUMENT, "what: 'nonsense'");
  REFUSED(perp_problem_collection(PERP_INTERFACE, "josephi", &problem_of_a_name, &error), PERP_BAD_ARGUMENT,
          "'josephy'");
  REFUSED(perp_problem_variable_name(problem, 0, NULL, 5, &error), PERP_BAD_ARGUMENT, "name: is NULL");
  REFUSED(perp_problem_variable_name(problem, 0, text, 0, &error), PERP_BAD_ARGUMENT, "size: 0");
  REFUSED(perp_solver_set(NULL, "method", "path", &error), PERP_BAD_ARGUMENT, "solver: is NULL");
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  /* A field that is not there, of another kind, or beyond the end. */
  CHECK(perp_result_kind(result, "no such") == PERP_NONE && perp_result_kind(result, NULL) == PERP_NONE);
  CHECK(isnan(perp_result_real(result, "message")) && perp_result_integer(result, "x") == -1);
  CHECK(perp_result_reals(result, "message") == NULL && perp_result_text(result, "message", 1) == NULL);
  CHECK(perp_result_text(result, "notes", -1) == NULL && perp_result_part(result, "stats", 1) == NULL);
  CHECK(perp_result_key(result, -1) == NULL && perp_result_key(result, 1000) == NULL);
  perp_result_free(result);
  perp_problem_free(problem);
  perp_problem_free(NULL);
  perp_solver_free(NULL);
  perp_result_free(NULL);
  perp_contact_free(NULL);
  perp_solver_interrupt(NULL);
  CHECK(perp_result_reals(NULL, "x") == NULL && perp_result_length(NULL, "x") == 0 && perp_problem_size(NULL) == 0);
  CHECK(perp_result_status(NULL) == -1 && perp_result_text(NULL, "message", 0) == NULL &&
        perp_solver_note(NULL, 0) == NULL);
  CHECK(perp_result_key(NULL, 0) == NULL && perp_contact_contacts(NULL) == 0);
}

/* A problem without variables is solved. */
static void nothing(void) {
  const int32_t start[] = {0};
  const perp_matrix pattern = csc32(0, start, NULL, NULL);
  perp_problem* problem = NULL;
  perp_result* result = NULL;
  OK(perp_problem_create(PERP_INTERFACE, 0, NULL, NULL, &pattern, kojima_F, kojima_J, NULL, &problem, &error));
  OK(perp_solve(NULL, problem, NULL, &result, &error));
  CHECK(perp_result_length(result, "x") == 0 && solved(result));
  perp_result_free(result);
  perp_problem_free(problem);
}

int main(void) {
  static const char* const methods[] = {"auto", "path", "semismooth", "smooth", "josephy", "interior"};
  size_t m;
  for (m = 0; m < sizeof methods / sizeof *methods; ++m) bad_callbacks(methods[m]);
  silence();
  bad_patterns();
  null_pointers();
  too_large();
  nothing();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
