// SPDX-License-Identifier: Apache-2.0
/* Starts at which a client's F and J are not defined: what every other door says and does is said and done here. */
#define _POSIX_C_SOURCE 200809L
#include "path_client.h"

#include <math.h>

#include "check.h"

enum { Solved = 1, DomainError = 8 };

static double lower;
static char said[1 << 14];

static void size(void* id, int* n, int* nonzeros) {
  (void)id;
  *n = *nonzeros = 2;
}
static void bounds(void* id, int n, double* x, double* low, double* high) {
  int i;
  (void)id;
  for (i = 0; i < n; ++i) x[i] = 0, low[i] = lower, high[i] = 1e20;
}
/* log(x1) = 1 and 1 / x2 = 4 */
static int F(void* id, int n, double* x, double* f) {
  (void)id;
  (void)n;
  f[0] = x[0] > 0 ? log(x[0]) - 1 : nan("");
  f[1] = x[1] > 0 ? 4 - 1 / x[1] : nan("");
  return (x[0] <= 0) + (x[1] <= 0);
}
static int J(void* id, int n, double* x, int want_F, double* f, int* nonzeros, int* col, int* len, int* row,
             double* value) {
  if (want_F > 0) F(id, n, x, f);
  col[0] = row[0] = 1, col[1] = row[1] = 2;
  len[0] = len[1] = 1;
  *nonzeros = 2;
  value[0] = 1 / x[0], value[1] = 1 / (x[1] * x[1]);
  return (x[0] <= 0) + (x[1] <= 0);
}
static void name(void* id, int i, char* buffer, int length) {
  (void)id;
  snprintf(buffer, (size_t)length, "nutmeg%d", i);
}
static void print(void* data, int mode, char* text) {
  (void)data;
  (void)mode;
  if (strlen(said) + strlen(text) < sizeof said) strcat(said, text);
}

static int solve(double* x) {
  struct Interface interface = {NULL, size, bounds, F, J, NULL, NULL, NULL, name, name, NULL};
  struct Output output = {NULL, print, NULL};
  void* options = path.Options_Create();
  void* mcp = path.MCP_Create(2, 2);
  int status;
  said[0] = '\0';
  path.Output_SetInterface(&output);
  path.Path_AddOptions(options);
  path.Options_Default(options);
  CHECK(path.Options_Set(options, "output yes") == 0);
  path.MCP_SetInterface(mcp, &interface);
  status = path.Path_Solve(mcp, NULL);
  memcpy(x, path.MCP_GetX(mcp), 2 * sizeof *x);
  path.MCP_Destroy(mcp);
  path.Options_Destroy(options);
  return status;
}

int main(int argc, char** argv) {
  double x[2];
  if (argc != 2) return EXIT_FAILURE;
  load_path(argv[1]);
  lower = 0; /* the start is moved inside */
  CHECK_SAYING(solve(x) == Solved, said);
  CHECK_NEAR(x[0], 2.718281828459045, 1e-7);
  CHECK_NEAR(x[1], 0.25, 1e-7);
  CHECK_SAYING(strstr(said, "the start was moved off the bounds") != NULL, said);
  lower = -1e20; /* no bound says where to */
  CHECK_SAYING(solve(x) == DomainError, said);
  CHECK_SAYING(strstr(said, "row nutmeg1 is NaN at the start, where nutmeg1 = 0") != NULL, said);
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
