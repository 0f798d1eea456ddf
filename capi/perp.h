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
 *  signal handler. Arguments are copied: the caller's arrays may go when the function returns. A matrix that is lent
 *  (perp_matrix) stays.
 *
 *  Errors. A function that can fail returns a code, PERP_OK or why it failed, and takes a perp_error, which may be
 * NULL, for the same in words; they begin with the name of the argument. What it should have made is then NULL.
 * Problems that are sound but unsolved are no error: the result has a status.
 *
 *  Numbers. Sizes are int64_t, n and the number of nonzeros at most 2^31 - 2. Indices begin at 0, in messages, too:
 * "x0: entry [3] is nan". Infinite bounds are INFINITY.
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
/** Version of the library that runs, "1.0.0". */
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
  PERP_NO_MEMORY = 16    /**< of the program alone: perp_solve() returns PERP_OUT_OF_MEMORY */
};
/** "Solved", "SolvedToRounding", ...; "?" for other numbers. */
const char* perp_status_name(int32_t status);

/* Matrices. */

/** How a matrix is stored, and how wide its indices are. */
enum perp_form {
  PERP_COLUMNS_INT32 = 0, /**< by columns (CSC): column j has the entries start[j] .. start[j+1] - 1 */
  PERP_COLUMNS_INT64 = 1,
  PERP_ROWS_INT32 = 2, /**< by rows (CSR) */
  PERP_ROWS_INT64 = 3,
  PERP_DENSE_COLUMNS = 4, /**< column after column; start and index are NULL */
  PERP_DENSE_ROWS = 5
};
/** A matrix of the caller's. start has one entry more than there are columns (rows), and start[0] = 0. The entries of a
 *  column (row) may come in any order. The values of a place that is given twice are added. */
typedef struct perp_matrix {
  int32_t form;        /**< perp_form */
  int32_t lent;        /**< 1: the arrays stay, unchanged, as long as what is made of them: they need not be copied */
  int64_t rows;        /**< number of rows */
  int64_t columns;     /**< number of columns */
  const void* start;   /**< int32_t or int64_t */
  const void* index;   /**< row of each entry; by rows its column */
  const double* value; /**< NULL in a pattern */
} perp_matrix;

/* Problems. */

typedef struct perp_problem perp_problem;
typedef struct perp_result perp_result;

/** What F and J return. Other numbers are errors. */
enum perp_evaluation {
  PERP_DEFINED = 0,
  PERP_UNDEFINED = 1, /**< not defined at x: a logarithm of a negative number, say. So is a NaN or an infinity */
  PERP_STOP = 2       /**< end the solve, as PERP_INTERRUPTED */
};
/** F[i] = F_i(x): x and F have n entries, and all of F must be set. x, F and value lie at the same places in every call
 *  for one problem. */
typedef int32_t (*perp_F)(int64_t n, const double* x, double* F, void* user);
/** value[k] = dF_i/dx_j of entry k of the pattern, in the order in which the pattern was given; all must be set. */
typedef int32_t (*perp_J)(int64_t n, int64_t nonzeros, const double* x, double* value, void* user);

/** The problem of functions F and J = F'. The pattern of J, n x n, has every entry that can be nonzero, each place
 * once; NULL: all of them, dense by columns. lower NULL is 0 everywhere, upper NULL is +infinity. J NULL: by
 * differences of F, one evaluation for each group of columns that share no row (Curtis, Powell & Reid 1974); see the
 * statistics J_colours and J_F_evals. */
int32_t perp_problem_create(int32_t interface_, int64_t n, const double* lower, const double* upper,
                            const perp_matrix* pattern, perp_F F, perp_J J, void* user, perp_problem** problem,
                            perp_error* error);

/** The affine problem F(x) = M x + q, M n x n and finite, q with n entries. Bounds as above: with both NULL it is the
 *  linear complementarity problem 0 <= x _|_ M x + q >= 0. An M that is lent is used where it is if it is stored by
 *  columns with indices of 32 bits, rows ascending. */
int32_t perp_problem_affine(int32_t interface_, const perp_matrix* M, const double* q, const double* lower,
                            const double* upper, perp_problem** problem, perp_error* error);

/** The complementarity problem of an .nl file, with or without ".nl", with its names and its start. */
int32_t perp_problem_read_nl(int32_t interface_, const char* path, perp_problem** problem, perp_error* error);
/** The affine problem of Matrix Market files of M and q; of lower and upper, or NULL for 0 and +infinity. */
int32_t perp_problem_read_matrix(int32_t interface_, const char* M, const char* q, const char* lower, const char* upper,
                                 perp_problem** problem, perp_error* error);
/** A problem of the collection: "josephy", or of a family in any size, "obstacle:50x50". perp_list() names them. */
int32_t perp_problem_collection(int32_t interface_, const char* name, perp_problem** problem, perp_error* error);

void perp_problem_free(perp_problem* problem);

/** n; 0 of NULL. Models read from files have a variable more for each side inequality, after their own. */
int64_t perp_problem_size(const perp_problem* problem);
/** Entries of the pattern of J; 0 of NULL. */
int64_t perp_problem_nonzeros(const perp_problem* problem);
/** 1: F is known to be affine. */
int32_t perp_problem_is_affine(const perp_problem* problem);
/** Copies n bounds each; either array may be NULL. */
int32_t perp_problem_bounds(const perp_problem* problem, double* lower, double* upper, perp_error* error);
/** How many starts the problem has: of the collection one or more, else 1. */
int64_t perp_problem_starts(const perp_problem* problem);
/** Start k, from 0, n entries: of a file its initial guess, of functions and matrices 0; moved into the box. */
int32_t perp_problem_start(const perp_problem* problem, int64_t k, double* x, perp_error* error);
/** The pattern of J in the library's own arrays, by columns with indices of 32 bits, rows ascending, without values.
 * They live as long as the problem. */
int32_t perp_problem_pattern(const perp_problem* problem, perp_matrix* pattern, perp_error* error);
/** F(x), n entries, and the values of J(x) in the order of perp_problem_pattern(). Either may be NULL. Where it is not
 *  defined, entries are NaN. */
int32_t perp_problem_evaluate(const perp_problem* problem, const double* x, double* F, double* J, perp_error* error);

/** For messages and the log; of a file or the collection it is known. */
int32_t perp_problem_set_name(perp_problem* problem, const char* name, perp_error* error);
/** The name, as long as the problem lives and has no other; "" of NULL. */
const char* perp_problem_name(const perp_problem* problem);
/** Where it is from: the file, or the source of a problem of the collection; "". */
const char* perp_problem_source(const perp_problem* problem);
/** n names each, or NULL: "x[0]" and "F[0]", or what perp_problem_count_from() says. Not for files, which bring their
 *  own. */
int32_t perp_problem_set_names(perp_problem* problem, const char* const* variables, const char* const* equations,
                               perp_error* error);
/** The number, 0 or 1, of the first variable and equation that have no name; 1 of files and of the collection. */
int32_t perp_problem_count_from(perp_problem* problem, int32_t first, perp_error* error);
/** Copies the name of variable i, at most size - 1 characters of it and a NUL. */
int32_t perp_problem_variable_name(const perp_problem* problem, int64_t i, char* name, int64_t size, perp_error* error);
int32_t perp_problem_equation_name(const perp_problem* problem, int64_t i, char* name, int64_t size, perp_error* error);
/** Which entries of J are constant, a flag for each, in the order of the pattern as given: presolve uses them. The flag
 *  of (i, j) promises that F_i(x) - J_ij x_j does not depend on x_j. If all are set F is taken as affine, and the
 *  methods for affine problems apply; PERP_BAD_CALLBACK then says where F or J breaks the promise at a point that is
 *  looked at, of which there are two at least. NULL: none. Only for problems of functions, with J. */
int32_t perp_problem_set_linear(perp_problem* problem, const int8_t* linear, perp_error* error);

/** The judge's word on x: natural = || x - mid(l, x - F(x), u) ||_inf, which is zero exactly at solutions, and the row
 *  where it is largest (-1: none). +infinity where F is not defined. Either may be NULL. */
int32_t perp_problem_residual(const perp_problem* problem, const double* x, double* natural, int64_t* worst,
                              perp_error* error);

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

/** An iteration. Later versions add members at the end: struct_size says how many there are. */
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
  int32_t kind;        /**< of step: the letter in the log, or 0 */
  int32_t linear;      /**< how the linearised problem was solved: the letter in the log, or 0 */
  int32_t crash;       /**< 1: a step of the crash, which is no major iteration */
  const char* attempt; /**< begun with this iteration, after the first: "no crash"; "" otherwise */
  int64_t n;
  const double* x; /**< the iterate in the box, n entries, during the call only; NULL where it belongs to a presolved or
                        scaled problem, and in a result */
} perp_iteration;
/** Called after each iteration. 0 goes on, anything else ends the solve as PERP_INTERRUPTED. */
typedef int32_t (*perp_progress)(const perp_iteration* iteration, void* user);
int32_t perp_solver_set_progress(perp_solver* solver, perp_progress progress, void* user, perp_error* error);

/** Ends the solve that runs, or the next one, as PERP_INTERRUPTED, at its best point. From any thread, and from signal
 *  handlers. */
void perp_solver_interrupt(perp_solver* solver);
/** on = 1: while a function works with this solver, SIGINT (Ctrl-C) does the same, and then what it did before; nothing
 *  where it is ignored or ends the process. A process has one handler of a signal: at one time, one thread may use such
 *  solvers, and a solve within a solve is the one that ends. */
int32_t perp_solver_heed_sigint(perp_solver* solver, int32_t on, perp_error* error);

/* Solving. Where a solver may be given, NULL stands for all as usual. Results are to be freed. */

/** Solves the problem from x0, n entries (NULL: the problem's own start), moved into the box first. */
int32_t perp_solve(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                   perp_error* error);
/** The same from the last solution that this solver has found in this way, as long as problems have the same pattern of
 *  J; x0 is for the first one, and where that fails. Much faster for neighbouring problems. Without log and progress.
 *  Setting an option forgets the last solution. */
int32_t perp_solve_kept(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                        perp_error* error);
/** Several solutions, up to so many: the first by the method from x0, the others by deflation. Nothing says that all
 * are found. */
int32_t perp_solve_all(perp_solver* solver, const perp_problem* problem, const double* x0, int64_t solutions,
                       perp_result** result, perp_error* error);

/** 0 <= x _|_ M x + q >= 0 with the usual options: perp_problem_affine() and perp_solve() in one. */
int32_t perp_lcp(int32_t interface_, const perp_matrix* M, const double* q, perp_result** result, perp_error* error);

/** The variational inequality over C = {lower <= A x <= upper, and the problem's bounds}: x in C with
 *  F(x)'(y - x) >= 0 for all y in C; A m x n, lower NULL is 0, upper NULL +infinity; equal sides make an equation.
 * Solved means that the natural residual || x - P(x - F(x)) ||_inf, P the projection on C, is at most the tolerance,
 * with a bound on P's error in it, and of affine F on that of F. Affine problems of up to 3000 rows and variables are
 * solved on faces of C, others as the complementarity problem with multipliers: nonlinear ones by the solver's method,
 * affine ones by their own, which heeds the solver's tolerance, time limit and interruptions alone. */
int32_t perp_vi(perp_solver* solver, const perp_problem* problem, const perp_matrix* A, const double* lower,
                const double* upper, const double* x0, perp_result** result, perp_error* error);

/** Numbers of many problems: those of problem k begin at values + k step; step 0: all have the same. */
typedef struct perp_varying {
  const double* values;
  int64_t step;
} perp_varying;
/** `count` affine variational inequalities as perp_vi has them, F = M x + q, of n variables and m rows, dense, M and A
 * by rows, in so many threads; threads 0: one a processor. NULL sides and bounds are 0 and +infinity; m = 0: MCPs. x
 * gets count n entries, multipliers count m, status (perp_status) and residual count; each but x may be NULL. What
 * comes back depends neither on the order nor on the threads, to the last bit. */
int32_t perp_batch_vi(int32_t interface_, int64_t count, int64_t n, int64_t m, const perp_varying* M,
                      const perp_varying* q, const perp_varying* A, const perp_varying* row_lower,
                      const perp_varying* row_upper, const perp_varying* lower, const perp_varying* upper, double tol,
                      int32_t threads, double* x, double* multipliers, int32_t* status, double* residual,
                      perp_error* error);

/** A solver of small dense affine problems that come often, such as a simulator's. It keeps its memory, and the cell of
 *  its last solution, in which it begins where the next problem has as many variables. */
typedef struct perp_dense perp_dense;
int32_t perp_dense_create(int32_t interface_, perp_dense** solver, perp_error* error);
void perp_dense_free(perp_dense* solver);
/** Solves MCP(lower, upper, M x + q), M n x n by rows; lower NULL is 0, upper NULL +infinity. x gets n entries, status
 * a perp_status, residual the natural residual of x, which is at most tol where status is PERP_SOLVED; each of the two
 * may be NULL. */
int32_t perp_dense_solve(perp_dense* solver, int64_t n, const double* M, const double* q, const double* lower,
                         const double* upper, double tol, double* x, int32_t* status, double* residual,
                         perp_error* error);
/** The next solve begins at the bounds. */
void perp_dense_forget(perp_dense* solver);

/** Proves, if it can, that exactly one solution is near x, with every rounding accounted for (Krawczyk's operator). For
 *  affine problems and those that have ranges, of files and the collection. */
int32_t perp_verify(perp_solver* solver, const perp_problem* problem, const double* x, perp_result** result,
                    perp_error* error);
/** How the solution x moves with m parameters p: dF = dF/dp at x, n x m; dlower and dupper, of the bounds, or NULL.
 * With a direction of m entries: in that direction only, which exists at degenerate solutions, too. */
int32_t perp_sensitivity(perp_solver* solver, const perp_problem* problem, const double* x, const perp_matrix* dF,
                         const perp_matrix* dlower, const perp_matrix* dupper, const double* direction,
                         perp_result** result, perp_error* error);
/** Compares J with differences of F at x (NULL: the start): at least 2 n evaluations of F. */
int32_t perp_check_jacobian(perp_solver* solver, const perp_problem* problem, const double* x, perp_result** result,
                            perp_error* error);
/** What is known of the problem before it is solved; x0 NULL: the start. */
int32_t perp_inspect(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                     perp_error* error);
/** Why the problem has no solution, which row is the cause, and what would mend it; or what in it looks like a slip. By
 *  the solver's method, in at most so many seconds; x0 NULL: the start. */
int32_t perp_explain(perp_solver* solver, const perp_problem* problem, const double* x0, double seconds,
                     perp_result** result, perp_error* error);
/** What there is to choose from, of `what` = "methods", "options", "collection", "scenes". */
int32_t perp_list(int32_t interface_, const char* what, perp_result** result, perp_error* error);

/* Results: fields that have a name. Without such a field the answer is NULL, 0, NaN, -1 of integers.
 *
 *  perp_solve, perp_solve_kept:
 *    status          text: "Solved", ...; its number by perp_result_status()
 *    success         integer 1: the natural residual is at most the tolerance
 *    message, advice text: what happened, with names and values; what to try
 *    x, F            reals: the best point met, in the box, and F there
 *    residual, worst real, integer: the natural residual of x, by the judge, and the row where it is largest; -1: none
 *    relative, relative_row
 *                    the largest residual of a row beside the terms it is the rest of; NaN, -1 where J is not defined
 *    residual_bound  real, of Infeasible: no point has a natural residual of at most this
 *    certificate     text, of Infeasible: the proof as JSON, which scripts/check_certificate.py checks; none where the
 *                    ranges of F are the proof
 *    notes           texts: what a solution to the tolerance leaves to be said
 *    basis           cells: perp_cells of the last linearised problem solved; not of all methods
 *    stats           part: iterations, F_evals, J_evals, pivots, ..., time_s (seconds); of functions F_calls,
 *                    jac_calls, difference_groups (of columns, without J)
 *    log             iterations
 *    computed        part, of models that have such: the variables that are no unknowns, by name, each with its value
 *    kept_by         text, of perp_solve_kept: "kept", "exchanges", "path", "anew"
 *    verified        part, with option verify: as perp_verify
 *  perp_solve_all: found (parts, as above, with how and singular), first (part), attempts, duplicates, message, stats
 *  perp_verify: unique, x, radius (reals: |y_i - x_i| <= radius_i for the one solution y), active, why_not
 *  perp_sensitivity: status, known, message, dx, dF (reals, n x directions by rows), directions, states (texts),
 *    degenerate (integers), rcond, strongly_regular, residual
 *  perp_check_jacobian: worst, row, column, given, difference, outside_pattern, message
 *  perp_vi: status, success, message, x, F, residual, projection_error (real: how much of residual bounds the errors of
 *    the projection and of affine F), worst, multipliers (reals, of the rows: F = A'multipliers + reduced, at least 0
 *    at lower sides and at most 0 at upper ones), reduced (reals, of the bounds), rows, bounds (cells: the active
 *    ones), empty (integer 1: proven that C is), certificate (reals, of Infeasible), iterations, stats (part, where the
 *    method ran)
 *  perp_inspect: name, size, nonzeros, affine, bounds (part: free, lower, upper, boxed, fixed), structural_rank,
 *    residual, worst (text), singular, warnings (texts), classes (part: 1 yes, 0 no, -1 not decided), guarantees
 *    (texts)
 *  perp_explain: status, success, message, notes (texts), answers (parts, the first one first: kind, proven, text, rows
 *    and variables (texts), row_indices, variable_indices), conflict (part: demands (parts: what, name, index),
 *    smallest, certificate (text, JSON, where there is an exact one)), repair (part: changes (parts: as demands, and
 *    from, to), least, verified); without conflict and repair where none was found
 *  perp_list: items (parts of texts and integers)
 *  perp_contact_...: below. */
enum perp_kind {
  PERP_NONE = 0, /**< there is no such field */
  PERP_INTEGER = 1,
  PERP_REAL = 2,
  PERP_TEXT = 3,
  PERP_TEXTS = 4,
  PERP_REALS = 5,
  PERP_INTEGERS = 6,
  PERP_CELLS = 7, /**< int8_t */
  PERP_PARTS = 8, /**< results again, or one */
  PERP_ITERATIONS = 9
};

void perp_result_free(perp_result* result);
/** perp_status of a solve; -1 of NULL and of other results. */
int32_t perp_result_status(const perp_result* result);

/* What they point to lives as long as the result. */
const char* perp_result_key(const perp_result* result, int64_t i);       /**< of field i; NULL beyond the last */
int32_t perp_result_kind(const perp_result* result, const char* key);    /**< perp_kind */
int64_t perp_result_length(const perp_result* result, const char* key);  /**< entries; 1 of a number or a text */
int64_t perp_result_integer(const perp_result* result, const char* key); /**< -1 */
double perp_result_real(const perp_result* result, const char* key);     /**< of an integer, too */
const char* perp_result_text(const perp_result* result, const char* key, int64_t i); /**< i = 0 of a single text */
const double* perp_result_reals(const perp_result* result, const char* key);
const int64_t* perp_result_integers(const perp_result* result, const char* key);
const int8_t* perp_result_cells(const perp_result* result, const char* key);
const perp_result* perp_result_part(const perp_result* result, const char* key, int64_t i); /**< not to be freed */
const perp_iteration* perp_result_iterations(const perp_result* result, const char* key);

/* Contact with Coulomb friction: u = W r + q, K*_mu > u + mu |u_T| e_N _|_ r in K_mu, contact by contact. Block a of r,
 * u, q has d = dimension entries, the normal one first. Impulses r [N s], velocities u [m/s]. */

typedef struct perp_contact perp_contact;

/** W d n x d n [1/kg], q d n [m/s], mu n coefficients >= 0, n = contacts, d = 2 or 3. */
int32_t perp_contact_create(int32_t interface_, int32_t dimension, int64_t contacts, const perp_matrix* W,
                            const double* q, const double* mu, perp_contact** contact, perp_error* error);
/** With rolling friction: d = 3 in 2D, (N, T, R), and 5 in 3D, (N, T1, T2, R1, R2), mu_r n coefficients [m] >= 0, and
 *  K_mu = {r : |r_T| <= mu r_N, |m_R| <= mu_r r_N}, u + (mu |u_T| + mu_r |w_R|) e_N in K*_mu. */
int32_t perp_contact_create_rolling(int32_t interface_, int32_t dimension, int64_t contacts, const perp_matrix* W,
                                    const double* q, const double* mu, const double* mu_r, perp_contact** contact,
                                    perp_error* error);
/** Of the bodies' velocities v, m entries: M v = H r + f, u = H' v + w. M m x m [kg], positive definite, H m x d n,
 *  f m [N s], w d n [m/s]. W = H' M^-1 H, q = H' M^-1 f + w. */
int32_t perp_contact_condense(int32_t interface_, int32_t dimension, int64_t contacts, const perp_matrix* M,
                              const perp_matrix* H, const double* f, const double* w, const double* mu,
                              perp_contact** contact, perp_error* error);
/** From a file: FCLIB's HDF5, or Siconos' text. */
int32_t perp_contact_read(int32_t interface_, const char* path, perp_contact** contact, perp_error* error);
/** A step of bodies with about so many contacts: "stack", "spheres", "arch", "chain", "wall", "incline" (perp_list).
 * The same for the same seed, up to rounding. */
int32_t perp_contact_scene(int32_t interface_, const char* scene, int64_t contacts, int64_t seed,
                           perp_contact** contact, perp_error* error);
void perp_contact_free(perp_contact* contact);

/** d, entries of a contact in q, r and u: 2 or 3; with rolling friction 3 in 2D and 5 in 3D. 0 of NULL. */
int32_t perp_contact_dimension(const perp_contact* contact);
int64_t perp_contact_contacts(const perp_contact* contact); /**< 0 of NULL */
const char* perp_contact_name(const perp_contact* contact); /**< "" of NULL */
const double* perp_contact_q(const perp_contact* contact);
const double* perp_contact_mu(const perp_contact* contact);
const double* perp_contact_mu_r(const perp_contact* contact); /**< NULL without rolling friction */
/** W by columns with indices of 32 bits, in the library's own arrays, which live as long as the problem. Of bodies it
 * is formed here. */
int32_t perp_contact_W(const perp_contact* contact, perp_matrix* W, perp_error* error);
/** Judges impulses r, d n entries: accepted (integer 1: they solve the problem to `tolerance`), and the measures
 *  natural, siconos, rr9118, scaled, cone, normal, slip, largest. */
int32_t perp_contact_judge(const perp_contact* contact, const double* r, double tolerance, perp_result** result,
                           perp_error* error);
/** Whether the problem has a solution, as far as this can be proven: existence (text: "exists", "none", "undecided"),
 *  message; certificate (reals y) and radius, of none; r and margin, of exists. */
int32_t perp_contact_existence(perp_solver* solver, const perp_contact* contact, perp_result** result,
                               perp_error* error);

/** Solves by a law and a method in words, "glocker" (and NULL), "glocker+path", "inner:8+lemke", "frictionless":
 *  as `perp contact`. r0, d n entries: impulses of a similar problem to begin near, or NULL. Of the solver it takes
 *  convergence_tolerance (1e-8), time_limit (30 s), the options of the method, and interruptions. Fields of the result:
 *    r, u            reals: impulses and velocities of the accepted point, or of the best one met
 *    status, success, message
 *                    as of perp_solve; success is 1 where the variant's law is solved
 *    solved_by       text: the step that made the point; ""
 *    residual        part: the measures of Coulomb's law, as perp_contact_judge, and own, of other laws' problems
 *    states          cells: a perp_contact_state for each contact
 *    stats           part: time_s, and what the method counted
 *    verdict         part, where there is no solution: as perp_contact_existence */
int32_t perp_contact_solve(perp_solver* solver, const perp_contact* contact, const char* variant, const double* r0,
                           perp_result** result, perp_error* error);
/** Simulations side by side, `count` of them. Each has a solver of its own that is kept from step to step. */
typedef struct perp_contact_batch perp_contact_batch;
/** The variant and, of the solver, what perp_contact_solve takes, but for interruptions. */
int32_t perp_contact_batch_create(int32_t interface_, const perp_solver* solver, int64_t count, const char* variant,
                                  perp_contact_batch** batch, perp_error* error);
void perp_contact_batch_free(perp_contact_batch* batch);
/** The next step of each: W d n x d n by rows, q d n, mu n; begins near the last solved one. Threads 0: one a
 * processor. r and u get count d n entries, as of perp_contact_solve, status (perp_status) and residual (largest, or
 * own of other laws' problems) count; each may be NULL. Bits depend on order and threads by a time limit alone. */
int32_t perp_contact_batch_step(perp_contact_batch* batch, int32_t dimension, int64_t contacts, const perp_varying* W,
                                const perp_varying* q, const perp_varying* mu, int32_t threads, double* r, double* u,
                                int32_t* status, double* residual, perp_error* error);
/** How the solution r moves with m parameters p: dq/dp, d n x m; dmu/dp, n x m; dW, m matrices dW/dp_j, d n x d n; each
 * may be NULL. m = 0: by q and then mu. With a direction of m entries: in it alone, at kinks, too. Fields:
 *    status, known, message, directions, rcond, strongly_regular: as of perp_sensitivity
 *    dr, du          reals, d n x directions by rows
 *    regions         texts: "open", "stick", "slip", "roll"; at a kink "touching", "edge"
 *    degenerate      integers: the contacts at a kink
 *    residual        part: of r, as perp_contact_judge */
int32_t perp_contact_sensitivity(perp_solver* solver, const perp_contact* contact, const double* r, int64_t m,
                                 const perp_matrix* dq, const perp_matrix* dmu, const perp_matrix* dW,
                                 const double* direction, perp_result** result, perp_error* error);
/** PERP_ROLL: does not slip, and its rolling friction is fully used. */
enum perp_contact_state { PERP_OPEN = 0, PERP_STICK = 1, PERP_SLIP = 2, PERP_ROLL = 3 };

#ifdef __cplusplus
}
#endif

#endif
