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
#include <cstring>
#include <string>

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

struct Run {
  GridProblem problem;
  Vec x = nullptr, F = nullptr, lower = nullptr, upper = nullptr, projected = nullptr;
  Mat J = nullptr;
  double started = 0, limit = 0, seconds = 0, processor = 0;
  bool late = false, gradient = false;
  PetscReal residual = 0;
  PetscInt steps = 0, krylov = 0, cycles = 0, evaluations = 0;
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

/// The residual at the projected point, and the time, the same on every rank.
PetscErrorCode look(Run& r, Vec x, bool* done) {
  petsc::Residual residual;
  const petsc::Box box{r.lower, r.upper};
  PetscCall(VecCopy(x, r.projected));
  PetscCall(petsc::project(box, r.projected));
  PetscCall(evaluate(r.problem, r.projected, r.F));
  PetscCall(petsc::natural_residual(box, r.projected, r.F, &residual));
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
  bool done = false;
  PetscCall(SNESGetSolution(snes, &x));
  PetscCall(look(r, x, &done));
  *reason = done ? SNES_CONVERGED_FNORM_ABS : r.late ? SNES_DIVERGED_MAX_IT : SNES_CONVERGED_ITERATING;
  return 0;
}

PetscErrorCode tao_test(Tao tao, void* data) {
  Run& r = run_of(data);
  Vec x = nullptr;
  bool done = false;
  PetscCall(TaoGetSolution(tao, &x));
  PetscCall(look(r, x, &done));
  return TaoSetConvergedReason(tao, done ? TAO_CONVERGED_USER : r.late ? TAO_DIVERGED_MAXITS : TAO_CONTINUE_ITERATING);
}

PetscErrorCode snes_function(SNES, Vec x, Vec F, void* data) {
  ++run_of(data).evaluations;
  return evaluate(run_of(data).problem, x, F);
}
PetscErrorCode snes_jacobian(SNES, Vec x, Mat, Mat J, void* data) { return jacobian(run_of(data).problem, x, J); }
PetscErrorCode tao_objective(Tao, Vec x, PetscReal* value, Vec F, void* data) {
  ++run_of(data).evaluations;
  return objective(run_of(data).problem, x, value, F);
}
PetscErrorCode tao_gradient(Tao, Vec x, Vec F, void* data) { return evaluate(run_of(data).problem, x, F); }
PetscErrorCode tao_hessian(Tao, Vec x, Mat J, Mat, void* data) { return jacobian(run_of(data).problem, x, J); }

PetscErrorCode by_snes(Run& r) {
  SNES snes = nullptr;
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  const char* words = nullptr;
  Vec F = nullptr;
  PetscBool own = PETSC_FALSE;
  PetscCall(VecDuplicate(r.F, &F));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetDM(snes, r.problem.dm));
  PetscCall(SNESSetFunction(snes, F, snes_function, &r));
  PetscCall(SNESSetJacobian(snes, r.J, r.J, snes_jacobian, &r));
  PetscCall(SNESVISetVariableBounds(snes, r.lower, r.upper));
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
  PetscCall(VecDestroy(&F));
  return SNESDestroy(&snes);
}

PetscErrorCode by_tao(Run& r) {
  Tao tao = nullptr;
  TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
  PetscCall(TaoCreate(PETSC_COMM_WORLD, &tao));
  PetscCall(TaoSetSolution(tao, r.x));
  PetscCall(TaoSetObjectiveAndGradient(tao, nullptr, tao_objective, &r));
  PetscCall(TaoSetGradient(tao, nullptr, tao_gradient, &r));
  PetscCall(TaoSetHessian(tao, r.J, r.J, tao_hessian, &r));
  PetscCall(TaoSetVariableBounds(tao, r.lower, r.upper));
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
  return TaoDestroy(&tao);
}

/// J x = 1 by PETSc's KSP alone, from its setup to 1e-8 of the right-hand side: what two ranks bring there.
PetscErrorCode by_ksp(Run& r) {
  KSP ksp = nullptr;
  PetscCall(jacobian(r.problem, r.x, r.J));
  PetscCall(VecSet(r.F, 1));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetFromOptions(ksp));
  start(r);
  PetscCall(KSPSetOperators(ksp, r.J, r.J));
  PetscCall(KSPSolve(ksp, r.F, r.x));
  stop(r);
  PetscCall(KSPGetIterationNumber(ksp, &r.krylov));
  return KSPDestroy(&ksp);
}

PetscErrorCode measure(const std::string& problem, PetscInt points, double limit, const std::string& solver) {
  Run r;
  int ranks = 0;
  bool done = false;
  PetscInt size = 0;
  r.limit = limit;
  PetscCall(make_problem(problem, points, &r.problem, &r.lower, &r.upper, &r.J));
  for (Vec* v : {&r.x, &r.F, &r.projected}) PetscCall(DMCreateGlobalVector(r.problem.dm, v));
  PetscCall(VecSet(r.x, 0));
  PetscCall(petsc::project({r.lower, r.upper}, r.x));
  PetscCall(VecGetSize(r.x, &size));
  PetscCall(solver == "ksp" ? by_ksp(r) : solver == "tao" ? by_tao(r) : by_snes(r));
  if (solver != "ksp") PetscCall(look(r, r.x, &done));
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
        problem.c_str(), static_cast<int>(size), ranks, done || solver == "ksp" ? "true" : "false",
        static_cast<double>(r.residual), static_cast<int>(r.steps), static_cast<int>(r.krylov),
        static_cast<int>(r.cycles), static_cast<int>(r.evaluations), r.seconds, r.processor, kilobytes / 1024,
        r.reason.c_str());
  for (Vec* v : {&r.x, &r.F, &r.projected, &r.lower, &r.upper}) PetscCall(VecDestroy(v));
  PetscCall(MatDestroy(&r.J));
  return destroy(&r.problem);
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
