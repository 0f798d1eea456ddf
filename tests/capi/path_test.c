// SPDX-License-Identifier: Apache-2.0
/* libperp_path.so as PATHSolver.jl calls it (path_client.h), in the order of its solve_mcp: would catch a structure of
   another layout, bytes written behind PATHSolver.jl's Information, options or output that do not arrive, a limit on
   the size, callbacks that are believed. Problems and answers are those of PATHSolver.jl's tests (test/C_API.jl) where
   nothing else is said. */
#define _POSIX_C_SOURCE 200809L
#include "path_client.h"

#include <math.h>
#include <pthread.h>

#include "check.h"

enum { Solved = 1, NoProgress = 2, UserInterrupt = 6, BoundError = 7, DomainError = 8, Infeasible = 9, Error = 10 };
enum { most = 16 };

struct Problem {
  int n, nonzeros;
  double start[most], lower[most], upper[most];
  int (*F)(const double* x, double* F);
  /* Fills in all, or (calls > 0 && once) values only. */
  int (*J)(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value);
  int once;
  int F_calls, J_calls, started, finished;
  int basis[most];
  int wrong; /* what J does wrong */
  char text[1 << 16];
};

static void size(void* id, int* n, int* nonzeros) {
  *n = ((struct Problem*)id)->n;
  *nonzeros = ((struct Problem*)id)->nonzeros;
}
static void bounds(void* id, int n, double* x, double* lower, double* upper) {
  struct Problem* problem = id;
  memcpy(x, problem->start, (size_t)n * sizeof *x);
  memcpy(lower, problem->lower, (size_t)n * sizeof *x);
  memcpy(upper, problem->upper, (size_t)n * sizeof *x);
}
static int F(void* id, int n, double* x, double* f) {
  struct Problem* problem = id;
  ++problem->F_calls;
  CHECK(n == problem->n);
  return problem->F(x, f);
}
static int J(void* id, int n, double* x, int want_F, double* f, int* nonzeros, int* col, int* len, int* row,
             double* data) {
  struct Problem* problem = id;
  int j, errors = 0;
  CHECK(*nonzeros == problem->nonzeros); /* Julia makes arrays of this length */
  if (want_F > 0) errors += F(id, n, x, f);
  errors += problem->J(problem, x, col, len, row, data);
  ++problem->J_calls;
  *nonzeros = 0;
  for (j = 0; j < n; ++j) *nonzeros += len[j];
  return errors;
}
static void print(void* data, int mode, char* text) {
  struct Problem* problem = data;
  CHECK(mode >= 1 && mode <= 7);
  if (strlen(problem->text) + strlen(text) < sizeof problem->text) strcat(problem->text, text);
}
static void name(void* id, int i, char* buffer, int length) {
  (void)id;
  CHECK(i >= 1 && length > 20);
  snprintf(buffer, (size_t)length, "nutmeg%d", i);
}
static void started(void* id) { ++((struct Problem*)id)->started; }
static void finished(void* id, double* x) {
  CHECK(x != NULL);
  ++((struct Problem*)id)->finished;
}
static void basis(void* id, int n, int* out) { memcpy(out, ((struct Problem*)id)->basis, (size_t)n * sizeof *out); }
static void all_linear(void* data, int nonzeros, int* type) {
  int k;
  (void)data;
  for (k = 0; k < nonzeros; ++k) {
    CHECK(type[k] == 1);
    type[k] = 0;
  }
}

/* What Julia's structure ends with, and what must stay as it is behind byte 84. */
union Guarded {
  struct Information information;
  unsigned char bytes[160];
};

struct Extras {
  const char* option;
  int named, linear, basic, framed;
};

static int solve(struct Problem* problem, union Guarded* guarded, struct Extras extras, double* x, int* B) {
  struct Interface interface = {problem, size, bounds, F, J, NULL, NULL, NULL, NULL, NULL, NULL};
  struct Output output = {problem, print, NULL};
  struct Presolve presolve = {problem, NULL, NULL, NULL, NULL, all_linear, NULL};
  void* options;
  void* mcp;
  int status;
  size_t b;
  path.Output_SetInterface(&output);
  CHECK(path.Path_CheckLicense(problem->n, problem->nonzeros) != 0);
  options = path.Options_Create();
  path.Path_AddOptions(options);
  path.Options_Default(options);
  mcp = path.MCP_Create(problem->n, problem->nonzeros);
  if (problem->once) path.MCP_Jacobian_Structure_Constant(mcp, 1);
  path.MCP_Jacobian_Data_Contiguous(mcp, 1);
  if (extras.named) interface.variable_name = interface.constraint_name = name;
  if (extras.basic) interface.basis = basis;
  if (extras.framed) interface.start = started, interface.finish = finished;
  path.MCP_SetInterface(mcp, &interface);
  if (extras.linear) path.MCP_SetPresolveInterface(mcp, &presolve);
  if (extras.option != NULL) CHECK(path.Options_Set(options, extras.option) == 0);
  path.Options_Display(options);
  memset(guarded->bytes, 0xA5, sizeof guarded->bytes);
  memset(guarded->bytes, 0, 84);
  status = path.Path_Solve(mcp, guarded);
  for (b = 84; b < sizeof guarded->bytes; ++b) CHECK(guarded->bytes[b] == 0xA5);
  if (problem->n > 0 && x != NULL && path.MCP_GetX(mcp) != NULL)
    memcpy(x, path.MCP_GetX(mcp), (size_t)problem->n * sizeof *x);
  if (problem->n > 0 && B != NULL) memcpy(B, path.MCP_GetB(mcp), (size_t)problem->n * sizeof *B);
  path.MCP_Destroy(mcp);
  path.Options_Destroy(options);
  return status;
}

/* "Example": an LCP in [0, 10]^4 with the solution (2.8, 0, 0.8, 1.2). */
static int example_F(const double* x, double* f) {
  f[0] = -x[2] - x[3] + 2;
  f[1] = x[2] - 2 * x[3] + 2;
  f[2] = x[0] - x[1] + 2 * x[2] - 2 * x[3] - 2;
  f[3] = x[0] + 2 * x[1] - 2 * x[2] + 4 * x[3] - 6;
  return 0;
}
static int example_J(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value) {
  static const int cols[] = {1, 3, 5, 9}, lens[] = {2, 2, 4, 4}, rows[] = {3, 4, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4};
  static const double values[] = {1, 1, -1, 2, -1, 1, 2, -2, -1, -2, -2, 4};
  (void)x;
  if (!problem->once || problem->J_calls == 0) {
    memcpy(col, cols, sizeof cols);
    memcpy(len, lens, sizeof lens);
    memcpy(row, rows, sizeof rows);
  }
  memcpy(value, values, sizeof values);
  return 0;
}
static struct Problem example(void) {
  struct Problem problem = {4, 12, {0}, {0}, {10, 10, 10, 10}, example_F, example_J, 1, 0, 0, 0, 0, {0}, 0, ""};
  return problem;
}
static void check_example(const double* x) {
  CHECK_NEAR(x[0], 2.8, 1e-8);
  CHECK_NEAR(x[1], 0, 1e-8);
  CHECK_NEAR(x[2], 0.8, 1e-8);
  CHECK_NEAR(x[3], 1.2, 1e-8);
}

static void examples(void) {
  struct Extras extras = {"output yes", 0, 0, 0, 1};
  union Guarded guarded;
  double x[4];
  int B[4], k;
  for (k = 0; k < 8; ++k) {
    struct Problem problem = example();
    problem.once = k % 2;
    extras.linear = k / 2 % 2;
    extras.named = k / 4;
    CHECK(solve(&problem, &guarded, extras, x, B) == Solved);
    check_example(x);
    CHECK(B[0] == 1 && B[1] == 3 && B[2] == 1 && B[3] == 1);
    CHECK(guarded.information.residual < 1e-10 && guarded.information.restarts == 0);
    CHECK(guarded.information.function_evaluations == problem.F_calls && problem.F_calls > 0);
    CHECK(guarded.information.jacobian_evaluations == problem.J_calls);
    CHECK_NEAR(guarded.information.distance, sqrt(2.8 * 2.8 + 0.8 * 0.8 + 1.2 * 1.2), 1e-8);
    CHECK(guarded.information.generated_output == 1 && strstr(problem.text, "Path ") != NULL);
    CHECK(problem.started == 1 && problem.finished == 1);
  }
}

/* "Example II", nonlinear, with the structure anew in every call and (as there) one derivative that is wrong. */
static int second_F(const double* x, double* f) {
  f[0] = -x[2] * x[2] - x[3] + 2;
  f[1] = x[2] * x[2] * x[2] - 2 * x[3] * x[3] + 2;
  f[2] = pow(x[0], 5) - x[1] + 2 * x[2] - 2 * x[3] - 2;
  f[3] = x[0] + 2 * x[1] * x[1] * x[1] - 2 * x[2] + 4 * x[3] - 6;
  return 0;
}
static int second_J(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value) {
  example_J(problem, x, col, len, row, value);
  value[0] = 5 * pow(x[0], 4);
  value[3] = 6 * x[1];
  value[4] = -2 * x[2];
  value[5] = 3 * x[2] * x[2];
  value[9] = -4 * x[3];
  return 0;
}
static void second_example(void) {
  struct Problem problem = {4, 12, {1, 1, 1, 1}, {0}, {10, 10, 10, 10}, second_F, second_J, 0, 0, 0, 0, 0, {0}, 0, ""};
  struct Extras extras = {"output no", 0, 0, 0, 0};
  union Guarded guarded;
  double x[4];
  CHECK(solve(&problem, &guarded, extras, x, NULL) == Solved);
  CHECK_NEAR(x[0], 1.28475, 1e-4);
  CHECK_NEAR(x[1], 0.972916, 1e-4);
  CHECK_NEAR(x[2], 0.909376, 1e-4);
  CHECK_NEAR(x[3], 1.17304, 1e-4);
  CHECK(guarded.information.residual < 1e-5 && problem.text[0] == '\0');
}

/* A client that lists nonzero derivatives only: x1 x2 = 1 with x1 = 2 from (0, 0), where dF1/dx1 = x2 = 0 and
   dF1/dx2 = x1 = 0, has a pattern that grows; columns overlap in no order, and one place stands twice. */
static int growing_F(const double* x, double* f) {
  f[0] = x[0] * x[1] - 1;
  f[1] = x[0] - 2;
  return 0;
}
static int growing_J(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value) {
  int k = 4;
  (void)problem;
  col[1] = 1;
  len[1] = x[0] != 0;
  row[0] = 1, value[0] = x[0];
  col[0] = k + 1;
  row[k] = 2, value[k++] = 0.25;
  if (x[1] != 0) row[k] = 1, value[k++] = x[1];
  row[k] = 2, value[k++] = 0.75;
  len[0] = k + 1 - col[0];
  return 0;
}
static void growing_pattern(void) {
  struct Problem problem = {2,   8, {0, 0}, {-1e20, -1e20}, {1e20, 1e20}, growing_F, growing_J, 0, 0, 0, 0, 0,
                            {0}, 0, ""};
  struct Extras extras = {NULL, 0, 0, 0, 0};
  union Guarded guarded;
  double x[2];
  CHECK(solve(&problem, &guarded, extras, x, NULL) == Solved);
  CHECK_NEAR(x[0], 2, 1e-8);
  CHECK_NEAR(x[1], 0.5, 1e-8);
}

/* What J does wrong, by number. */
static int wrong_J(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value) {
  example_J(problem, x, col, len, row, value);
  if (problem->wrong == 0) col[2] = 0;
  if (problem->wrong == 1) len[1] = 200;
  if (problem->wrong == 2) row[5] = 5;
  if (problem->wrong == 3) row[12] = 1; /* beyond what was promised */
  if (problem->wrong == 4) return 3;
  if (problem->wrong == 5) value[2] = nan("");
  if (problem->wrong == 6) len[0] = -1;
  if (problem->wrong == 7) col[0] = col[1] = 1, len[0] = len[1] = 12; /* twice */
  return 0;
}
static int wrong_F(const double* x, double* f) {
  example_F(x, f);
  f[2] = HUGE_VAL;
  return 0;
}
static void malformed(void) {
  static const int wanted[] = {Error, Error, Error, Error, DomainError, DomainError, Error, Error};
  struct Extras extras = {"output yes", 0, 0, 0, 0};
  union Guarded guarded;
  struct Problem problem;
  void* mcp;
  int k;
  for (k = 0; k < 8; ++k) {
    problem = example();
    problem.once = 0;
    problem.J = wrong_J;
    problem.wrong = k;
    CHECK_SAYING(solve(&problem, &guarded, extras, NULL, NULL) == wanted[k], problem.text);
    if (wanted[k] == Error) CHECK_SAYING(strstr(problem.text, "jacobian_evaluation") != NULL, problem.text);
  }
  problem = example();
  problem.F = wrong_F;
  CHECK(solve(&problem, &guarded, extras, NULL, NULL) == DomainError);
  problem = example();
  problem.lower[1] = 11;
  CHECK(solve(&problem, &guarded, extras, NULL, NULL) == BoundError);
  CHECK(strstr(problem.text, "variable 2") != NULL);
  problem = example();
  problem.n = 0;
  CHECK(solve(&problem, &guarded, extras, NULL, NULL) == Solved);
  problem = example();
  problem.n = -3;
  CHECK(solve(&problem, &guarded, extras, NULL, NULL) == Error);
  /* Nothing given. */
  CHECK(path.Path_Solve(NULL, NULL) == Error);
  mcp = path.MCP_Create(3, 3);
  CHECK(path.Path_Solve(mcp, NULL) == Error);
  path.MCP_SetInterface(mcp, NULL);
  CHECK(path.Path_Solve(mcp, NULL) == Error && path.MCP_GetX(NULL) == NULL);
  path.MCP_Destroy(mcp);
  path.MCP_Destroy(NULL);
  path.Output_SetInterface(NULL);
  CHECK(path.Options_Set(NULL, "output yes") != 0);
  path.Options_Destroy(NULL);
}

/* 3e15 x = 1e15 has no double as its solution: the residual is 0.1 at best, which is rounding, but no solution to 1e-8.
   Clients must not hear that it is one. */
static int rough_F(const double* x, double* f) {
  f[0] = 3e15 * x[0] - 1e15;
  return 0;
}
static int rough_J(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value) {
  (void)problem;
  (void)x;
  col[0] = len[0] = row[0] = 1;
  value[0] = 3e15;
  return 0;
}
static int infeasible_F(const double* x, double* f) {
  (void)x;
  f[0] = -1;
  return 0;
}
static int zero_J(struct Problem* problem, const double* x, int* col, int* len, int* row, double* value) {
  rough_J(problem, x, col, len, row, value);
  value[0] = 0;
  return 0;
}
static void unsolved(void) {
  struct Problem rough = {1, 1, {0}, {0}, {1e20}, rough_F, rough_J, 1, 0, 0, 0, 0, {0}, 0, ""};
  struct Problem none = {1, 1, {0}, {0}, {1e20}, infeasible_F, zero_J, 1, 0, 0, 0, 0, {0}, 0, ""};
  struct Extras extras = {"output yes", 0, 1, 0, 0};
  union Guarded guarded;
  double x = 0;
  CHECK_SAYING(solve(&rough, &guarded, extras, &x, NULL) == NoProgress, rough.text);
  CHECK_SAYING(strstr(rough.text, "SolvedToRounding") != NULL, rough.text);
  CHECK_NEAR(x, 1. / 3, 1e-15);
  CHECK_SAYING(solve(&none, &guarded, extras, &x, NULL) == Infeasible, none.text);
}

/* From the basis of the solution no pivot is needed. */
static void warm_basis(void) {
  static const int of_solution[] = {1, 3, 1, 1};
  struct Problem problem = example();
  struct Extras extras = {"method path", 0, 0, 1, 0};
  union Guarded guarded;
  double x[4];
  CHECK(solve(&problem, &guarded, extras, x, NULL) == Solved); /* all unknown: none */
  memcpy(problem.start, x, sizeof x);
  memcpy(problem.basis, of_solution, sizeof of_solution);
  CHECK(solve(&problem, &guarded, extras, x, NULL) == Solved);
  CHECK(guarded.information.minor_iterations == 0);
  check_example(x);
}

static void options(void) {
  char file[] = "/tmp/perp_path_test_XXXXXX";
  struct Problem problem = example();
  struct Output output = {&problem, print, NULL};
  void* o = path.Options_Create();
  FILE* out;
  int handle = mkstemp(file);
  CHECK(handle >= 0);
  out = fdopen(handle, "w");
  fputs("* Automatically generated\nconvergence_tolerance 1e-10\nno_such_option 3\nmajor_iteration_limit 7;\n", out);
  fclose(out);
  path.Output_SetInterface(&output);
  path.Options_Default(o);
  CHECK(path.Options_Read(o, file) != 0); /* one of them is none; the others hold */
  CHECK(strstr(problem.text, "no_such_option") != NULL);
  CHECK(path.Options_GetDouble(o, "convergence_tolerance") == 1e-10 &&
        path.Options_GetInt(o, "major_iteration_limit") == 7);
  CHECK(path.Options_SetDouble(o, "convergence_tolerance", 1e-7) == 0 && path.Options_SetBoolean(o, "output", 0) == 0);
  CHECK(path.Options_SetInt(o, "major_iteration_limit", 9) == 0 && path.Options_SetOther(o, "crash_method", 1) != 0);
  CHECK(path.Options_GetDouble(o, "convergence_tolerance") == 1e-7 && path.Options_GetBoolean(o, "output") == 0);
  CHECK(path.Options_GetInt(o, "major_iteration_limit") == 9 && path.Options_GetInt(o, "no such") == 0);
  CHECK(path.Options_Set(o, "crash_method none") == 0 && path.Options_Set(o, "crash_method=pnewton") == 0);
  CHECK(path.Options_Set(o, "convergence_tolerance -1") != 0 && path.Options_Read(o, "/no/such") != 0);
  path.Options_Default(o);
  CHECK(path.Options_GetDouble(o, "convergence_tolerance") != 1e-7);
  path.Options_Destroy(o);
  remove(file);
}

static void licence(void) {
  int n = 0, nonzeros = 0;
  const char* version = path.Path_Version();
  CHECK(strncmp(version, "Path ", 5) == 0 && version[6] == '.' && version[8] == '.');
  CHECK(path.License_SetString("2617827524&Courtesy") == 0 && path.License_SetString(NULL) == 0);
  CHECK(path.License_SetString("bad_license") != 0);
  CHECK(path.License_GetRestrictions(&n, &nonzeros) == 0 && n > 1000000 && nonzeros > 1000000);
}

/* n = 100,000: tridiag(-1, 4, -1) x >= b with b_i = 1 or -1; no licence. */
enum { large_n = 100000 };
static void large_size(void* id, int* n, int* nonzeros) {
  (void)id;
  *n = large_n;
  *nonzeros = 3 * large_n;
}
static void large_bounds(void* id, int n, double* x, double* lower, double* upper) {
  int i;
  (void)id;
  (void)upper; /* as they come: infinite */
  for (i = 0; i < n; ++i) x[i] = lower[i] = 0;
}
static int large_F(void* id, int n, double* x, double* f) {
  int i;
  (void)id;
  for (i = 0; i < n; ++i)
    f[i] = 4 * x[i] + x[i] * x[i] * x[i] - (i > 0 ? x[i - 1] : 0) - (i + 1 < n ? x[i + 1] : 0) - (i % 3 == 0 ? -1 : 1);
  return 0;
}
static int large_J(void* id, int n, double* x, int want_F, double* f, int* nonzeros, int* col, int* len, int* row,
                   double* data) {
  int j, k = 0;
  if (want_F) large_F(id, n, x, f);
  for (j = 0; j < n; ++j) {
    col[j] = k + 1;
    if (j > 0) row[k] = j, data[k++] = -1;
    row[k] = j + 1, data[k++] = 4 + 3 * x[j] * x[j];
    if (j + 1 < n) row[k] = j + 2, data[k++] = -1;
    len[j] = k + 1 - col[j];
  }
  *nonzeros = k;
  return 0;
}
static void large(void) {
  struct Interface interface = {NULL, large_size, large_bounds, large_F, large_J, NULL, NULL, NULL, NULL, NULL, NULL};
  union Guarded guarded;
  static double f[large_n];
  double worst = 0;
  double* x;
  int i;
  void* mcp = path.MCP_Create(1, 1); /* too small: only a hint */
  path.MCP_SetInterface(mcp, &interface);
  memset(guarded.bytes, 0, sizeof guarded.bytes);
  CHECK(path.Path_Solve(mcp, &guarded) == Solved);
  x = path.MCP_GetX(mcp);
  large_F(NULL, large_n, x, f);
  for (i = 0; i < large_n; ++i) worst = fmax(worst, fabs(fmin(x[i], f[i])));
  CHECK(worst < 1e-8);
  path.MCP_Destroy(mcp);
}

/* Eight threads, each with its own options, output and problem: the bits must be the same in each. */
enum { threads = 8, solves = 50 };
struct Answers {
  double x[solves][4];
  int F_calls[solves];
  int bad;
};
static void* run(void* argument) {
  struct Answers* answers = argument;
  int k;
  for (k = 0; k < solves; ++k) {
    struct Problem* problem = malloc(sizeof *problem);
    struct Extras extras = {k % 2 ? "output yes" : "method semismooth", k % 3 == 0, k % 5 == 0, 0, 1};
    union Guarded guarded;
    *problem = example();
    problem->start[0] = k % 4;
    if (solve(problem, &guarded, extras, answers->x[k], NULL) != Solved) ++answers->bad;
    answers->F_calls[k] = problem->F_calls;
    if (problem->finished != 1) ++answers->bad;
    free(problem);
  }
  return NULL;
}
static void in_threads(void) {
  static struct Answers answers[threads];
  pthread_t thread[threads];
  int t;
  for (t = 0; t < threads; ++t) CHECK(pthread_create(&thread[t], NULL, run, &answers[t]) == 0);
  for (t = 0; t < threads; ++t) CHECK(pthread_join(thread[t], NULL) == 0);
  for (t = 0; t < threads; ++t) CHECK(answers[t].bad == 0 && memcmp(&answers[t], &answers[0], sizeof answers[0]) == 0);
}

/* Beside libperp in one process: PERP_LIBRARY is loaded for all to see, as a program that links it has it. */
static void beside_libperp(const char* library) {
  const char* (*version)(void);
  void* perp = dlopen(library, RTLD_NOW | RTLD_GLOBAL);
  CHECK(perp != NULL);
  if (perp == NULL) return;
  find(perp, "perp_version", &version);
  CHECK(version()[0] != '\0');
}

int main(int argc, char** argv) {
  if (argc != 3) return EXIT_FAILURE;
  CHECK(sizeof(struct Information) == 96 && offsetof(struct Information, generate_output) == 0x4c);
  CHECK(sizeof(struct Interface) == 11 * sizeof(void*));
  beside_libperp(argv[2]);
  load_path(argv[1]);
  licence();
  examples();
  second_example();
  growing_pattern();
  malformed();
  unsolved();
  warm_basis();
  options();
  large();
  in_threads();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
