// SPDX-License-Identifier: Apache-2.0
/* Checks of the C tests: a failed one is printed with its place, and ends the test with status 1 at its end. */
#ifndef PERP_TESTS_CHECK_H
#define PERP_TESTS_CHECK_H

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failed_checks = 0;

static void check_that(int holds, const char* what, const char* file, int line, const char* words) {
  if (holds) return;
  ++failed_checks;
  fprintf(stderr, "%s:%d: not so: %s%s%s\n", file, line, what, words[0] != '\0' ? "; said: " : "", words);
}

#define CHECK(condition) check_that((condition) != 0, #condition, __FILE__, __LINE__, "")
#define CHECK_SAYING(condition, words) check_that((condition) != 0, #condition, __FILE__, __LINE__, words)
#define CHECK_NEAR(a, b, tolerance) CHECK(fabs((a) - (b)) <= (tolerance))
/* The call succeeds. */
#define OK(call) CHECK_SAYING((call) == PERP_OK, error.message)
/* The call fails with this code, and words in which this is said. */
#define REFUSED(call, wanted, said)                                            \
  do {                                                                         \
    memset(&error, 0, sizeof error);                                           \
    CHECK_SAYING((call) == (wanted) && error.code == (wanted), error.message); \
    CHECK_SAYING(strstr(error.message, (said)) != NULL, error.message);        \
  } while (0)

#endif
