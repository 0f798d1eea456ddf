// SPDX-License-Identifier: Apache-2.0
/// One solve of one variational inequality by SNES type perp, PETSc's SNESVI or TAO, or one linear solve, on the ranks
/// of mpiexec; prints a line of JSON. bench/petsc/table.py runs it and makes the table.
///     bench_petsc PROBLEM POINTS CPU_SECONDS perp|snesvi|tao|ksp [PETSC OPTIONS]
/// Every run goes on until the largest entry of the natural residual is 1e-12.
#include <petscdmda.h>
#include <petscsnes.h>
#include <petsctao.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "grid_problem.hpp"
#include "petsc/box.hpp"
#include "petsc/snes_perp.hpp"

namespace perp::bench {
namespace {

constexpr double tol = 1e-12;

/// Of this process: what others on the machine change least.
double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The problem on one grid, and what its judge needs.
struct OnGrid {
  GridProblem problem;
  Vec F = nullptr, lower = nullptr, upper = nullptr, projected = nullptr;
};

struct Run {
  std::string name;
  std::vector<std::unique_ptr<OnGrid>> grids;  ///< several, if SNES goes through a sequence of them
  Vec x = nullptr;
  double started = 0, limit = 0, seconds = 0, processor = 0;
  bool late = false, solved = false;
  PetscReal residual = 0;
  PetscInt size = 0, steps = 0, krylov = 0, cycles = 0, evaluations = 0;
  std::string reason;
};
void start(Run& r) {
  r.processor = cpu_seconds();
  r.started = MPI_Wtime();
}
void stop(Run& r) {
  r.seconds = MPI_Wtime() - r.started;
  r.processor = cpu_seconds() - r.processor;
}
Run& run_of(void* data) { return *static_cast<Run*>(data); }

PetscErrorCode complete(OnGrid* g) {
  for (Vec* v : {&g->F, &g->lower, &g->upper, &g->projected}) PetscCall(DMCreateGlobalVector(g->problem.dm, v));
  return bounds(g->problem, g->lower, g->upper);
}

/// The problem on the SNES's grid. Its assembly is not part of the time, as it is not on a first grid.
PetscErrorCode grid_of(SNES snes, void* data, OnGrid** grid) {
  Run& r = run_of(data);
  DM dm = nullptr;
  PetscCall(SNESGetDM(snes, &dm));
  for (const auto& known : r.grids)
    if (known->problem.dm == dm) *grid = known.get();
  if (*grid != nullptr) return 0;
  const double wall = MPI_Wtime();
  const double cpu = cpu_seconds();
  r.grids.push_back(std::make_unique<OnGrid>());
  *grid = r.grids.back().get();
  PetscCall(on_grid(r.name, dm, &(*grid)->problem));
  PetscCall(complete(*grid));
  r.started += MPI_Wtime() - wall;
  r.processor += cpu_seconds() - cpu;
  return 0;
}

/// The residual at the projected point, and the time, the same on every rank.
PetscErrorCode look(Run& r, OnGrid& g, Vec x, bool* done) {
  petsc::Residual residual;
  const petsc::Box box{g.lower, g.upper};
  PetscCall(VecCopy(x, g.projected));
  PetscCall(petsc::project(box, g.projected));
  PetscCall(evaluate(g.problem, g.projected, g.F));
  PetscCall(petsc::natural_residual(box, g.projected, g.F, &residual));
  r.residual = residual.worst;
  int late = cpu_seconds() - r.processor > r.limit ? 1 : 0;
  PetscCallMPI(MPI_Bcast(&late, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  r.late = late != 0;
  *done = r.residual <= tol;
  return 0;
}

PetscErrorCode snes_test(SNES snes, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason* reason,
                         void* data) {
  Run& r = run_of(data);
  Vec x = nullptr;
  OnGrid* grid = nullptr;
  bool done = false;
  PetscCall(SNESGetSolution(snes, &x));
  PetscCall(grid_of(snes, data, &grid));
  PetscCall(look(r, *grid, x, &done));
  *reason = done ? SNES_CONVERGED_FNORM_ABS : r.late ? SNES_DIVERGED_MAX_IT : SNES_CONVERGED_ITERATING;
  return 0;
}

PetscErrorCode tao_test(Tao tao, void* data) {
  Run& r = run_of(data);
  Vec x = nullptr;
  bool done = false;
  PetscCall(TaoGetSolution(tao, &x));
  PetscCall(look(r, *r.grids[0], x, &done));
  return TaoSetConvergedReason(tao, done ? TAO_CONVERGED_USER : r.late ? TAO_DIVERGED_MAXITS : TAO_CONTINUE_ITERATING);
}

PetscErrorCode snes_function(SNES snes, Vec x, Vec F, void* data) {
  OnGrid* grid = nullptr;
  ++run_of(data).evaluations;
  PetscCall(grid_of(snes, data, &grid));
  return evaluate(grid->problem, x, F);
}
PetscErrorCode snes_jacobian(SNES snes, Vec x, Mat, Mat J, void* data) {
  OnGrid* grid = nullptr;
  PetscCall(grid_of(snes, data, &grid));
  return jacobian(grid->problem, x, J);
}
PetscErrorCode snes_bounds(SNES snes, Vec lower, Vec upper) {
  OnGrid* grid = nullptr;
  void* data = nullptr;
  PetscCall(SNESGetApplicationContext(snes, static_cast<void*>(&data)));
  PetscCall(grid_of(snes, data, &grid));
  return bounds(grid->problem, lower, upper);
}
const GridProblem& problem_of(void* data) { return run_of(data).grids[0]->problem; }
PetscErrorCode tao_objective(Tao, Vec x, PetscReal* value, Vec F, void* data) {
  ++run_of(data).evaluations;
  return objective(problem_of(data), x, value, F);
}
PetscErrorCode tao_gradient(Tao, Vec x, Vec F, void* data) { return evaluate(problem_of(data), x, F); }
PetscErrorCode tao_hessian(Tao, Vec x, Mat J, Mat, void* data) { return jacobian(problem_of(data), x, J); }

PetscErrorCode by_snes(Run& r) {
  SNES snes = nullptr;
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  const char* words = nullptr;
  Vec solution = nullptr;
  OnGrid* grid = nullptr;
  bool done = false;
  PetscBool own = PETSC_FALSE;
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetDM(snes, problem_of(&r).dm));
  PetscCall(SNESSetApplicationContext(snes, &r));
  PetscCall(SNESSetFunction(snes, nullptr, snes_function, &r));
  PetscCall(SNESSetJacobian(snes, nullptr, nullptr, snes_jacobian, &r));
  PetscCall(SNESVISetComputeVariableBounds(snes, snes_bounds));
  PetscCall(SNESSetTolerances(snes, tol, 0, 0, 10000, 1000000));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESSetConvergenceTest(snes, snes_test, &r, nullptr));
  start(r);
  PetscCall(SNESSolve(snes, nullptr, r.x));
  stop(r);
  PetscCall(SNESGetIterationNumber(snes, &r.steps));
  PetscCall(SNESGetLinearSolveIterations(snes, &r.krylov));
  PetscCall(SNESGetConvergedReason(snes, &reason));
  PetscCall(SNESGetConvergedReasonString(snes, &words));
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(snes), petsc::snes_type, &own));
  r.reason = words;
  if (own) {
    petsc::Counts counts;
    PetscCall(petsc::counts_of(snes, &counts));
    r.cycles = counts.cycles;
  }
  PetscCall(SNESGetSolution(snes, &solution));
  PetscCall(grid_of(snes, &r, &grid));
  PetscCall(VecGetSize(solution, &r.size));
  PetscCall(look(r, *grid, solution, &done));
  r.solved = done;
  return SNESDestroy(&snes);
}

PetscErrorCode by_tao(Run& r) {
  Tao tao = nullptr;
  TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
  const OnGrid& grid = *r.grids[0];
  Mat J = nullptr;
  PetscCall(DMCreateMatrix(grid.problem.dm, &J));
  PetscCall(TaoCreate(PETSC_COMM_WORLD, &tao));
  PetscCall(TaoSetSolution(tao, r.x));
  PetscCall(TaoSetObjectiveAndGradient(tao, nullptr, tao_objective, &r));
  PetscCall(TaoSetGradient(tao, nullptr, tao_gradient, &r));
  PetscCall(TaoSetHessian(tao, J, J, tao_hessian, &r));
  PetscCall(TaoSetVariableBounds(tao, grid.lower, grid.upper));
  PetscCall(TaoSetTolerances(tao, 0, 0, 0));
  PetscCall(TaoSetMaximumIterations(tao, 10000));
  PetscCall(TaoSetFromOptions(tao));
  PetscCall(TaoSetConvergenceTest(tao, tao_test, &r));
  start(r);
  PetscCall(TaoSolve(tao));
  stop(r);
  PetscCall(TaoGetIterationNumber(tao, &r.steps));
  PetscCall(TaoGetLinearSolveIterations(tao, &r.krylov));
  PetscCall(TaoGetConvergedReason(tao, &reason));
  r.reason = TaoConvergedReasons[reason];
  PetscCall(look(r, *r.grids[0], r.x, &r.solved));
  PetscCall(MatDestroy(&J));
  return TaoDestroy(&tao);
}

/// J x = 1 by PETSc's KSP alone, from its setup to 1e-8 of the right-hand side: what two ranks bring there.
PetscErrorCode by_ksp(Run& r) {
  KSP ksp = nullptr;
  Mat J = nullptr;
  const Vec b = r.grids[0]->F;
  PetscCall(DMCreateMatrix(problem_of(&r).dm, &J));
  PetscCall(jacobian(problem_of(&r), r.x, J));
  PetscCall(VecSet(b, 1));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetFromOptions(ksp));
  start(r);
  PetscCall(KSPSetOperators(ksp, J, J));
  PetscCall(KSPSolve(ksp, b, r.x));
  stop(r);
  PetscCall(KSPGetIterationNumber(ksp, &r.krylov));
  r.solved = true;
  PetscCall(MatDestroy(&J));
  return KSPDestroy(&ksp);
}

PetscErrorCode measure(const std::string& problem, PetscInt points, double limit, const std::string& solver) {
  Run r;
  int ranks = 0;
  PetscInt refinements = 0;
  r.name = problem;
  r.limit = limit;
  PetscCall(PetscOptionsGetInt(nullptr, nullptr, "-snes_grid_sequence", &refinements, nullptr));
  r.grids.push_back(std::make_unique<OnGrid>());
  OnGrid& grid = *r.grids[0];
  PetscCall(make_problem(problem, ((points - 1) >> refinements) + 1, &grid.problem));
  PetscCall(complete(&grid));
  PetscCall(DMCreateGlobalVector(grid.problem.dm, &r.x));
  PetscCall(petsc::project({grid.lower, grid.upper}, r.x));
  PetscCall(VecGetSize(r.x, &r.size));
  PetscCall(solver == "ksp" ? by_ksp(r) : solver == "tao" ? by_tao(r) : by_snes(r));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  long kilobytes = usage.ru_maxrss;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &kilobytes, 1, MPI_LONG, MPI_MAX, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  int rank = 0;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0)
    std::printf(
        "{\"problem\": \"%s\", \"unknowns\": %d, \"ranks\": %d, \"solved\": %s, \"residual\": %g, \"steps\": %d, "
        "\"krylov\": %d, \"cycles\": %d, \"F\": %d, \"seconds\": %.4f, \"cpu\": %.4f, \"megabytes\": %ld, \"reason\": "
        "\"%s\"}\n",
        problem.c_str(), static_cast<int>(r.size), ranks, r.solved ? "true" : "false", static_cast<double>(r.residual),
        static_cast<int>(r.steps), static_cast<int>(r.krylov), static_cast<int>(r.cycles),
        static_cast<int>(r.evaluations), r.seconds, r.processor, kilobytes / 1024, r.reason.c_str());
  for (const auto& g : r.grids) {
    for (Vec* v : {&g->F, &g->lower, &g->upper, &g->projected}) PetscCall(VecDestroy(v));
    PetscCall(destroy(&g->problem));
  }
  return VecDestroy(&r.x);
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "bench_petsc PROBLEM POINTS CPU_SECONDS perp|snesvi|tao|ksp [PETSC OPTIONS]\n");
    return 2;
  }
  const std::string problem = argv[1];
  const std::string solver = argv[4];
  const int points = std::atoi(argv[2]);
  const double limit = std::atof(argv[3]);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr) != 0) return 1;
  int code = static_cast<int>(perp::petsc::register_snes_perp());
  if (solver == "perp") PetscOptionsSetValue(nullptr, "-snes_type", "perp");
  if (code == 0) code = static_cast<int>(perp::bench::measure(problem, points, limit, solver));
  PetscFinalize();
  return code == 0 ? 0 : 1;
}
