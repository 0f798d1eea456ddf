/* SPDX-License-Identifier: Apache-2.0 */
/** The interface that clients of the PATH solver call, with Perp behind it: libperp_path.so. Programs written and
 * compiled for PATH's own headers run against it as they are; this header is for those who have none.
 * docs/path-library.md says in what it behaves otherwise.
 *
 *  The problem: l <= x <= u, F_i(x) >= 0 where x_i = l_i, <= 0 where x_i = u_i, = 0 between. 1e20 and beyond is
 * infinity.
 *
 *  Options, output and errors belong to the thread that set them, an MCP to whoever uses it, one thread at a time.
 *  Different threads solve different problems at once. Null pointers are refused, not followed.
 */
#ifndef PERP_PATH_H
#define PERP_PATH_H

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Problems. */

typedef struct _MCP MCP;

/** Callbacks of a problem; `id` is interface_data. F and J return the number of domain errors: not 0 is "not defined at
 * x". J is stored by columns: column j (from 1) has the len[j-1] entries of row and data that begin at col[j-1],
 * counted from 1; rows are counted from 1. The arrays are the same in every call and keep what is in them: a client may
 * fill in col, len and row once. */
typedef struct {
  void* interface_data;
  void (*problem_size)(void* id, int* n, int* nonzeros); /**< nonzeros: at least so many as J ever has */
  void (*bounds)(void* id, int n, double* x, double* lower,
                 double* upper); /**< start and bounds; come as 0, -1e20, 1e20 */
  int (*function_evaluation)(void* id, int n, double* x, double* F);
  int (*jacobian_evaluation)(void* id, int n, double* x, int want_F, double* F, int* nonzeros, int* col, int* len,
                             int* row, double* data);
  int (*hessian_evaluation)(void* id, int n, double* x, double* multipliers, int* nonzeros, int* col, int* len,
                            int* row, double* data); /**< never called */
  void (*start)(void* id);                           /**< may be null, like all that follow: before everything else */
  void (*finish)(void* id, double* x);               /**< at the end */
  void (*variable_name)(void* id, int i, char* name, int size); /**< i from 1 */
  void (*constraint_name)(void* id, int i, char* name, int size);
  void (*basis)(void* id, int n, int* basis); /**< where to begin: 0 unknown, 1 basic, 2 superbasic, 3 lower, 4 upper,
                                                   5 fixed */
} MCP_Interface;

/** What is known of the problem beforehand. */
typedef struct {
  void* presolve_data;
  void (*start_pre)(void* data);
  void (*start_post)(void* data);
  void (*finish_pre)(void* data);
  void (*finish_post)(void* data);
  void (*jac_typ)(void* data, int nonzeros, int* type); /**< of each entry of data: 0 linear, 1 (as it comes) not */
  void (*con_typ)(void* data, int n, int* type);        /**< never called */
} Presolve_Interface;

/** The sizes are only a hint. */
MCP* MCP_Create(int n, int nonzeros);
void MCP_Destroy(MCP* m);
void MCP_Size(MCP* m, int n, int nonzeros);
void MCP_SetInterface(MCP* m, MCP_Interface* i);
void MCP_SetPresolveInterface(MCP* m, Presolve_Interface* i);
/** Promises that are not needed here, and not believed. */
void MCP_Jacobian_Structure_Constant(MCP* m, int yes);
void MCP_Jacobian_Data_Contiguous(MCP* m, int yes);
void MCP_Jacobian_Diagonal(MCP* m, int yes);
void MCP_Jacobian_Diagonal_First(MCP* m, int yes);
/** The last solve's point, bounds, F and basis; they live until the next solve. NULL before the first. */
double* MCP_GetX(MCP* m);
double* MCP_GetL(MCP* m);
double* MCP_GetU(MCP* m);
double* MCP_GetF(MCP* m);
int* MCP_GetB(MCP* m);
/** The Jacobian last evaluated. */
void MCP_GetJ(MCP* m, int* nonzeros, int** col, int** len, int** row, double** data);

/* Solving. */

typedef enum { MCP_MCP, MCP_LCP, MCP_NLP, MCP_QP, MCP_LP, MCP_CNS, MCP_MPSGE } MCP_Type;

typedef enum {
  MCP_Solved = 1,
  MCP_NoProgress = 2, /**< also: solved to rounding, but not to the tolerance */
  MCP_MajorIterationLimit = 3,
  MCP_MinorIterationLimit = 4,
  MCP_TimeLimit = 5,
  MCP_UserInterrupt = 6,
  MCP_BoundError = 7,
  MCP_DomainError = 8,
  MCP_Infeasible = 9,
  MCP_Error = 10,
  MCP_Reduced = 11,      /**< never answered */
  MCP_LicenseError = 12, /**< never answered */
  MCP_OK = 13            /**< never answered */
} MCP_Termination;

/** From byte 84 on nothing is read or written: PATHSolver.jl's structure ends at byte 96. */
typedef struct {
  double residual;         /**< natural residual of x, by the judge */
  double distance;         /**< || x - start ||_2 */
  double steplength;       /**< of the last iteration */
  double total_time;       /**< s */
  double basis_time;       /**< s, in linearised problems */
  double maximum_distance; /**< left as it is */
  int major_iterations;
  int minor_iterations;
  int crash_iterations;
  int function_evaluations;
  int jacobian_evaluations;
  int gradient_steps;
  int restarts;
  int generate_output;  /**< bits of Output_...: how the run ended, and the residuals, are told to the log */
  int generated_output; /**< bits of what was told */
  int forward;
  int backtrace;
  int gradient;
  int use_start;
  int use_basics;
  int used_start;
  int used_basics;
} Information;

/** Solves from the start that bounds() gives, and from the basis that basis() gives. information may be null. */
MCP_Termination Path_Solve(MCP* m, Information* information);
/** MCP_LCP, MCP_QP and MCP_LP promise that F is affine. */
void Path_SetProblemClass(MCP* m, MCP_Type type);
/** "Path d.d.dd", and what it really is. */
const char* Path_Version(void);
/** Nothing: there is no workspace to make beforehand. */
void Path_Create(int n, int nonzeros);
void Path_Size(int n, int nonzeros);
void Path_Reference(void);
void Path_Destroy(void);

/* Options: PATH's names and ours. A function that sets answers 0, or 1 where it could not, with a warning. */

typedef struct _Options_Interface Options_Interface;

Options_Interface* Options_Create(void);
void Options_Destroy(Options_Interface* o);
void Path_AddOptions(Options_Interface* o); /**< nothing: they are there */
void Options_Default(const Options_Interface* o);
/** To the log, if output_options is on. */
void Options_Display(const Options_Interface* o);
/** Lines "key value"; lines that make no sense are told, and left out. */
int Options_Read(const Options_Interface* o, const char* file);
int Options_Set(const Options_Interface* o, const char* key_and_value);
int Options_SetBoolean(const Options_Interface* o, const char* key, int value);
int Options_SetInt(const Options_Interface* o, const char* key, int value);
int Options_SetDouble(const Options_Interface* o, const char* key, double value);
int Options_SetOther(const Options_Interface* o, const char* key, int value); /**< 1: words have no numbers here */
/** 0 where there is no such option. */
int Options_GetBoolean(const Options_Interface* o, const char* key);
int Options_GetInt(const Options_Interface* o, const char* key);
double Options_GetDouble(const Options_Interface* o, const char* key);
int Options_GetOther(const Options_Interface* o, const char* key);

/* Output. Without an interface and without files there is none. */

#define Output_Log (1 << 0)
#define Output_Status (1 << 1)
#define Output_Listing (1 << 2)

typedef struct {
  void* output_data;
  void (*print)(void* data, int mode, char* text);
  void (*flush)(void* data, int mode); /**< may be null */
} Output_Interface;

void Output_SetInterface(Output_Interface* i);
void Output_Default(void);
void Output_SetLog(FILE* file);
void Output_SetStatus(FILE* file);
void Output_SetListing(FILE* file);
void Output_Printf(int mode, const char* format, ...);
void Output_Flush(int mode);

/* Errors, memory. */

typedef struct {
  void* error_data;
  void (*error)(void* data, char* text); /**< never called: nothing here ends a program */
  void (*warning)(void* data, char* text);
} Error_Interface;
void Error_SetInterface(Error_Interface* i);

void* Memory_Allocate(unsigned long bytes);
void Memory_Free(void* memory);

/* Licences: none is needed. */

/** 0, and 4 for "bad_license". */
int License_SetString(const char* licence);
int Path_CheckLicense(int n, int nonzeros); /**< 1 */
int License_GetAlgorithms(char* text, int size);
int License_GetArchitectures(char* text, int size);
int License_GetExpiration(int* day, int* month, int* year);
int License_GetMaxVersion(int* version);
int License_GetMaxBuild(int* day, int* month, int* year);
int License_GetRestrictions(int* n, int* nonzeros);
int License_GetDemoRestrictions(int* n, int* nonzeros);
int License_GetTermination(void);
int License_GetDemoTermination(void);

#ifdef __cplusplus
}
#endif

#endif
