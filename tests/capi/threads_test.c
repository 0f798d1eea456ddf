// SPDX-License-Identifier: Apache-2.0
/* 8 threads, 200 solves each (capi/perp.h): would catch state that threads share, and results that depend on what ran
   before. Every thread's k-th result must be the first thread's to the bit but for times. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdlib.h>

#include "check.h"
#include "helpers.h"
#include "kojima.h"

enum { threads = 8, solves = 200 };

struct Record {
  double x[4];
  double F[4];
  double residual;
  double statistics[32];
  int32_t status;
  char message[256];
};

static struct Record records[threads][solves];

/* A time? */
static int timed(const char* name) { return strlen(name) > 2 && strcmp(name + strlen(name) - 2, "_s") == 0; }

static void record(const perp_result* result, struct Record* out) {
  int64_t i;
  const perp_result* stats = perp_result_part(result, "stats", 0);
  out->status = perp_result_status(result);
  out->residual = perp_result_real(result, "residual");
  memcpy(out->x, perp_result_reals(result, "x"), sizeof out->x);
  memcpy(out->F, perp_result_reals(result, "F"), sizeof out->F);
  strncpy(out->message, perp_result_text(result, "message", 0), sizeof out->message - 1);
  for (i = 0; perp_result_key(stats, i) != NULL && i < 32; ++i)
    if (!timed(perp_result_key(stats, i))) out->statistics[i] = perp_result_real(stats, perp_result_key(stats, i));
  CHECK(i > 10 && i < 32);
}

static void* run(void* argument) {
  static const char* const methods[] = {"auto",     "path",    "semismooth", "smooth",
                                        "interior", "josephy", "qpcomp",     "proxi"};
  struct Record* mine = argument;
  int k;
  for (k = 0; k < solves; ++k) {
    perp_problem* problem = NULL;
    perp_solver* solver = NULL;
    perp_result* result = NULL;
    const double x0[] = {k % 7, k % 5, k % 3, k % 2};
    perp_problem_create(PERP_INTERFACE, kojima_n, NULL, NULL, &kojima_pattern, kojima_F, kojima_J, NULL, &problem,
                        NULL);
    perp_solver_create(PERP_INTERFACE, &solver, NULL);
    perp_solver_set(solver, "method", methods[k % 8], NULL);
    if (perp_solve(solver, problem, x0, &result, NULL) == PERP_OK) record(result, &mine[k]);
    perp_result_free(result);
    perp_solver_free(solver);
    perp_problem_free(problem);
  }
  return NULL;
}

int main(void) {
  pthread_t thread[threads];
  int t, k, solved = 0;
  for (t = 0; t < threads; ++t) CHECK(pthread_create(&thread[t], NULL, run, records[t]) == 0);
  for (t = 0; t < threads; ++t) CHECK(pthread_join(thread[t], NULL) == 0);
  for (t = 0; t < threads; ++t)
    for (k = 0; k < solves; ++k) {
      CHECK(memcmp(&records[t][k], &records[0][k], sizeof(struct Record)) == 0);
      if (records[t][k].status == PERP_SOLVED && kojima_solved(records[t][k].x)) ++solved;
    }
  CHECK(solved >= threads * solves * 9 / 10);
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
