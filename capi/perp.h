/* SPDX-License-Identifier: Apache-2.0 */
/** Perp from C: mixed complementarity problems, affine ones, and contact with friction.
 *
 *  MCP(l, u, F): find x in [l, u], n entries, such that for every i
 *      l_i < x_i < u_i  =>  F_i(x)  = 0
 *      x_i = l_i        =>  F_i(x) >= 0        (free if l_i = u_i)
 *      x_i = u_i        =>  F_i(x) <= 0.
 *
 *  Handles. A problem, a solver, a result and a contact problem are opaque: a function makes them, a function frees
 *  them (NULL is allowed there), and one thread at a time uses each. Different handles may be used by different threads
 *  at once; the library has no global state. perp_solver_interrupt() alone may be called from any thread and from a
 *  signal handler. Arguments are copied: the caller's arrays may go when the function returns.
 *
 *  Errors. A function that can fail returns a code, PERP_OK or why it failed, and takes a perp_error, which may be
 * NULL, for the same in words; they begin with the name of the argument. What it should have made is then NULL.
 * Problems that are sound but unsolved are no error: the result has a status.
 *
 *  Numbers. Sizes are int64_t, n and the number of nonzeros at most 2^31 - 2. Index arrays come in both widths, and the
 *  functions that take them end in _int32 or _int64. Indices begin at 0, in messages at 1. Infinite bounds are
 *  INFINITY. Matrices are stored by columns: column j has the entries start[j] .. start[j+1] - 1 of row and value,
 *  in any order, each place once; start has one entry more than there are columns, and start[0] = 0.
 *
 *  Callbacks get the `user` pointer given with them. They must return: no longjmp, no exceptions (an exception of C++
 * is caught, and is an error). They must not use the handles of the solve that they are called in but for
 *  perp_solver_interrupt().
 *
 *  Versions. PERP_INTERFACE is 1000 major + minor. Functions are added with a new minor number; whatever else changes
 *  the meaning of a program that has been compiled raises the major number, which is the number in the library's
 * SONAME. Functions that make handles get PERP_INTERFACE as first argument and refuse another major number, and a minor
 *  number above their own.
 */
#ifndef PERP_H
#define PERP_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PERP_INTERFACE 1000
/** PERP_INTERFACE of the library that runs. */
int32_t perp_interface(void);
/** Version of the library that runs, "0.1.0". */
const char* perp_version(void);

/* Errors. */

enum perp_code {
  PERP_OK = 0,
  PERP_BAD_ARGUMENT = 1, /**< null where it must not be, wrong sizes, no box, a value that is not finite */
  PERP_BAD_OPTION = 2,   /**< no such option, or a value out of its range */
  PERP_BAD_FILE = 3,     /**< cannot be read, or says what makes no sense: file, line and reason */
  PERP_BAD_CALLBACK = 4, /**< a callback returned what it must not, left values unset, or threw */
  PERP_OUT_OF_MEMORY = 5,
  PERP_BAD_INTERFACE = 6, /**< program and library are of different versions */
  PERP_INTERNAL = 7       /**< a mistake of the library's own */
};
/** "ok", "bad argument", ...; "?" for other numbers. */
const char* perp_code_name(int32_t code);

typedef struct perp_error {
  int32_t code;       /**< perp_code */
  char message[1020]; /**< ends in "..." where it was cut off */
} perp_error;

/** How a solve ended. */
enum perp_status {
  PERP_SOLVED = 0,             /**< the natural residual is at most the tolerance */
  PERP_SOLVED_TO_ROUNDING = 1, /**< it is not, but in every row it is within the rounding of the row's terms */
  PERP_INFEASIBLE = 2,         /**< proven to have no solution */
  PERP_STATIONARY_POINT = 3,   /**< the gradient of the merit function vanished, the residual did not */
  PERP_NO_PROGRESS = 4,        /**< steps became too short to change x */
  PERP_STALLED = 5,            /**< no progress short of the tolerance: a cycle, a stationary point, rounding */
  PERP_RAY = 6,                /**< a pivoting method's path went off along a ray */
  PERP_UNBOUNDED = 7,          /**< the iterates ran off to infinity */
  PERP_SINGULAR = 8,           /**< a matrix the method has to factor is singular */
  PERP_LINEAR_ALGEBRA_FAILED = 9,
  PERP_SUBPROBLEM_FAILED = 10, /**< the linearised problem could not be solved, however regularised */
  PERP_EVALUATION_FAILED = 11, /**< F or J is not defined at the start, or at every point tried */
  PERP_NOT_APPLICABLE = 12,    /**< the problem is outside what the method is defined for */
  PERP_ITERATION_LIMIT = 13,
  PERP_TIME_LIMIT = 14,
  PERP_INTERRUPTED = 15, /**< somebody asked to stop */
  PERP_NO_MEMORY = 16    /**< something of the method's did not fit */
};
/** "Solved", "SolvedToRounding", ...; "?" for other numbers. */
const char* perp_status_name(int32_t status);

/* Problems. */

typedef struct perp_problem perp_problem;

/** What F and J return. Other numbers are errors. */
enum perp_evaluation {
  PERP_DEFINED = 0,
  PERP_UNDEFINED = 1, /**< not defined at x: a logarithm of a negative number, say. So is a NaN or an infinity */
  PERP_STOP = 2       /**< end the solve, as PERP_INTERRUPTED */
};
/** F[i] = F_i(x): x and F have n entries, and all of F must be set. */
typedef int32_t (*perp_F)(int64_t n, const double* x, double* F, void* user);
/** value[k] = dF_i/dx_j of entry k of the pattern, in the order in which the pattern was given; all must be set. */
typedef int32_t (*perp_J)(int64_t n, int64_t nonzeros, const double* x, double* value, void* user);

/** The problem of functions F and J = F'. `start` and `row` are the pattern of J, n x n: every entry that can be
 * nonzero. lower NULL is 0 everywhere, upper NULL is +infinity. */
int32_t perp_problem_create_int32(int32_t interface_, int64_t n, const double* lower, const double* upper,
                                  const int32_t* start, const int32_t* row, perp_F F, perp_J J, void* user,
                                  perp_problem** problem, perp_error* error);
int32_t perp_problem_create_int64(int32_t interface_, int64_t n, const double* lower, const double* upper,
                                  const int64_t* start, const int64_t* row, perp_F F, perp_J J, void* user,
                                  perp_problem** problem, perp_error* error);

/** The affine problem F(x) = M x + q, M n x n and finite, q with n entries. Bounds as above: with both NULL it is the
 *  linear complementarity problem 0 <= x _|_ M x + q >= 0. */
int32_t perp_problem_affine_int32(int32_t interface_, int64_t n, const int32_t* start, const int32_t* row,
                                  const double* value, const double* q, const double* lower, const double* upper,
                                  perp_problem** problem, perp_error* error);
int32_t perp_problem_affine_int64(int32_t interface_, int64_t n, const int64_t* start, const int64_t* row,
                                  const double* value, const double* q, const double* lower, const double* upper,
                                  perp_problem** problem, perp_error* error);

/** The complementarity problem of an .nl file, with or without ".nl", with its names and its start. */
int32_t perp_problem_read_nl(int32_t interface_, const char* path, perp_problem** problem, perp_error* error);

void perp_problem_free(perp_problem* problem);

/** n; 0 of NULL. Models read from files have a variable more for each side inequality, after their own. */
int64_t perp_problem_size(const perp_problem* problem);
/** Entries of the pattern of J; 0 of NULL. */
int64_t perp_problem_nonzeros(const perp_problem* problem);
/** Copies n bounds each; either array may be NULL. */
int32_t perp_problem_bounds(const perp_problem* problem, double* lower, double* upper, perp_error* error);
/** The problem's own start, n entries: of a file its initial guess, else 0 moved into the box. */
int32_t perp_problem_start(const perp_problem* problem, double* x, perp_error* error);

/** For messages and the log. */
int32_t perp_problem_set_name(perp_problem* problem, const char* name, perp_error* error);
/** n names each, or NULL: "x[1]" and "F[1]". Not for files, which bring their own. */
int32_t perp_problem_set_names(perp_problem* problem, const char* const* variables, const char* const* equations,
                               perp_error* error);
/** Copies the name of variable i, at most size - 1 characters of it and a NUL. */
int32_t perp_problem_variable_name(const perp_problem* problem, int64_t i, char* name, int64_t size, perp_error* error);
int32_t perp_problem_equation_name(const perp_problem* problem, int64_t i, char* name, int64_t size, perp_error* error);
/** Which entries of J are constant, a flag for each, in the order of the pattern as given: presolve uses them. The flag
 *  of (i, j) promises that F_i(x) - J_ij x_j does not depend on x_j. If all are set F is taken as affine, and the
 *  methods for affine problems apply. NULL: none. Only for problems of functions. */
int32_t perp_problem_set_linear(perp_problem* problem, const int8_t* linear, perp_error* error);

/** The judge's word on x: natural = || x - mid(l, x - F(x), u) ||_inf, which is zero exactly at solutions, and the row
 *  where it is largest (-1: none). +infinity where F is not defined. Either may be NULL. */
int32_t perp_problem_residual(const perp_problem* problem, const double* x, double* natural, int64_t* worst,
                              perp_error* error);
/** Compares J with differences of F at x: the largest |J_ij - D_ij| / max(1, |J_ij|, |D_ij|), and its place. Any of the
 *  three may be NULL. At least 2 n evaluations of F. */
int32_t perp_problem_check_jacobian(const perp_problem* problem, const double* x, double* worst, int64_t* row,
                                    int64_t* column, perp_error* error);

/* Solvers: options and what goes with them. */

typedef struct perp_solver perp_solver;

int32_t perp_solver_create(int32_t interface_, perp_solver** solver, perp_error* error);
void perp_solver_free(perp_solver* solver);

/** Sets an option by its name, as `perp methods` lists them: ("method", "path"), ("convergence_tolerance", "1e-10"),
 *  ("time_limit", "60"). A key may be shortened as long as it is unique. Of several settings of one key the last
 *  one holds. On failure the options are as before. */
int32_t perp_solver_set(perp_solver* solver, const char* key, const char* value, perp_error* error);
/** The same of a file, a line `key value` or `key = value` for each. */
int32_t perp_solver_read_options(perp_solver* solver, const char* path, perp_error* error);
/** Forgets all that was set. */
int32_t perp_solver_clear_options(perp_solver* solver, perp_error* error);
/** Copies the value in force, at most size - 1 characters and a NUL: "yes", "1e-08", "-" where the method has no such
 *  option. */
int32_t perp_solver_get(const perp_solver* solver, const char* key, char* value, int64_t size, perp_error* error);
/** What is said of the options in force (without effect, taken as another), a line each; NULL: there are no more. */
const char* perp_solver_note(const perp_solver* solver, int64_t i);

/** All options there are: how many, and of each its key, meaning and range; NULL beyond. */
int64_t perp_option_count(void);
const char* perp_option_key(int64_t i);
const char* perp_option_help(int64_t i);
const char* perp_option_takes(int64_t i);

/** Where a variable lies in a basis: beyond its lower bound (nonbasic), inside (basic), beyond its upper bound, fixed.
 */
enum perp_cell { PERP_BELOW = 0, PERP_INSIDE = 1, PERP_ABOVE = 2, PERP_FIXED = 3 };
/** A warm basis, as perp_result_basis() gives it, of a nearby problem of n variables: methods auto and path begin with
 *  it. NULL: none any more. */
int32_t perp_solver_set_basis(perp_solver* solver, int64_t n, const int8_t* cells, perp_error* error);

/** A line of the log, without its newline. */
typedef void (*perp_log)(const char* line, void* user);
/** The options output_... say what is logged. NULL: no log. */
int32_t perp_solver_set_log(perp_solver* solver, perp_log log, void* user, perp_error* error);

/** An iteration, valid during the call only. Later versions add members at the end: struct_size says how many there
 * are. */
typedef struct perp_iteration {
  int64_t struct_size;
  int64_t k;           /**< 0 is the start */
  double residual;     /**< natural residual of the iterate in the box */
  int64_t worst;       /**< row where it is largest; -1: none */
  double merit;        /**< the method's own merit function */
  double step;         /**< step length in (0, 1]; 0 at the start */
  double prox;         /**< proximal or Levenberg-Marquardt parameter; 0 if none */
  double mu;           /**< parameter of smoothing and interior points */
  int64_t pivots;      /**< of this iteration */
  int64_t backtracks;  /**< of this iteration */
  int64_t F_evals;     /**< so far */
  int64_t J_evals;     /**< so far */
  char kind;           /**< of step: the letter in the log */
  char linear;         /**< how the linearised problem was solved: the letter in the log */
  char crash;          /**< 1: a step of the crash, which is no major iteration */
  const char* attempt; /**< begun with this iteration, after the first: "no crash"; "" otherwise */
  int64_t n;
  const double* x; /**< the iterate in the box, n entries; NULL where it belongs to a presolved or scaled problem */
} perp_iteration;
/** 0 goes on, anything else ends the solve as PERP_INTERRUPTED. */
typedef int32_t (*perp_progress)(const perp_iteration* iteration, void* user);
int32_t perp_solver_set_progress(perp_solver* solver, perp_progress progress, void* user, perp_error* error);

/** Ends the solve that runs, or the next one, as PERP_INTERRUPTED, at its best point. From any thread, and from signal
 *  handlers. */
void perp_solver_interrupt(perp_solver* solver);

/* Solving. */

typedef struct perp_result perp_result;

/** Solves the problem from x0, n entries (NULL: the problem's own start), moved into the box first. solver NULL: all as
 *  usual. The result is to be freed. */
int32_t perp_solve(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                   perp_error* error);

/** 0 <= x _|_ M x + q >= 0 with the usual options: perp_problem_affine_... and perp_solve in one. */
int32_t perp_lcp_int32(int32_t interface_, int64_t n, const int32_t* start, const int32_t* row, const double* value,
                       const double* q, perp_result** result, perp_error* error);
int32_t perp_lcp_int64(int32_t interface_, int64_t n, const int64_t* start, const int64_t* row, const double* value,
                       const double* q, perp_result** result, perp_error* error);

void perp_result_free(perp_result* result);

/* Of a result; what they point to lives as long as it does. */
int32_t perp_result_status(const perp_result* result);      /**< perp_status */
int32_t perp_result_solved(const perp_result* result);      /**< 1: PERP_SOLVED */
const char* perp_result_message(const perp_result* result); /**< what happened, with names and values */
const char* perp_result_advice(const perp_result* result);  /**< what to try; "" if solved */
int64_t perp_result_size(const perp_result* result);        /**< n */
const double* perp_result_x(const perp_result* result);     /**< the best point met, in the box */
const double* perp_result_F(const perp_result* result);     /**< F there */
double perp_result_residual(const perp_result* result);     /**< the natural residual of x, by the judge */
int64_t perp_result_worst(const perp_result* result);       /**< the row where it is largest; -1: none */
/** The largest residual of a row beside the terms it is the rest of, and that row; NaN and -1 where J is not defined.
 */
double perp_result_relative(const perp_result* result);
int64_t perp_result_relative_row(const perp_result* result);
/** What a solution to the tolerance leaves to be said, a sentence each; NULL: there are no more. */
const char* perp_result_note(const perp_result* result, int64_t i);
/** With option verify: the largest r such that exactly one solution y has |y_i - x_i| <= r_i, r_i <= r, by a proof in
 *  interval arithmetic. NaN where nothing was proven; a note says why. For files and affine problems. */
double perp_result_verified_radius(const perp_result* result);
/** n perp_cells of the last linearised problem solved; NULL where the method has none. */
const int8_t* perp_result_basis(const perp_result* result);
/** "iterations", "F_evals", "pivots", ..., "time_s" (seconds). */
int32_t perp_result_statistic(const perp_result* result, const char* name, double* value, perp_error* error);
/** The names; NULL beyond the last. */
const char* perp_statistic_name(int64_t i);

/* Contact with Coulomb friction: u = W r + q, K*_mu > u + mu |u_T| e_N _|_ r in K_mu, contact by contact. Block a of r,
 * u, q has d = dimension entries, the normal one first. Impulses r [N s], velocities u [m/s]. */

typedef struct perp_contact perp_contact;

/** W d n x d n [1/kg], q d n [m/s], mu n coefficients >= 0, n = contacts, d = 2 or 3. */
int32_t perp_contact_create_int32(int32_t interface_, int32_t dimension, int64_t contacts, const int32_t* W_start,
                                  const int32_t* W_row, const double* W_value, const double* q, const double* mu,
                                  perp_contact** contact, perp_error* error);
int32_t perp_contact_create_int64(int32_t interface_, int32_t dimension, int64_t contacts, const int64_t* W_start,
                                  const int64_t* W_row, const double* W_value, const double* q, const double* mu,
                                  perp_contact** contact, perp_error* error);
/** Of the bodies' velocities v, m entries: M v = H r + f, u = H' v + w. M m x m [kg], positive definite, H m x d n,
 *  f m [N s], w d n [m/s]. W = H' M^-1 H, q = H' M^-1 f + w. */
int32_t perp_contact_condense_int32(int32_t interface_, int32_t dimension, int64_t contacts, int64_t m,
                                    const int32_t* M_start, const int32_t* M_row, const double* M_value,
                                    const int32_t* H_start, const int32_t* H_row, const double* H_value,
                                    const double* f, const double* w, const double* mu, perp_contact** contact,
                                    perp_error* error);
int32_t perp_contact_condense_int64(int32_t interface_, int32_t dimension, int64_t contacts, int64_t m,
                                    const int64_t* M_start, const int64_t* M_row, const double* M_value,
                                    const int64_t* H_start, const int64_t* H_row, const double* H_value,
                                    const double* f, const double* w, const double* mu, perp_contact** contact,
                                    perp_error* error);
/** From a file: FCLIB's HDF5, or Siconos' text. */
int32_t perp_contact_read(int32_t interface_, const char* path, perp_contact** contact, perp_error* error);
void perp_contact_free(perp_contact* contact);

int32_t perp_contact_dimension(const perp_contact* contact); /**< 0 of NULL */
int64_t perp_contact_contacts(const perp_contact* contact);  /**< 0 of NULL */
const double* perp_contact_q(const perp_contact* contact);
const double* perp_contact_mu(const perp_contact* contact);
/** Whether impulses r, d n entries, solve the problem to `tolerance`, and the largest of the judge's measures. Either
 *  may be NULL. */
int32_t perp_contact_judge(const perp_contact* contact, const double* r, double tolerance, int32_t* accepted,
                           double* largest, perp_error* error);

typedef struct perp_contact_result perp_contact_result;

/** Solves by a law and a method in words, "glocker" (and NULL), "glocker+path", "inner:8+lemke", "frictionless":
 *  as `perp contact`. Of the solver (NULL: all as usual) it takes convergence_tolerance (1e-8), time_limit (30 s), the
 *  options of the method, and interruptions. */
int32_t perp_contact_solve(perp_solver* solver, const perp_contact* contact, const char* variant,
                           perp_contact_result** result, perp_error* error);
void perp_contact_result_free(perp_contact_result* result);

int32_t perp_contact_result_status(const perp_contact_result* result); /**< perp_status */
int32_t perp_contact_result_solved(const perp_contact_result* result); /**< 1: the variant's law is solved */
const char* perp_contact_result_message(const perp_contact_result* result);
const char* perp_contact_result_solved_by(const perp_contact_result* result); /**< the step that made the point; "" */
int64_t perp_contact_result_size(const perp_contact_result* result);          /**< d n */
const double* perp_contact_result_r(const perp_contact_result* result);
const double* perp_contact_result_u(const perp_contact_result* result);
enum perp_contact_state { PERP_OPEN = 0, PERP_STICK = 1, PERP_SLIP = 2 };
const int8_t* perp_contact_result_states(const perp_contact_result* result); /**< n perp_contact_states */
/** "natural", "siconos", "rr9118", "scaled", "cone", "normal", "slip", "largest": measures of Coulomb's law; "own", of
 *  other laws; "time_s"; what the method counted, "iterations" first. */
int32_t perp_contact_result_number(const perp_contact_result* result, const char* name, double* value,
                                   perp_error* error);

#ifdef __cplusplus
}
#endif

#endif
