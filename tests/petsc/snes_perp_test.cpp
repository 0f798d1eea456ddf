// SPDX-License-Identifier: Apache-2.0
/// Tests of SNES type perp, to be run by mpiexec on any number of ranks: petsc_tests CASE [PETSC OPTIONS], with
/// -dll_append libperp_petsc.so -snes_type perp. Exit status 0 if the case holds on this rank, 1 if not.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>

#include "petsc/cases.hpp"
#include "petsc/elastic_body.hpp"
#include "petsc/problems.hpp"

namespace perp::petsc_tests {

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

namespace {

constexpr PetscReal tight = 1e-10;  // of h^2 times the equations, whose terms are of order one

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
  m.nan_from = m.error_from = m.outside_from = 0;
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
/// they did, because coarse grids changed what was given. Where an end of the line of contact is one variable off after
/// the first step, a third one was made (23, 57 and 105 points).
PetscErrorCode elastic_body() {
  PetscInt first = 0;
  for (PetscInt n : {23, 45, 57, 89, 105}) {
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
    EXPECT(s.active > 0 && s.steps == 2, "%d steps", static_cast<int>(s.steps));
    if (first == 0) first = cycles;
    EXPECT(cycles <= 1.3 * first + 2, "%d V-cycles, %d at first", static_cast<int>(cycles), static_cast<int>(first));
    PetscCall(VecDestroy(&x));
    PetscCall(SNESDestroy(&snes));
    PetscCall(destroy(&body));
  }
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

/// From the start, and where the first step goes.
PetscErrorCode domain_error_on_one_rank() {
  for (int from : {1, 2})
    PetscCall(expect_reason({.load = -4, .obstacle = true, .outside_from = static_cast<PetscReal>(from)},
                            SNES_DIVERGED_FUNCTION_DOMAIN));
  return 0;
}

PetscErrorCode domain_error_in_jacobian() {
  return expect_reason({.load = -4, .obstacle = true, .outside_in_jacobian = true}, SNES_DIVERGED_JACOBIAN_DOMAIN);
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
                          {"grids_in_space", grids_in_space},
                          {"periodic_grids", periodic_grids},
                          {"free_edges", free_edges},
                          {"odd_coarsenings", odd_coarsenings},
                          {"hardly_a_problem", hardly_a_problem},
                          {"no_numbers", no_numbers},
                          {"refused_options", refused_options},
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
                          {"domain_error_without_rows", domain_error_without_rows},
                          {"domain_error_in_jacobian", domain_error_in_jacobian},
                          {"error_of_python", error_of_python},
                          {"unsolvable", unsolvable},
                          {"zero_pivot_on_one_rank", zero_pivot_on_one_rank},
                          {"error_in_monitor", error_in_monitor},
                          {"test_on_one_rank", test_on_one_rank},
                          {"no_variables", no_variables},
                          {"stubborn_ksp", stubborn_ksp},
                          {"diverging_ksp", diverging_ksp}};

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
