// SPDX-License-Identifier: Apache-2.0
/* A client of PATH's library in C, with the structures of PATHSolver.jl: its Information ends at byte 96, seven bytes
   of one each where C has ints, and its MCP_Interface, Output_Interface and Presolve_Interface are pointers. The
   library is loaded as Julia loads it. Layouts from PATHSolver.jl's src/C_API.jl, numbers from PATH's public headers.
 */
#ifndef PERP_TESTS_PATH_CLIENT_H
#define PERP_TESTS_PATH_CLIENT_H

#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct Information {
  double residual, distance, steplength, total_time, basis_time, maximum_distance;
  int major_iterations, minor_iterations, crash_iterations, function_evaluations, jacobian_evaluations, gradient_steps,
      restarts, generate_output, generated_output;
  unsigned char forward, backtrace, gradient, use_start, use_basics, used_start, used_basics;
};

struct Interface {
  void* data;
  void (*size)(void*, int*, int*);
  void (*bounds)(void*, int, double*, double*, double*);
  int (*F)(void*, int, double*, double*);
  int (*J)(void*, int, double*, int, double*, int*, int*, int*, int*, double*);
  void* hessian;
  void (*start)(void*);
  void (*finish)(void*, double*);
  void (*variable_name)(void*, int, char*, int);
  void (*constraint_name)(void*, int, char*, int);
  void (*basis)(void*, int, int*);
};

struct Output {
  void* data;
  void (*print)(void*, int, char*);
  void* flush;
};

struct Presolve {
  void* data;
  void* start_pre;
  void* start_post;
  void* finish_pre;
  void* finish_post;
  void (*jac_typ)(void*, int, int*);
  void* con_typ;
};

static struct {
  int (*License_SetString)(const char*);
  void (*Output_SetInterface)(struct Output*);
  void* (*Options_Create)(void);
  void (*Options_Destroy)(void*);
  void (*Options_Default)(void*);
  void (*Options_Display)(void*);
  int (*Options_Read)(void*, const char*);
  int (*Options_Set)(void*, const char*);
  int (*Options_SetBoolean)(void*, const char*, int);
  int (*Options_SetInt)(void*, const char*, int);
  int (*Options_SetDouble)(void*, const char*, double);
  int (*Options_SetOther)(void*, const char*, int);
  int (*Options_GetBoolean)(void*, const char*);
  int (*Options_GetInt)(void*, const char*);
  double (*Options_GetDouble)(void*, const char*);
  void (*Path_AddOptions)(void*);
  int (*Path_CheckLicense)(int, int);
  const char* (*Path_Version)(void);
  int (*Path_Solve)(void*, void*);
  void* (*MCP_Create)(int, int);
  void (*MCP_Destroy)(void*);
  void (*MCP_SetInterface)(void*, struct Interface*);
  void (*MCP_SetPresolveInterface)(void*, struct Presolve*);
  void (*MCP_Jacobian_Structure_Constant)(void*, int);
  void (*MCP_Jacobian_Data_Contiguous)(void*, int);
  double* (*MCP_GetX)(void*);
  double* (*MCP_GetF)(void*);
  int* (*MCP_GetB)(void*);
  void (*Path_SetProblemClass)(void*, int);
  int (*License_GetRestrictions)(int*, int*);
} path;

static void find(void* library, const char* name, void* function) {
  void* found = dlsym(library, name);
  if (found == NULL) {
    fprintf(stderr, "%s\n", dlerror());
    exit(EXIT_FAILURE);
  }
  memcpy(function, &found, sizeof found); /* C99 has no cast for this */
}
#define FIND(name) find(library, #name, &path.name)

static void load_path(const char* file) {
  void* library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) {
    fprintf(stderr, "%s\n", dlerror());
    exit(EXIT_FAILURE);
  }
  FIND(License_SetString);
  FIND(Output_SetInterface);
  FIND(Options_Create);
  FIND(Options_Destroy);
  FIND(Options_Default);
  FIND(Options_Display);
  FIND(Options_Read);
  FIND(Options_Set);
  FIND(Options_SetBoolean);
  FIND(Options_SetInt);
  FIND(Options_SetDouble);
  FIND(Options_SetOther);
  FIND(Options_GetBoolean);
  FIND(Options_GetInt);
  FIND(Options_GetDouble);
  FIND(Path_AddOptions);
  FIND(Path_CheckLicense);
  FIND(Path_Version);
  FIND(Path_Solve);
  FIND(MCP_Create);
  FIND(MCP_Destroy);
  FIND(MCP_SetInterface);
  FIND(MCP_SetPresolveInterface);
  FIND(MCP_Jacobian_Structure_Constant);
  FIND(MCP_Jacobian_Data_Contiguous);
  FIND(MCP_GetX);
  FIND(MCP_GetF);
  FIND(MCP_GetB);
  FIND(Path_SetProblemClass);
  FIND(License_GetRestrictions);
}

#endif
