// SPDX-License-Identifier: Apache-2.0
/* What a client of PATH's interface promises before it is asked for values: sizes that are no sizes or more than the
   memory there is, and that F is affine. */
#define _POSIX_C_SOURCE 200809L
#include "path_client.h"

#include "check.h"
#include "little_memory.h"

enum { Solved = 1, Infeasible = 9, Error = 10 };

/* F = (first + slope x, 1) on x >= 0. */
static struct {
  int n, nonzeros, entries; /* entries that J has: (2, 2), which is 0, or none */
  double first, slope;
  int calls;
  char text[1 << 12];
} problem;

static void size(void* id, int* n, int* nonzeros) {
  (void)id;
  *n = problem.n;
  *nonzeros = problem.nonzeros;
}
static void bounds(void* id, int n, double* x, double* lower, double* upper) {
  int i;
  (void)id;
  for (i = 0; i < n; ++i) x[i] = lower[i] = 0, upper[i] = 1e20;
}
static int F(void* id, int n, double* x, double* f) {
  (void)id;
  (void)n;
  ++problem.calls;
  f[0] = problem.first + problem.slope * x[0];
  f[1] = 1;
  return 0;
}
static int J(void* id, int n, double* x, int want_F, double* f, int* nonzeros, int* col, int* len, int* row,
             double* value) {
  if (want_F > 0) F(id, n, x, f);
  col[0] = col[1] = 1;
  len[0] = 0;
  *nonzeros = len[1] = problem.entries;
  if (problem.entries > 0) row[0] = 2, value[0] = 0;
  return 0;
}
static void print(void* data, int mode, char* text) {
  (void)data;
  (void)mode;
  if (strlen(problem.text) + strlen(text) < sizeof problem.text) strcat(problem.text, text);
}

/* Declared as an LCP. x: the first two of the answer. */
static int solve(double* x) {
  struct Interface interface = {NULL, size, bounds, F, J, NULL, NULL, NULL, NULL, NULL, NULL};
  struct Output output = {NULL, print, NULL};
  void* options = path.Options_Create();
  void* mcp = path.MCP_Create(problem.n, problem.nonzeros);
  int status;
  problem.text[0] = '\0';
  problem.calls = 0;
  path.Output_SetInterface(&output);
  path.Options_Default(options);
  path.MCP_SetInterface(mcp, &interface);
  path.Path_SetProblemClass(mcp, 1);
  status = path.Path_Solve(mcp, NULL);
  if (x != NULL) memcpy(x, path.MCP_GetX(mcp), 2 * sizeof *x);
  path.MCP_Destroy(mcp);
  path.Options_Destroy(options);
  return status;
}

/* Refused by their values, before anything is touched: of 2e9 promised entries 24 GB were once filled. */
static void sizes(void) {
  static const int given[][2] = {{2, 2000000000},          {2, 2147483647}, {2147483647, 12},
                                 {2147483647, 2147483647}, {2, -1},         {-2147483647 - 1, 12}};
  struct rlimit before;
  const int limited = limit_memory(&before);
  size_t k;
  for (k = 0; k < sizeof given / sizeof *given; ++k) {
    char n[16], nonzeros[16];
    if (!limited && k < 2) continue; /* this machine may have so much */
    problem.n = given[k][0];
    problem.nonzeros = given[k][1];
    snprintf(n, sizeof n, "%d ", problem.n);
    snprintf(nonzeros, sizeof nonzeros, "%d ", problem.nonzeros);
    CHECK_SAYING(solve(NULL) == Error, problem.text);
    CHECK_SAYING(strstr(problem.text, n) != NULL && strstr(problem.text, nonzeros) != NULL, problem.text);
    CHECK_SAYING(problem.calls == 0, problem.text);
  }
  setrlimit(RLIMIT_AS, &before);
}

/* F = (-1, 1): no solution, proven, whether J has a zero in it or nothing. The latter once ended as a nonlinear problem
   does. F = (2, 1) is solved by 0. */
static void constant(void) {
  double x[2];
  for (problem.entries = 0; problem.entries < 2; ++problem.entries) {
    problem.n = 2;
    for (problem.nonzeros = problem.entries; problem.nonzeros < 3; ++problem.nonzeros) {
      problem.first = -1;
      CHECK_SAYING(solve(x) == Infeasible, problem.text);
      problem.first = 2;
      CHECK_SAYING(solve(x) == Solved && x[0] == 0 && x[1] == 0, problem.text);
    }
  }
}

/* F = (x - 1, 1) is declared to be constant: x = 1 solves it. Once proven to have no solution. */
static void broken_promise(void) {
  problem.n = 2;
  problem.nonzeros = problem.entries = 0;
  problem.first = -1;
  problem.slope = 1;
  CHECK_SAYING(solve(NULL) == Error && strstr(problem.text, "not as linear as the problem declares") != NULL,
               problem.text);
  problem.slope = 0;
}

int main(int argc, char** argv) {
  if (argc != 2) return EXIT_FAILURE;
  load_path(argv[1]);
  sizes();
  constant();
  broken_promise();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
