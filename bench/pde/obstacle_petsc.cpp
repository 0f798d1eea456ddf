/// PETSc on the obstacle problem: SNESVI (reduced-space and semismooth Newton) and TAO's bound-constrained methods.
#include <petsc.h>

#include <algorithm>
#include <chrono>

#include "obstacle.hpp"

namespace perp::bench {
namespace {

struct Solver {
  const char* name;
  bool tao;  ///< TAO, else SNES
  const char* options;
};

// Each kind with the direct solver MUMPS, with hypre's algebraic multigrid or with PETSc's default for it. PETSc's own
// GAMG is not among them: SNESVI stopped with it in the first step (PETSc 3.18).
constexpr Solver solvers[] = {
    {"PETSc SNESVI rsls, MUMPS", false,
     "-snes_type vinewtonrsls -ksp_type preonly -pc_type cholesky "
     "-pc_factor_mat_solver_type mumps"},
    {"PETSc SNESVI rsls, CG + BoomerAMG", false, "-snes_type vinewtonrsls -ksp_type cg -pc_type hypre -ksp_rtol 1e-3"},
    {"PETSc SNESVI ssls, GMRES + BoomerAMG", false, "-snes_type vinewtonssls -ksp_type gmres -pc_type hypre"},
    {"PETSc TAO gpcg", true, "-tao_type gpcg"},
    {"PETSc TAO gpcg, BoomerAMG", true, "-tao_type gpcg -pc_type hypre"},
    {"PETSc TAO tron", true, "-tao_type tron"},
    {"PETSc TAO tron, BoomerAMG", true, "-tao_type tron -pc_type hypre"},
    {"PETSc TAO bntr", true, "-tao_type bntr"},
    {"PETSc TAO bncg", true, "-tao_type bncg"},
};

struct Context {
  Mat M = nullptr;
  Vec q = nullptr;
  Vec lower = nullptr;
  Vec gap = nullptr;
  Vec F = nullptr;
  double tol = 0;
};

/// || min(z - l, M z + q) ||_inf
PetscReal natural_residual(Context& c, Vec z) {
  PetscReal norm = 0;
  VecWAXPY(c.gap, -1, c.lower, z);
  MatMultAdd(c.M, z, c.q, c.F);
  VecPointwiseMin(c.gap, c.gap, c.F);
  VecNorm(c.gap, NORM_INFINITY, &norm);
  return norm;
}

PetscErrorCode function(SNES, Vec z, Vec F, void* context) {
  auto& c = *static_cast<Context*>(context);
  return MatMultAdd(c.M, z, c.q, F);
}

/// Filled every time: the semismooth method scales what it is given.
PetscErrorCode jacobian(SNES, Vec, Mat J, Mat, void* context) {
  return MatCopy(static_cast<Context*>(context)->M, J, SAME_NONZERO_PATTERN);
}

/// Converged by the natural residual, as everybody is judged.
PetscErrorCode snes_test(SNES snes, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason* reason,
                         void* context) {
  auto& c = *static_cast<Context*>(context);
  Vec z = nullptr;
  SNESGetSolution(snes, &z);
  *reason = natural_residual(c, z) <= c.tol ? SNES_CONVERGED_FNORM_ABS : SNES_CONVERGED_ITERATING;
  return 0;
}

PetscErrorCode objective(Tao, Vec z, PetscReal* phi, Vec g, void* context) {
  auto& c = *static_cast<Context*>(context);
  MatMult(c.M, z, g);
  PetscReal linear = 0;
  VecDot(z, g, phi);
  VecDot(z, c.q, &linear);
  *phi = 0.5 * *phi + linear;
  return VecAXPY(g, 1, c.q);
}

PetscErrorCode hessian(Tao, Vec, Mat, Mat, void*) { return 0; }

PetscErrorCode tao_test(Tao tao, void* context) {
  auto& c = *static_cast<Context*>(context);
  Vec z = nullptr;
  TaoGetSolution(tao, &z);
  PetscInt iterations = 0;
  TaoGetIterationNumber(tao, &iterations);
  constexpr PetscInt most = 1000;
  TaoSetConvergedReason(tao, natural_residual(c, z) <= c.tol ? TAO_CONVERGED_USER
                             : iterations > most             ? TAO_DIVERGED_MAXITS
                                                             : TAO_CONTINUE_ITERATING);
  return 0;
}

std::string solve_snes(Context& c, Vec z, Vec upper) {
  SNES snes = nullptr;
  SNESCreate(PETSC_COMM_SELF, &snes);
  Vec F = nullptr;
  VecDuplicate(z, &F);
  SNESSetFunction(snes, F, function, &c);
  Mat J = nullptr;
  MatDuplicate(c.M, MAT_COPY_VALUES, &J);
  SNESSetJacobian(snes, J, J, jacobian, &c);
  SNESSetTolerances(snes, 0, 0, 0, 500, 1000000);
  SNESSetFromOptions(snes);
  SNESVISetVariableBounds(snes, c.lower, upper);
  SNESSetConvergenceTest(snes, snes_test, &c, nullptr);
  SNESSolve(snes, nullptr, z);
  PetscInt iterations = 0;
  SNESGetIterationNumber(snes, &iterations);
  const char* reason = nullptr;
  SNESGetConvergedReasonString(snes, &reason);
  std::string remark = std::to_string(iterations) + " iterations, " + reason;
  SNESDestroy(&snes);
  MatDestroy(&J);
  VecDestroy(&F);
  return remark;
}

std::string solve_tao(Context& c, Vec z, Vec upper) {
  Tao tao = nullptr;
  TaoCreate(PETSC_COMM_SELF, &tao);
  TaoSetSolution(tao, z);
  TaoSetObjectiveAndGradient(tao, nullptr, objective, &c);
  TaoSetHessian(tao, c.M, c.M, hessian, &c);
  TaoSetVariableBounds(tao, c.lower, upper);
  TaoSetTolerances(tao, 0, 0, 0);
  TaoSetFromOptions(tao);
  TaoSetConvergenceTest(tao, tao_test, &c);
  TaoSolve(tao);
  PetscInt iterations = 0;
  TaoGetIterationNumber(tao, &iterations);
  TaoDestroy(&tao);
  return std::to_string(iterations) + " iterations";
}

Vec wrap(lcp::Vec& v) {
  Vec x = nullptr;
  VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(v.size()), v.data(), &x);
  return x;
}

Measurement run(const Solver& solver, const lcp::AffineMcp& problem, const lcp::Vec& start, double tol) {
  Measurement m{.solver = solver.name, .seconds = 0, .z = start, .remark = {}};
  PetscOptionsClear(nullptr);
  PetscOptionsInsertString(nullptr, solver.options);
  // Copies: some solvers write into what they are given.
  lcp::SpMat M = problem.M;
  lcp::Vec q = problem.q;
  lcp::Vec lower = problem.box.lower;
  const auto n = static_cast<PetscInt>(M.rows());
  lcp::Vec infinite = lcp::Vec::Constant(M.rows(), PETSC_INFINITY);
  Context c{.M = nullptr, .q = wrap(q), .lower = wrap(lower), .gap = nullptr, .F = nullptr, .tol = tol};
  Vec z = wrap(m.z);
  Vec upper = wrap(infinite);
  VecDuplicate(z, &c.gap);
  VecDuplicate(z, &c.F);
  // Symmetric: its columns are its rows.
  MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, M.outerIndexPtr(), M.innerIndexPtr(), M.valuePtr(), &c.M);
  MatSetOption(c.M, MAT_SYMMETRIC, PETSC_TRUE);
  MatSetOption(c.M, MAT_SPD, PETSC_TRUE);
  const auto begin = std::chrono::steady_clock::now();
  m.remark = solver.tao ? solve_tao(c, z, upper) : solve_snes(c, z, upper);
  m.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (Vec* v : {&c.q, &c.lower, &c.gap, &c.F, &z, &upper}) VecDestroy(v);
  MatDestroy(&c.M);
  return m;
}

}  // namespace

std::vector<Measurement> petsc(const lcp::AffineMcp& problem, const lcp::Vec& start, double tol,
                               const std::vector<std::string>& skip) {
  PetscInitializeNoArguments();
  PetscPopSignalHandler();
  PetscPushErrorHandler(PetscIgnoreErrorHandler,
                        nullptr);  // a solver that fails is measured as one that does not solve
  std::vector<Measurement> results;
  for (const Solver& solver : solvers)
    if (std::find(skip.begin(), skip.end(), solver.name) == skip.end())
      results.push_back(run(solver, problem, start, tol));
  return results;
}

}  // namespace perp::bench
