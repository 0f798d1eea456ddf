// SPDX-License-Identifier: Apache-2.0
#include "petsc/mpi/run.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "petsc/box.hpp"
#include "petsc/mpi/read.hpp"

namespace perp::petsc {
namespace {

struct Problem {
  OwnMat M;
  OwnVec q, lower, upper, x, F;
  const Task* task = nullptr;
  Outcome* outcome = nullptr;
  std::FILE* log = nullptr;  ///< null: no log here
  double started = 0;
  bool late = false;
};
Problem& problem_of(void* data) { return *static_cast<Problem*>(data); }

PetscErrorCode evaluate(SNES, Vec x, Vec F, void* data) {
  Problem& p = problem_of(data);
  return MatMultAdd(p.M, x, p.q, F);
}
PetscErrorCode same_matrix(SNES, Vec, Mat, Mat, void*) { return ok; }

/// Perp's test, by the largest entry of the natural residual, and the time; the same on every rank.
PetscErrorCode test(SNES snes, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason* reason, void* data) {
  Problem& p = problem_of(data);
  Counts counts;
  PetscCall(counts_of(snes, &counts));
  int late = MPI_Wtime() - p.started > p.task->time_limit ? 1 : 0;
  PetscCallMPI(MPI_Bcast(&late, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  p.late = late != 0;
  *reason = counts.worst <= p.task->tol ? SNES_CONVERGED_FNORM_ABS
            : p.late                    ? SNES_DIVERGED_MAX_IT
                                        : SNES_CONVERGED_ITERATING;
  return ok;
}

PetscErrorCode monitor(SNES snes, PetscInt k, PetscReal, void* data) {
  Problem& p = problem_of(data);
  Counts counts;
  Record r{.k = k};
  PetscCall(counts_of(snes, &counts));
  PetscCall(SNESGetNumberFunctionEvals(snes, &r.F_evals));
  PetscCall(SNESGetLinearSolveIterations(snes, &r.krylov));
  r.residual = counts.worst;
  r.row = counts.row;
  r.J_evals = counts.jacobians;
  r.face = counts.face;
  p.outcome->records.push_back(r);
  if (p.log == nullptr) return ok;
  if (k == 0) std::fprintf(p.log, "\nMajor Iteration Log\nmajor krylov  func  grad       inside      inorm (row)\n");
  std::fprintf(p.log, "%5d %6d %5d %5d %12lld %10.4e (%d)\n", static_cast<int>(k), static_cast<int>(r.krylov),
               static_cast<int>(r.F_evals), static_cast<int>(r.J_evals), static_cast<long long>(r.face),
               static_cast<double>(r.residual), static_cast<int>(r.row) + 1);
  std::fflush(p.log);
  return ok;
}

/// A number for all, or a file.
PetscErrorCode read_bound(const std::string& text, Mat M, OwnVec& v, std::string& wrong) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return read_vector(text, M, true, v, wrong);
  PetscCall(MatCreateVecs(M, nullptr, v.out()));
  if (std::isnan(value)) wrong = "a bound is not a number";
  return VecSet(v, std::abs(value) < infinite ? value : value > 0 ? PETSC_INFINITY : PETSC_NINFINITY);
}

/// Found out before the solve: PETSc would stop on rank 0 alone, and the others would wait for it.
PetscErrorCode check_solution_file(const std::string& path, std::string& wrong) {
  int rank = 0;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0 && !path.empty() && !std::ofstream(path, std::ios::app)) wrong = path + ": cannot be written";
  return share(wrong);
}

PetscErrorCode read_problem(const Task& task, Problem& p, std::string& wrong) {
  PetscCall(read_matrix(task.matrix, p.M, wrong));
  if (wrong.empty()) PetscCall(read_vector(task.vector, p.M, false, p.q, wrong));
  if (wrong.empty()) PetscCall(read_bound(task.lower, p.M, p.lower, wrong));
  if (wrong.empty()) PetscCall(read_bound(task.upper, p.M, p.upper, wrong));
  if (wrong.empty()) PetscCall(check_solution_file(task.solution, wrong));
  if (!wrong.empty()) return ok;
  PetscCall(VecDuplicate(p.q, p.F.out()));
  if (!task.start.empty()) return read_vector(task.start, p.M, false, p.x, wrong);
  PetscCall(VecDuplicate(p.q, p.x.out()));
  return VecSet(p.x, 0);
}

Status status_of(SNESConvergedReason reason, const Problem& p) {
  switch (reason) {
    case SNES_CONVERGED_FNORM_ABS:
      return Status::Solved;
    case SNES_CONVERGED_SNORM_RELATIVE:
      return p.outcome->counts.worst <= p.task->tol ? Status::Solved : Status::SolvedToRounding;
    case SNES_DIVERGED_MAX_IT:
      return p.late ? Status::TimeLimit : Status::IterationLimit;
    case SNES_DIVERGED_INNER:
      return Status::Interrupted;
    case SNES_DIVERGED_LINEAR_SOLVE:
      return Status::LinearAlgebraFailed;
    case SNES_DIVERGED_FNORM_NAN:
    case SNES_DIVERGED_FUNCTION_DOMAIN:
      return Status::EvaluationFailed;
    default:
      return Status::NoProgress;
  }
}

std::string advice_for(Status status) {
  switch (status) {
    case Status::LinearAlgebraFailed:
      return "another solver on the face: --petsc '-pc_type gamg', or '-ksp_type preonly -pc_type lu "
             "-pc_factor_mat_solver_type mumps'";
    case Status::NoProgress:
    case Status::IterationLimit:
      return "on one machine perp solve has pivoting and path search: Lemke, PATH's algorithm";
    default:
      return {};
  }
}

/// The largest violation of the bounds, and of complementarity.
PetscErrorCode judge(const Problem& p) {
  double largest[3] = {0, 0, 0};
  {
    const Reading l(p.lower);
    const Reading u(p.upper);
    const Reading x(p.x);
    const Reading F(p.F);
    for (PetscInt i = 0; i < x.size(); ++i) {
      largest[0] = std::max({largest[0], l[i] - x[i], x[i] - u[i]});
      largest[1] = std::max({largest[1], std::min(x[i] - l[i], F[i]), std::min(u[i] - x[i], -F[i])});
    }
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  largest[2] = 1024.0 * static_cast<double>(usage.ru_maxrss);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 3, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD));
  p.outcome->bounds = largest[0];
  p.outcome->complementarity = largest[1];
  p.outcome->memory = largest[2];
  return ok;
}

/// F needs M as it is; -snes_fd would overwrite it.
PetscErrorCode check_jacobian(SNES snes, Mat M, std::string& refused) {
  Mat matrices[2] = {nullptr, nullptr};
  PetscErrorCode (*function)(SNES, Vec, Mat, Mat, void*) = nullptr;
  PetscCall(SNESGetJacobian(snes, &matrices[0], &matrices[1], &function, nullptr));
  if (matrices[0] != M || matrices[1] != M || function != same_matrix)
    refused = "the Jacobian is M: -snes_fd, -snes_mf and their like are not taken";
  return ok;
}

PetscErrorCode solve(Problem& p, std::string& refused) {
  Handle<SNES, SNESDestroy> snes;
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  const char* words = nullptr;
  Outcome& o = *p.outcome;
  PetscCall(SNESCreate(PETSC_COMM_WORLD, snes.out()));
  PetscCall(SNESSetType(snes, snes_type));
  PetscCall(SNESSetFunction(snes, p.F, evaluate, &p));
  PetscCall(SNESSetJacobian(snes, p.M, p.M, same_matrix, nullptr));
  PetscCall(SNESVISetVariableBounds(snes, p.lower, p.upper));
  PetscCall(SNESSetTolerances(snes, p.task->tol, 0, 0, p.task->max_iterations, PETSC_MAX_INT));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(check_jacobian(snes, p.M, refused));
  if (!refused.empty()) return ok;
  PetscCall(SNESSetConvergenceTest(snes, test, &p, nullptr));
  PetscCall(SNESMonitorSet(snes, monitor, &p, nullptr));
  PetscCall(SNESSolve(snes, nullptr, p.x));
  PetscCall(SNESGetConvergedReason(snes, &reason));
  PetscCall(SNESGetConvergedReasonString(snes, &words));
  PetscCall(counts_of(snes, &o.counts));
  PetscCall(SNESGetIterationNumber(snes, &o.iterations));
  PetscCall(SNESGetNumberFunctionEvals(snes, &o.F_evals));
  PetscCall(SNESGetLinearSolveIterations(snes, &o.krylov));
  o.status = status_of(reason, p);
  o.message = o.status == Status::Solved ? "solution found" : std::string("PETSc's reason: ") + words;
  o.advice = advice_for(o.status);
  PetscCall(evaluate(snes, p.x, p.F, &p));
  return judge(p);
}

PetscErrorCode write_solution(const std::string& path, Vec x) {
  PetscViewer viewer = nullptr;
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, path.c_str(), FILE_MODE_WRITE, &viewer));
  PetscCall(PetscViewerBinarySetSkipInfo(viewer, PETSC_TRUE));
  PetscCall(VecView(x, viewer));
  return PetscViewerDestroy(&viewer);
}

}  // namespace

PetscErrorCode run(const Task& task, std::FILE* log, Outcome& o, std::string& refused) {
  Problem p;
  p.task = &task;
  p.outcome = &o;
  p.log = log;
  double now = MPI_Wtime();
  PetscCall(PetscOptionsInsertString(nullptr, task.petsc.c_str()));
  PetscCall(read_problem(task, p, refused));
  if (!refused.empty()) return ok;
  MatInfo info;
  PetscCall(MatGetInfo(p.M, MAT_GLOBAL_SUM, &info));
  PetscCall(MatGetSize(p.M, &o.size, nullptr));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &o.ranks));
  o.nonzeros = info.nz_used;
  p.started = MPI_Wtime();
  o.read_seconds = p.started - now;
  if (log != nullptr)
    std::fprintf(log, "%s: %d variables, %.0f nonzeros in the Jacobian, %d ranks; method snes-perp\n",
                 task.matrix.c_str(), static_cast<int>(o.size), o.nonzeros, o.ranks);
  PetscCall(solve(p, refused));
  if (!refused.empty()) return ok;
  o.seconds = MPI_Wtime() - p.started;
  return task.solution.empty() ? ok : write_solution(task.solution, p.x);
}

}  // namespace perp::petsc
