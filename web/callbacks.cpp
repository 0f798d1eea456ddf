// SPDX-License-Identifier: Apache-2.0
/// The callbacks of perp.h as imports of the module: JavaScript knows them by the number that is their `user`.
#include "capi/perp.h"

#define PERP_IMPORT(name) __attribute__((import_module("perp"), import_name(name)))
#define PERP_EXPORT __attribute__((visibility("default"), used))

extern "C" {

PERP_IMPORT("F") int32_t perp_web_import_F(int32_t n, const double* x, double* F, int32_t user);
PERP_IMPORT("J") int32_t perp_web_import_J(int32_t nonzeros, const double* x, double* value, int32_t user);
PERP_IMPORT("log") void perp_web_import_log(const char* line, int32_t user);

static int32_t call_F(int64_t n, const double* x, double* F, void* user) {
  return perp_web_import_F(static_cast<int32_t>(n), x, F, static_cast<int32_t>(reinterpret_cast<intptr_t>(user)));
}

static int32_t call_J(int64_t, int64_t nonzeros, const double* x, double* value, void* user) {
  return perp_web_import_J(static_cast<int32_t>(nonzeros), x, value,
                           static_cast<int32_t>(reinterpret_cast<intptr_t>(user)));
}

static void call_log(const char* line, void* user) {
  perp_web_import_log(line, static_cast<int32_t>(reinterpret_cast<intptr_t>(user)));
}

/// Functions that a client gives to perp_problem_create() and perp_solver_set_log().
PERP_EXPORT perp_F perp_web_F() { return call_F; }
PERP_EXPORT perp_J perp_web_J() { return call_J; }
PERP_EXPORT perp_log perp_web_log() { return call_log; }
}
