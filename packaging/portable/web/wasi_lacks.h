/* SPDX-License-Identifier: Apache-2.0 */
/* What AMPL's solver library uses and WASI has not: processes, and the time of the processor. */
#pragma once
#include <stdio.h>

static inline FILE* popen(const char* command, const char* mode) { return 0; }
static inline int pclose(FILE* stream) { return -1; }
static inline char* tempnam(const char* folder, const char* prefix) { return 0; }
#define NO_RUSAGE
