// SPDX-License-Identifier: Apache-2.0
/// Tests of SNES type perp, to be run by mpiexec on any number of ranks: petsc_tests CASE [PETSC OPTIONS], with
/// -dll_append libperp_petsc.so -snes_type perp. Exit status 0 if the case holds on this rank, 1 if not.
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>

#include "petsc/elastic_body.hpp"
#include "petsc/problems.hpp"

namespace perp::petsc_tests {
namespace {

constexpr PetscReal tight = 1e-10;  // of h^2 times the equations, whose terms are of order one

#define EXPECT(condition, ...)                                                     \
  do {                                                                             \
    if (!(condition)) {                                                            \
      std::fprintf(stderr, "%s:%d: not so: %s; ", __FILE__, __LINE__, #condition); \
      std::fprintf(stderr, __VA_ARGS__);                                           \
      std::fprintf(stderr, "\n");                                                  \
      return PETSC_ERR_PLIB;                                                       \
    }                                                                              \
  } while (false)

struct Solved {
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt steps = 0;
  PetscReal residual = 0;
  PetscReal active = 0;  ///< share of the variables at a bound
  PetscErrorCode code = 0;
};

/// Writes x where -write FILE says, in the natural order of the grid, for the comparison between numbers of ranks.
PetscErrorCode write_if_asked(Vec x) {
  char file[PETSC_MAX_PATH_LEN];
  PetscBool wanted = PETSC_FALSE;
  PetscCall(PetscOptionsGetString(nullptr, nullptr, "-write", file, sizeof(file), &wanted));
  if (!wanted) return 0;
  PetscViewer viewer = nullptr;
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, file, FILE_MODE_WRITE, &viewer));
  PetscCall(PetscViewerBinarySetSkipInfo(viewer, PETSC_TRUE));
  PetscCall(VecView(x, viewer));
  return PetscViewerDestroy(&viewer);
}

PetscErrorCode judge(SNES snes, Vec x, Vec lower, Vec upper, Solved* solved) {
  Vec at = nullptr;
  PetscReal count = 0;
  PetscInt n = 0;
  PetscCall(SNESGetConvergedReason(snes, &solved->reason));
  PetscCall(SNESGetIterationNumber(snes, &solved->steps));
  PetscCall(independent_residual(snes, x, lower, upper, &solved->residual));
  PetscCall(VecDuplicate(x, &at));
  for (Vec bound : {lower, upper}) {
    PetscScalar* p = nullptr;
    PetscInt m = 0;
    PetscCall(VecWAXPY(at, -1, bound, x));
    PetscCall(VecGetLocalSize(at, &m));
    PetscCall(VecGetArray(at, &p));
    for (PetscInt i = 0; i < m; ++i) count += p[i] == 0 ? 1 : 0;
    PetscCall(VecRestoreArray(at, &p));
  }
  PetscCall(VecGetSize(x, &n));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD));
  solved->active = count / static_cast<PetscReal>(n);
  return VecDestroy(&at);
}

PetscErrorCode solve(PetscInt n, Bounds bounds, Membrane m, Solved* solved) {
  DM dm = nullptr;
  SNES snes = nullptr;
  Vec x = nullptr;
  Vec lower = nullptr;
  Vec upper = nullptr;
  PetscCall(make_membrane(n, bounds, &m, &dm, &snes));
  PetscCall(DMCreateGlobalVector(dm, &x));
  PetscCall(VecDuplicate(x, &lower));
  PetscCall(VecDuplicate(x, &upper));
  PetscCall(fill_bounds(dm, m, lower, upper));
  PetscCall(SNESSetTolerances(snes, 1e-12, 0, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  solved->code = SNESSolve(snes, nullptr, x);
  m.nan_from = m.error_from = m.outside_from = m.signal = 0;
  PetscCall(judge(snes, x, lower, upper, solved));
  PetscCall(write_if_asked(x));
  for (Vec* v : {&x, &lower, &upper}) PetscCall(VecDestroy(v));
  PetscCall(SNESDestroy(&snes));
  return DMDestroy(&dm);
}

/// Solved, with part of the variables at bounds, so that it was no linear problem; in so many steps.
PetscErrorCode expect_solved(const Solved& s, PetscInt steps) {
  EXPECT(s.code == 0, "error %d", static_cast<int>(s.code));
  EXPECT(s.reason > 0, "reason %d", static_cast<int>(s.reason));
  EXPECT(s.residual <= tight, "residual %g", s.residual);
  EXPECT(s.active > 0.01 && s.active < 0.99, "%g of the variables are at bounds", s.active);
  EXPECT(s.steps <= steps, "%d steps", static_cast<int>(s.steps));
  return 0;
}

/// The same by every way that bounds reach SNES.
PetscErrorCode obstacle() {
  for (Bounds bounds : {Bounds::Function, Bounds::Dm, Bounds::Vectors}) {
    Solved s;
    PetscCall(solve(65, bounds, {.load = -4, .obstacle = true}, &s));
    PetscCall(expect_solved(s, 8));
  }
  return 0;
}

PetscErrorCode torsion() {
  Solved s;
  PetscCall(solve(65, Bounds::Function, {.load = 10, .slope = 1}, &s));
  return expect_solved(s, 8);
}

/// No DM hierarchy: an even number of points.
PetscErrorCode uncoarsened() {
  Solved s;
  PetscCall(solve(50, Bounds::Function, {.load = -4, .obstacle = true}, &s));
  return expect_solved(s, 20);
}

/// Nonlinear: J changes.
PetscErrorCode bratu() {
  Solved s;
  PetscCall(solve(65, Bounds::Function, {.bratu = 6, .ceiling = 0.6}, &s));
  return expect_solved(s, 10);
}

/// J is not symmetric.
PetscErrorCode wind() {
  Solved s;
  PetscCall(solve(65, Bounds::Dm, {.load = -4, .wind = 40, .obstacle = true}, &s));
  return expect_solved(s, 25);
}

/// Twice as fine thrice: the steps stay what they are.
PetscErrorCode steps_do_not_grow() {
  PetscInt least = 1000;
  PetscInt most = 0;
  for (PetscInt n : {33, 65, 129, 257}) {
    Solved s;
    PetscCall(solve(n, Bounds::Function, {.load = -4, .obstacle = true}, &s));
    PetscCall(expect_solved(s, 8));
    least = std::min(least, s.steps);
    most = std::max(most, s.steps);
  }
  EXPECT(most <= least + 2, "from %d to %d steps", static_cast<int>(least), static_cast<int>(most));
  return 0;
}

/// A grid that can be made coarser once only, to 74 x 74 points.
PetscErrorCode coarsened_once() {
  Solved s;
  PetscCall(solve(147, Bounds::Function, {.load = -4, .obstacle = true}, &s));
  return expect_solved(s, 8);
}

/// Two displacements a point, given ones in rows whose columns are kept: neither the steps nor the V-cycles grow. Once
/// they did, because coarse grids changed what was given.
PetscErrorCode elastic_body() {
  PetscInt first = 0;
  for (PetscInt n : {23, 45, 89}) {
    ElasticBody body;
    SNES snes = nullptr;
    Vec x = nullptr;
    Solved s;
    PetscInt cycles = 0;
    PetscCall(make_elastic_body(n, &body));
    PetscCall(make_snes(&body, &snes));
    PetscCall(DMCreateGlobalVector(body.dm, &x));
    PetscCall(SNESSetTolerances(snes, 1e-12, 0, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
    PetscCall(SNESSolve(snes, nullptr, x));
    PetscCall(SNESGetLinearSolveIterations(snes, &cycles));
    PetscCall(judge(snes, x, body.lower, body.upper, &s));
    EXPECT(s.reason > 0 && s.residual <= tight, "reason %d, residual %g", static_cast<int>(s.reason), s.residual);
    EXPECT(s.active > 0 && s.steps <= 4, "%d steps", static_cast<int>(s.steps));
    if (first == 0) first = cycles;
    EXPECT(cycles <= 1.3 * first + 2, "%d V-cycles, %d at first", static_cast<int>(cycles), static_cast<int>(first));
    PetscCall(VecDestroy(&x));
    PetscCall(SNESDestroy(&snes));
    PetscCall(destroy(&body));
  }
  return 0;
}

// --- affine problems of a few rows, without a DM ---------------------------------------------------------------------

struct Setting {
  bool corner = false;   ///< the start is (1, 0, 0, ...)
  int error_from = 0;    ///< F fails on the last rank from this evaluation on, where positive
  int outside_from = 0;  ///< likewise: SNESSetFunctionDomainError
};
struct Affine {
  Vec q = nullptr;
  Setting setting;
  int evaluations = 0;
};

PetscErrorCode affine_function(SNES snes, Vec x, Vec F, void* data) {
  Mat M = nullptr;
  int rank = 0;
  int ranks = 0;
  auto& a = *static_cast<Affine*>(data);
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const auto due = [&](int from) { return rank == ranks - 1 && from > 0 && a.evaluations >= from; };
  ++a.evaluations;
  if (due(a.setting.outside_from)) PetscCall(SNESSetFunctionDomainError(snes));
  PetscCall(SNESGetJacobian(snes, nullptr, &M, nullptr, nullptr));
  PetscCall(MatMultAdd(M, x, a.q, F));
  return due(a.setting.error_from) ? PETSC_ERR_USER : 0;
}
PetscErrorCode affine_jacobian(SNES, Vec, Mat, Mat, void*) { return 0; }

/// F = M x + q with M_ij = entry(i, j), x >= 0.
template <class Entry>
PetscErrorCode solve_affine(PetscInt n, Entry entry, PetscReal load, PetscReal lower, PetscReal upper, Solved* solved,
                            PetscReal* x0, Setting setting = {}) {
  Mat M = nullptr;
  Vec x = nullptr;
  Vec F = nullptr;
  Affine a{.setting = setting};
  Vec& q = a.q;
  Vec l = nullptr;
  Vec u = nullptr;
  SNES snes = nullptr;
  PetscInt begin = 0;
  PetscInt end = 0;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, n, n, n, nullptr, n, nullptr, &M));
  PetscCall(MatGetOwnershipRange(M, &begin, &end));
  for (PetscInt i = begin; i < end; ++i)
    for (PetscInt j = 0; j < n; ++j) PetscCall(MatSetValue(M, i, j, entry(i, j), INSERT_VALUES));
  PetscCall(MatAssemblyBegin(M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreateVecs(M, &x, &F));
  for (Vec* v : {&q, &l, &u}) PetscCall(VecDuplicate(x, v));
  PetscCall(VecSet(q, load));
  PetscCall(VecSet(l, lower));
  PetscCall(VecSet(u, upper));
  PetscCall(VecSet(x, *x0));
  if (setting.corner && begin == 0 && end > 0) PetscCall(VecSetValue(x, 0, 1, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(x));
  PetscCall(VecAssemblyEnd(x));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetFunction(snes, F, affine_function, &a));
  PetscCall(SNESSetJacobian(snes, M, M, affine_jacobian, nullptr));
  PetscCall(SNESVISetVariableBounds(snes, l, u));
  PetscCall(SNESSetFromOptions(snes));
  solved->code = SNESSolve(snes, nullptr, x);
  a.setting = {};
  if (solved->code == 0) PetscCall(judge(snes, x, l, u, solved));
  PetscCall(VecNorm(x, NORM_INFINITY, x0));
  PetscCall(SNESDestroy(&snes));
  for (Vec* v : {&x, &F, &q, &l, &u}) PetscCall(VecDestroy(v));
  return MatDestroy(&M);
}

PetscReal cyclic(PetscInt i, PetscInt j) { return i == j ? 1.0 : (i + 1) % 3 == j ? 2.0 : 0.0; }

/// Murty's matrix of order 3, upside down: a P-matrix on which active-set steps from (1, 0, 0) go to (0, 1, 0), (0, 0,
/// 1) and back (Kanzow 1996 has such ones), so that only the semismooth steps get through. The solution is 1/3
/// everywhere.
PetscErrorCode cycling() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(3, cyclic, -1, 0, PETSC_INFINITY, &s, &x, {.corner = true}));
  EXPECT(s.code == 0 && s.reason > 0, "error %d, reason %d", static_cast<int>(s.code), static_cast<int>(s.reason));
  EXPECT(s.residual <= 1e-7, "residual %g", s.residual);
  EXPECT(s.steps > 10, "%d steps: no cycle", static_cast<int>(s.steps));
  EXPECT(std::abs(x - 1.0 / 3) <= 1e-7, "x is %g", x);
  return 0;
}

/// Fewer rows than ranks: two variables, 2 x - 1 on the diagonal, 1 beside it. x = 1/3 both.
PetscErrorCode empty_rank() {
  Solved s;
  PetscReal x = 5;
  PetscCall(solve_affine(
      2, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 1.0; }, -1, 0, 10, &s, &x));
  EXPECT(s.code == 0 && s.reason > 0, "error %d, reason %d", static_cast<int>(s.code), static_cast<int>(s.reason));
  EXPECT(std::abs(x - 1.0 / 3) <= 1e-7, "x is %g", x);
  return 0;
}

/// An error on every rank, not on the one alone that has the variable.
PetscErrorCode crossing_bounds() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(
      7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.0; }, -1, 1, 0, &s, &x));
  EXPECT(s.code == PETSC_ERR_ARG_OUTOFRANGE, "error %d", static_cast<int>(s.code));
  const PetscReal nan = std::numeric_limits<double>::quiet_NaN();
  PetscCall(solve_affine(
      7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.0; }, -1, 0, nan, &s, &x));
  EXPECT(s.code == PETSC_ERR_ARG_OUTOFRANGE, "error %d", static_cast<int>(s.code));
  return 0;
}

PetscErrorCode expect_error(const Membrane& m) {
  Solved s;
  PetscCall(solve(33, Bounds::Function, m, &s));
  EXPECT(s.code == PETSC_ERR_USER, "error %d", static_cast<int>(s.code));
  return 0;
}

PetscErrorCode expect_reason(const Membrane& m, SNESConvergedReason reason) {
  Solved s;
  PetscCall(solve(33, Bounds::Function, m, &s));
  EXPECT(s.code == 0, "error %d", static_cast<int>(s.code));
  EXPECT(s.reason == reason, "reason %d, not %d", static_cast<int>(s.reason), static_cast<int>(reason));
  return 0;
}

/// From the start, and where the first step goes.
PetscErrorCode nan_on_one_rank() {
  for (PetscReal from : {1.0, 2.0})
    PetscCall(expect_reason({.load = -4, .obstacle = true, .nan_from = from}, SNES_DIVERGED_FNORM_NAN));
  return 0;
}

PetscErrorCode nan_in_jacobian() {
  return expect_reason({.load = -4, .obstacle = true, .nan_in_jacobian = true}, SNES_DIVERGED_JACOBIAN_DOMAIN);
}

/// A SNES solves again, from another start, and with grid sequencing, which resets it on each grid and so must not
/// leave its KSP with what belonged to the grid before.
PetscErrorCode solved_again() {
  DM dm = nullptr;
  DM fine = nullptr;
  SNES snes = nullptr;
  Vec x = nullptr;
  Membrane m{.load = -4, .obstacle = true};
  PetscCall(make_membrane(33, Bounds::Function, &m, &dm, &snes));
  PetscCall(DMCreateGlobalVector(dm, &x));
  PetscCall(SNESSetTolerances(snes, 1e-12, 0, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  for (PetscInt grids : {0, 0, 3}) {
    SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
    PetscInt steps = 0;
    PetscCall(VecSet(x, 1));
    PetscCall(SNESSetGridSequence(snes, grids));
    PetscCall(SNESSolve(snes, nullptr, x));
    PetscCall(SNESGetConvergedReason(snes, &reason));
    PetscCall(SNESGetIterationNumber(snes, &steps));
    EXPECT(reason > 0 && steps <= 6, "reason %d, %d steps", static_cast<int>(reason), static_cast<int>(steps));
  }
  PetscInt points = 0;
  Vec solution = nullptr;
  Vec lower = nullptr;
  Vec upper = nullptr;
  PetscReal residual = 0;
  PetscCall(SNESGetDM(snes, &fine));
  PetscCall(DMDAGetInfo(fine, nullptr, &points, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                        nullptr, nullptr, nullptr));
  EXPECT(points == 257, "%d points", static_cast<int>(points));
  PetscCall(SNESGetSolution(snes, &solution));
  PetscCall(VecDuplicate(solution, &lower));
  PetscCall(VecDuplicate(solution, &upper));
  PetscCall(fill_bounds(fine, m, lower, upper));
  PetscCall(independent_residual(snes, solution, lower, upper, &residual));
  EXPECT(residual <= tight, "residual %g", residual);
  for (Vec* v : {&x, &lower, &upper}) PetscCall(VecDestroy(v));
  PetscCall(SNESDestroy(&snes));
  return DMDestroy(&dm);
}

// Errors on one rank once left the others waiting. One a run: after an error PETSc's ranks may not agree on much.

PetscErrorCode error_on_one_rank() { return expect_error({.load = -4, .obstacle = true, .error_from = 2}); }
PetscErrorCode error_in_bounds() { return expect_error({.load = -4, .obstacle = true, .error_in_bounds = true}); }
PetscErrorCode error_in_jacobian() { return expect_error({.load = -4, .obstacle = true, .error_in_jacobian = true}); }

/// In the search of a semismooth step: the first twelve evaluations are the start and the active-set steps.
PetscErrorCode error_in_semismooth_step() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(3, cyclic, -1, 0, PETSC_INFINITY, &s, &x, {.corner = true, .error_from = 13}));
  EXPECT(s.code == PETSC_ERR_USER, "error %d", static_cast<int>(s.code));
  return 0;
}

/// The start, and where the first step goes; also on a rank that has no row to show it.
PetscErrorCode domain_error_on_one_rank() {
  for (int from : {1, 2}) {
    Solved s;
    PetscReal x = 5;
    PetscCall(expect_reason({.load = -4, .obstacle = true, .outside_from = static_cast<PetscReal>(from)},
                            SNES_DIVERGED_FUNCTION_DOMAIN));
    PetscCall(solve_affine(2, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 1.0; }, -1, 0, 10, &s, &x,
                           {.outside_from = from}));
    EXPECT(s.code == 0, "error %d", static_cast<int>(s.code));
    EXPECT(s.reason == SNES_DIVERGED_FUNCTION_DOMAIN, "reason %d", static_cast<int>(s.reason));
  }
  return 0;
}

PetscErrorCode domain_error_in_jacobian() {
  return expect_reason({.load = -4, .obstacle = true, .outside_in_jacobian = true}, SNES_DIVERGED_JACOBIAN_DOMAIN);
}

PetscErrorCode no_variables() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(
      0, [](PetscInt, PetscInt) { return 0.0; }, -1, 0, 1, &s, &x));
  EXPECT(s.code == 0 && s.reason > 0, "error %d, reason %d", static_cast<int>(s.code), static_cast<int>(s.reason));
  return 0;
}

/// To be run with a KSP that cannot converge, and leave to fail: an end, and no false one.
PetscErrorCode stubborn_ksp() {
  Solved s;
  PetscCall(solve(33, Bounds::Function, {.load = -4, .obstacle = true}, &s));
  EXPECT(s.code == 0, "error %d", static_cast<int>(s.code));
  EXPECT(s.reason < 0 || s.residual <= tight, "reason %d, residual %g", static_cast<int>(s.reason), s.residual);
  return 0;
}

/// To be run with a KSP that cannot converge.
PetscErrorCode diverging_ksp() { return expect_reason({.load = -4, .obstacle = true}, SNES_DIVERGED_LINEAR_SOLVE); }

PetscErrorCode interrupted() {
  for (int signal : {SIGINT, SIGTERM})
    PetscCall(expect_reason({.bratu = 6, .ceiling = 0.6, .signal = signal}, SNES_DIVERGED_INNER));
  return 0;
}

struct Case {
  const char* name;
  PetscErrorCode (*run)();
};
constexpr Case cases[] = {{"obstacle", obstacle},
                          {"torsion", torsion},
                          {"uncoarsened", uncoarsened},
                          {"bratu", bratu},
                          {"wind", wind},
                          {"steps_do_not_grow", steps_do_not_grow},
                          {"coarsened_once", coarsened_once},
                          {"elastic_body", elastic_body},
                          {"cycling", cycling},
                          {"empty_rank", empty_rank},
                          {"crossing_bounds", crossing_bounds},
                          {"nan_on_one_rank", nan_on_one_rank},
                          {"nan_in_jacobian", nan_in_jacobian},
                          {"solved_again", solved_again},
                          {"error_on_one_rank", error_on_one_rank},
                          {"error_in_bounds", error_in_bounds},
                          {"error_in_jacobian", error_in_jacobian},
                          {"error_in_semismooth_step", error_in_semismooth_step},
                          {"domain_error_on_one_rank", domain_error_on_one_rank},
                          {"domain_error_in_jacobian", domain_error_in_jacobian},
                          {"no_variables", no_variables},
                          {"stubborn_ksp", stubborn_ksp},
                          {"diverging_ksp", diverging_ksp},
                          {"interrupted", interrupted}};

/// Errors come back as codes, silently: some cases ask for them.
PetscErrorCode quiet(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType, const char* text,
                     void*) {
  if (text != nullptr && std::strlen(text) > 0) std::fprintf(stderr, "PETSc: %s\n", text);
  return code;
}

}  // namespace
}  // namespace perp::petsc_tests

int main(int argc, char** argv) {
  using namespace perp::petsc_tests;
  if (argc < 2) return 2;
  const std::string name = argv[1];
  if (PetscInitialize(&argc, &argv, nullptr, nullptr) != 0) return 2;
  PetscPushErrorHandler(quiet, nullptr);
  int failed = 1;
  for (const Case& c : cases)
    if (c.name == name) failed = c.run() == 0 ? 0 : 1;
  // Waits for the others: a rank that has hung is found by ctest's time limit.
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  PetscFinalize();
  return failed;
}
