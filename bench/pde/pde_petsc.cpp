/// PETSc on complementarity problems: TAO's semismooth methods and SNESVI, each with several linear solvers.
#include <petsc.h>

#include <algorithm>
#include <chrono>

#include "pde.hpp"

namespace perp::bench {
namespace {

struct Solver {
  const char* name;
  bool tao;  ///< TAO, else SNES
  const char* options;
};

constexpr Solver solvers[] = {
    {"TAO ssils, MUMPS", true, "-tao_type ssils -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"},
    {"TAO ssils, GMRES + ILU", true, "-tao_type ssils -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5"},
    {"TAO ssils, GMRES + BoomerAMG", true, "-tao_type ssils -ksp_type gmres -pc_type hypre -ksp_rtol 1e-5"},
    {"TAO ssfls, MUMPS", true, "-tao_type ssfls -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"},
    {"TAO ssfls, GMRES + ILU", true, "-tao_type ssfls -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5"},
    {"TAO ssfls, GMRES + BoomerAMG", true, "-tao_type ssfls -ksp_type gmres -pc_type hypre -ksp_rtol 1e-5"},
    {"TAO asils, MUMPS", true, "-tao_type asils -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"},
    {"TAO asils, GMRES + ILU", true, "-tao_type asils -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5"},
    {"TAO asils, GMRES + BoomerAMG", true, "-tao_type asils -ksp_type gmres -pc_type hypre -ksp_rtol 1e-5"},
    {"TAO asfls, MUMPS", true, "-tao_type asfls -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"},
    {"TAO asfls, GMRES + ILU", true, "-tao_type asfls -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5"},
    {"TAO asfls, GMRES + BoomerAMG", true, "-tao_type asfls -ksp_type gmres -pc_type hypre -ksp_rtol 1e-5"},
    {"SNESVI rsls, MUMPS", false,
     "-snes_type vinewtonrsls -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"},
    {"SNESVI rsls, CG + ILU", false, "-snes_type vinewtonrsls -ksp_type cg -pc_type icc -ksp_rtol 1e-5"},
    {"SNESVI rsls, CG + BoomerAMG", false, "-snes_type vinewtonrsls -ksp_type cg -pc_type hypre -ksp_rtol 1e-5"},
    {"SNESVI rsls, CG + BoomerAMG 1e-3", false, "-snes_type vinewtonrsls -ksp_type cg -pc_type hypre -ksp_rtol 1e-3"},
    {"SNESVI ssls, MUMPS", false,
     "-snes_type vinewtonssls -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"},
    {"SNESVI ssls, GMRES + ILU", false, "-snes_type vinewtonssls -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5"},
    {"SNESVI ssls, GMRES + BoomerAMG", false, "-snes_type vinewtonssls -ksp_type gmres -pc_type hypre -ksp_rtol 1e-5"},
};

using Clock = std::chrono::steady_clock;

struct Context {
  const ncp::Mcp* mcp = nullptr;
  ncp::SpMat J{};
  ncp::SpMat rows{};  ///< J', whose columns are the rows of J
  bool constant = false;
  Vec lower = nullptr;
  Vec upper = nullptr;
  Vec F = nullptr;
  Vec gap = nullptr;
  double tol = 0;
  Clock::time_point deadline{};
  bool late = false;
};

Eigen::Map<const ncp::Vec> view(Vec v, const PetscScalar*& array) {
  PetscInt n = 0;
  VecGetLocalSize(v, &n);
  VecGetArrayRead(v, &array);
  return {array, n};
}

PetscErrorCode evaluate(Context& c, Vec x, Vec F) {
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  const auto point = view(x, in);
  VecGetArray(F, &out);
  const bool defined = c.mcp->eval(point, Eigen::Map<ncp::Vec>(out, point.size()));
  VecRestoreArray(F, &out);
  VecRestoreArrayRead(x, &in);
  return defined ? 0 : PETSC_ERR_FP;
}

/// Filled every time, for the semismooth methods scale what they are given.
PetscErrorCode fill(Context& c, Vec x, Mat J) {
  if (!c.constant) {
    const PetscScalar* in = nullptr;
    const auto point = view(x, in);
    if (!c.mcp->jacobian(point, c.J)) return PETSC_ERR_FP;
    VecRestoreArrayRead(x, &in);
    c.rows = c.J.transpose();
  }
  PetscScalar* values = nullptr;
  MatSeqAIJGetArray(J, &values);
  std::copy_n(c.rows.valuePtr(), c.rows.nonZeros(), values);
  MatSeqAIJRestoreArray(J, &values);
  MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY);
  return MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY);
}

/// || x - mid(l, x - F, u) ||_inf of the projection of x.
PetscReal natural_residual(Context& c, Vec x) {
  const PetscScalar* in = nullptr;
  const auto point = view(x, in);
  const ncp::Vec z = lcp::project(c.mcp->box(), point);
  ncp::Vec F(z.size());
  const bool defined = c.mcp->eval(z, F);
  VecRestoreArrayRead(x, &in);
  return defined ? (z - lcp::project(c.mcp->box(), z - F)).lpNorm<Eigen::Infinity>() : PETSC_INFINITY;
}

PetscErrorCode snes_function(SNES, Vec x, Vec F, void* c) { return evaluate(*static_cast<Context*>(c), x, F); }
PetscErrorCode snes_jacobian(SNES, Vec x, Mat J, Mat, void* c) { return fill(*static_cast<Context*>(c), x, J); }
PetscErrorCode tao_function(Tao, Vec x, Vec F, void* c) { return evaluate(*static_cast<Context*>(c), x, F); }
PetscErrorCode tao_jacobian(Tao, Vec x, Mat J, Mat, void* c) { return fill(*static_cast<Context*>(c), x, J); }

/// Converged by the natural residual, as everybody is judged.
PetscErrorCode snes_test(SNES snes, PetscInt it, PetscReal, PetscReal, PetscReal, SNESConvergedReason* reason,
                         void* context) {
  auto& c = *static_cast<Context*>(context);
  Vec x = nullptr;
  SNESGetSolution(snes, &x);
  c.late = Clock::now() > c.deadline;
  *reason = natural_residual(c, x) <= c.tol ? SNES_CONVERGED_FNORM_ABS
            : c.late || it >= 500           ? SNES_DIVERGED_MAX_IT
                                            : SNES_CONVERGED_ITERATING;
  return 0;
}

PetscErrorCode tao_test(Tao tao, void* context) {
  auto& c = *static_cast<Context*>(context);
  Vec x = nullptr;
  TaoGetSolution(tao, &x);
  PetscInt it = 0;
  TaoGetIterationNumber(tao, &it);
  c.late = Clock::now() > c.deadline;
  TaoSetConvergedReason(tao, natural_residual(c, x) <= c.tol ? TAO_CONVERGED_USER
                             : c.late || it >= 500           ? TAO_DIVERGED_MAXITS
                                                             : TAO_CONTINUE_ITERATING);
  return 0;
}

/// Both answer the iterations.
int solve_snes(Context& c, Mat J, Vec x, std::string& remark) {
  SNES snes = nullptr;
  SNESCreate(PETSC_COMM_SELF, &snes);
  SNESSetFunction(snes, c.F, snes_function, &c);
  SNESSetJacobian(snes, J, J, snes_jacobian, &c);
  SNESSetTolerances(snes, 0, 0, 0, 500, 1000000);
  SNESSetFromOptions(snes);
  SNESVISetVariableBounds(snes, c.lower, c.upper);
  SNESSetConvergenceTest(snes, snes_test, &c, nullptr);
  SNESSolve(snes, nullptr, x);
  PetscInt iterations = 0;
  SNESGetIterationNumber(snes, &iterations);
  const char* reason = nullptr;
  SNESGetConvergedReasonString(snes, &reason);
  remark = reason;
  SNESDestroy(&snes);
  return iterations;
}

int solve_tao(Context& c, Mat J, Vec x, std::string& remark) {
  Tao tao = nullptr;
  TaoCreate(PETSC_COMM_SELF, &tao);
  TaoSetSolution(tao, x);
  TaoSetConstraintsRoutine(tao, c.F, tao_function, &c);
  TaoSetJacobianRoutine(tao, J, J, tao_jacobian, &c);
  TaoSetVariableBounds(tao, c.lower, c.upper);
  TaoSetTolerances(tao, 0, 0, 0);
  TaoSetConstraintTolerances(tao, 0, 0);
  TaoSetMaximumIterations(tao, 500);
  TaoSetFromOptions(tao);
  TaoSetConvergenceTest(tao, tao_test, &c);
  TaoSolve(tao);
  PetscInt iterations = 0;
  TaoGetIterationNumber(tao, &iterations);
  TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
  TaoGetConvergedReason(tao, &reason);
  remark = TaoConvergedReasons[reason];
  TaoDestroy(&tao);
  return iterations;
}

Vec wrap(ncp::Vec& v) {
  Vec x = nullptr;
  VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(v.size()), v.data(), &x);
  return x;
}

}  // namespace

std::vector<std::string> petsc_solvers() {
  std::vector<std::string> names;
  for (const Solver& solver : solvers) names.emplace_back(solver.name);
  return names;
}

PdeRun petsc(const std::string& name, const ncp::Mcp& mcp, const ncp::Vec& x0, double tol, double limit) {
  PetscBool ready = PETSC_FALSE;
  PetscInitialized(&ready);
  if (!ready) {
    PetscInitializeNoArguments();
    PetscPopSignalHandler();
    PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr);  // who fails is measured as one that does not solve
  }
  const Solver& solver = *std::find_if(std::begin(solvers), std::end(solvers),
                                       [&](const Solver& candidate) { return candidate.name == name; });
  PdeRun run{.solver = name, .seconds = 0, .iterations = 0, .x = x0, .remark = {}};
  PetscOptionsClear(nullptr);
  PetscOptionsInsertString(nullptr, solver.options);
  Context c;
  c.mcp = &mcp;
  c.J = mcp.jacobian_pattern();
  c.constant = mcp.is_affine();
  c.tol = tol;
  mcp.jacobian(x0, c.J);
  c.rows = c.J.transpose();
  ncp::Vec lower = mcp.box().lower.cwiseMax(-PETSC_INFINITY);
  ncp::Vec upper = mcp.box().upper.cwiseMin(PETSC_INFINITY);
  Vec x = wrap(run.x);
  c.lower = wrap(lower);
  c.upper = wrap(upper);
  VecDuplicate(x, &c.F);
  ncp::SpMat rows = c.rows;  // PETSC's own: methods write into it
  const auto n = static_cast<PetscInt>(rows.cols());
  Mat J = nullptr;
  MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, rows.outerIndexPtr(), rows.innerIndexPtr(), rows.valuePtr(), &J);
  const auto begin = Clock::now();
  c.deadline = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit));
  run.iterations = solver.tao ? solve_tao(c, J, x, run.remark) : solve_snes(c, J, x, run.remark);
  run.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  for (Vec* v : {&c.lower, &c.upper, &c.F, &x}) VecDestroy(v);
  MatDestroy(&J);
  return run;
}

}  // namespace perp::bench
