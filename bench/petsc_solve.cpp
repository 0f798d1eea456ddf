// SPDX-License-Identifier: Apache-2.0
#include "bench/petsc_solve.hpp"

#include <petsc.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <utility>

namespace perp::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

/// What the callbacks see.
struct Context {
  const ncp::Mcp& mcp;
  const PetscTask& task;
  ncp::SpMat J;
  Rows zeros{};  ///< of the diagonal where J's pattern lacks some of it: methods add to it, and ILU wants to see it
  Rows rows{};   ///< J with a full diagonal, as PETSc stores it
  ncp::Vec q{};  ///< F(0) of a gradient
  Clock::time_point deadline{};
  bool late = false;
};

Context& context(void* data) { return *static_cast<Context*>(data); }

void store_rows(Context& c) {
  c.rows = c.J;
  if (c.zeros.size() > 0) c.rows = Rows(c.rows + c.zeros);
}

template <class Use>
PetscErrorCode with(Vec x, Use use) {
  PetscInt n = 0;
  const PetscScalar* in = nullptr;
  VecGetLocalSize(x, &n);
  VecGetArrayRead(x, &in);
  const PetscErrorCode code = use(Eigen::Map<const ncp::Vec>(in, n));
  VecRestoreArrayRead(x, &in);
  return code;
}

/// NaN where F is not defined: the searches take shorter steps then.
PetscErrorCode evaluate(Context& c, Vec x, Vec F) {
  return with(x, [&](const auto& point) {
    PetscScalar* out = nullptr;
    VecGetArray(F, &out);
    Eigen::Map<ncp::Vec> values(out, point.size());
    if (!point.allFinite() || !c.mcp.eval(point, values)) values.setConstant(std::numeric_limits<double>::quiet_NaN());
    VecRestoreArray(F, &out);
    return PetscErrorCode{0};
  });
}

/// Filled every time, for the semismooth methods scale what they are given.
PetscErrorCode fill(Context& c, Vec x, Mat J) {
  return with(x, [&](const auto& point) {
    if (!point.allFinite()) return PetscErrorCode{PETSC_ERR_FP};
    if (!c.mcp.is_affine()) {
      if (!c.mcp.jacobian(point, c.J)) return PetscErrorCode{PETSC_ERR_FP};
      store_rows(c);
    }
    PetscScalar* values = nullptr;
    MatSeqAIJGetArray(J, &values);
    std::copy_n(c.rows.valuePtr(), c.rows.nonZeros(), values);
    MatSeqAIJRestoreArray(J, &values);
    MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY);
    return MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY);
  });
}

double natural_residual(Context& c, Vec x) {
  double residual = 0;
  with(x, [&](const auto& point) {
    residual = residual_at_projection(c.mcp, point);
    return PetscErrorCode{0};
  });
  return residual;
}

PetscErrorCode snes_function(SNES, Vec x, Vec F, void* data) { return evaluate(context(data), x, F); }
PetscErrorCode snes_jacobian(SNES, Vec x, Mat J, Mat, void* data) { return fill(context(data), x, J); }
PetscErrorCode tao_function(Tao, Vec x, Vec F, void* data) { return evaluate(context(data), x, F); }
PetscErrorCode tao_jacobian(Tao, Vec x, Mat J, Mat, void* data) { return fill(context(data), x, J); }

/// x'(F(x) + F(0)) / 2 and its gradient F(x); the Hessian is constant.
PetscErrorCode tao_objective(Tao, Vec x, PetscReal* value, Vec F, void* data) {
  Context& c = context(data);
  evaluate(c, x, F);
  return with(x, [&](const auto& point) {
    return with(F, [&](const auto& gradient) {
      *value = 0.5 * point.dot(gradient + c.q);
      return PetscErrorCode{0};
    });
  });
}
PetscErrorCode tao_hessian(Tao, Vec, Mat, Mat, void*) { return 0; }

PetscErrorCode snes_test(SNES snes, PetscInt it, PetscReal xnorm, PetscReal step, PetscReal norm,
                         SNESConvergedReason* reason, void* data) {
  Context& c = context(data);
  c.late = Clock::now() > c.deadline;
  if (!c.task.natural) {
    const PetscErrorCode code = SNESConvergedDefault(snes, it, xnorm, step, norm, reason, nullptr);
    if (c.late && *reason == SNES_CONVERGED_ITERATING) *reason = SNES_DIVERGED_MAX_IT;
    return code;
  }
  Vec x = nullptr;
  SNESGetSolution(snes, &x);
  *reason = natural_residual(c, x) <= c.task.tol ? SNES_CONVERGED_FNORM_ABS
            : c.late || it >= c.task.iterations  ? SNES_DIVERGED_MAX_IT
                                                 : SNES_CONVERGED_ITERATING;
  return 0;
}

PetscErrorCode tao_test(Tao tao, void* data) {
  Context& c = context(data);
  c.late = Clock::now() > c.deadline;
  if (!c.task.natural) {
    const PetscErrorCode code = TaoDefaultConvergenceTest(tao, nullptr);
    TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
    TaoGetConvergedReason(tao, &reason);
    if (c.late && reason == TAO_CONTINUE_ITERATING) TaoSetConvergedReason(tao, TAO_DIVERGED_MAXITS);
    return code;
  }
  Vec x = nullptr;
  PetscInt it = 0;
  TaoGetSolution(tao, &x);
  TaoGetIterationNumber(tao, &it);
  TaoSetConvergedReason(tao, natural_residual(c, x) <= c.task.tol ? TAO_CONVERGED_USER
                             : c.late || it >= c.task.iterations  ? TAO_DIVERGED_MAXITS
                                                                  : TAO_CONTINUE_ITERATING);
  return 0;
}

/// PETSc's objects of one problem.
struct Data {
  Vec x = nullptr, F = nullptr, lower = nullptr, upper = nullptr;
  Mat J = nullptr;
};

std::string error_text(PetscErrorCode code) {
  const char* text = nullptr;
  PetscErrorMessage(static_cast<int>(code), &text, nullptr);
  return "error " + std::to_string(static_cast<int>(code)) + (text != nullptr ? std::string(", ") + text : "");
}

PetscAnswer solve_snes(Context& c, const Data& d) {
  SNES snes = nullptr;
  SNESCreate(PETSC_COMM_SELF, &snes);
  SNESSetFunction(snes, d.F, snes_function, &c);
  SNESSetJacobian(snes, d.J, d.J, snes_jacobian, &c);
  SNESSetTolerances(snes, c.task.tol, 0, 0, c.task.iterations, 1000000);
  SNESSetFromOptions(snes);
  SNESVISetVariableBounds(snes, d.lower, d.upper);
  SNESSetConvergenceTest(snes, snes_test, &c, nullptr);
  const PetscErrorCode code = SNESSolve(snes, nullptr, d.x);
  PetscInt iterations = 0;
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  const char* words = nullptr;
  SNESGetIterationNumber(snes, &iterations);
  SNESGetConvergedReason(snes, &reason);
  SNESGetConvergedReasonString(snes, &words);
  PeerAnswer answer{.words = words == nullptr ? "" : words};
  if (code != 0) {
    answer.words = error_text(code);
    answer.end = code == PETSC_ERR_FP ? End::Undefined : End::Failed;
  } else if (reason > 0) {
    answer.end = End::Claimed;
  } else if (reason == SNES_DIVERGED_MAX_IT || reason == SNES_DIVERGED_FUNCTION_COUNT) {
    answer.end = c.late ? End::TimeLimit : End::IterationLimit;
  } else if (reason == SNES_DIVERGED_LINEAR_SOLVE) {
    answer.end = End::LinearSolveFailed;
  } else if (reason == SNES_DIVERGED_FNORM_NAN || reason == SNES_DIVERGED_FUNCTION_DOMAIN) {
    answer.end = End::Undefined;
  }
  SNESDestroy(&snes);
  return {.peer = std::move(answer), .iterations = iterations};
}

PetscAnswer solve_tao(Context& c, const Data& d) {
  Tao tao = nullptr;
  TaoCreate(PETSC_COMM_SELF, &tao);
  TaoSetSolution(tao, d.x);
  if (c.task.gradient) {
    TaoSetObjectiveAndGradient(tao, nullptr, tao_objective, &c);
    TaoSetHessian(tao, d.J, d.J, tao_hessian, &c);
  } else {
    TaoSetConstraintsRoutine(tao, d.F, tao_function, &c);
    TaoSetJacobianRoutine(tao, d.J, d.J, tao_jacobian, &c);
  }
  TaoSetVariableBounds(tao, d.lower, d.upper);
  TaoSetTolerances(tao, c.task.natural ? 0 : c.task.tol, 0, 0);
  TaoSetConstraintTolerances(tao, c.task.natural ? 0 : c.task.tol, 0);
  TaoSetMaximumIterations(tao, c.task.iterations);
  TaoSetFromOptions(tao);
  TaoSetConvergenceTest(tao, tao_test, &c);
  const PetscErrorCode code = TaoSolve(tao);
  PetscInt iterations = 0;
  TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
  TaoGetIterationNumber(tao, &iterations);
  TaoGetConvergedReason(tao, &reason);
  PeerAnswer answer{.words = TaoConvergedReasons[reason]};
  if (code != 0) {
    answer.words = error_text(code);
    answer.end = code == PETSC_ERR_FP ? End::Undefined : End::Failed;
  } else if (reason > 0) {
    answer.end = End::Claimed;
  } else if (reason == TAO_DIVERGED_MAXITS || reason == TAO_DIVERGED_MAXFCN) {
    answer.end = c.late ? End::TimeLimit : End::IterationLimit;
  } else if (reason == TAO_DIVERGED_NAN) {
    answer.end = End::Undefined;
  }
  TaoDestroy(&tao);
  return {.peer = std::move(answer), .iterations = iterations};
}

Vec wrap(ncp::Vec& v) {
  Vec x = nullptr;
  VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(v.size()), v.data(), &x);
  return x;
}

}  // namespace

void start_petsc() {
  PetscBool ready = PETSC_FALSE;
  PetscInitialized(&ready);
  if (ready) return;
  // One process needs neither Open MPI's daemon nor its networks, which take half a second, nor its folders in /tmp,
  // which without the daemon two processes at a time take away from each other.
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_btl", "self", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  PetscInitializeNoArguments();
  PetscPopSignalHandler();                                  // a crash is to be seen as one
  PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr);  // errors come back as codes
}

PetscAnswer petsc_solve(const ncp::Mcp& mcp, ncp::In x0, const PetscTask& task) {
  Context c{.mcp = mcp, .task = task, .J = mcp.jacobian_pattern()};
  ncp::Vec x = x0;
  ncp::Vec lower = mcp.box().lower.cwiseMax(PETSC_NINFINITY);
  ncp::Vec upper = mcp.box().upper.cwiseMin(PETSC_INFINITY);
  if (!mcp.jacobian(x, c.J)) return {{.end = End::Undefined, .words = "J is not defined at the start", .x = x}};
  Rows zeros(mcp.size(), mcp.size());
  zeros.setIdentity();
  zeros *= 0;
  if (Rows(Rows(c.J) + zeros).nonZeros() > c.J.nonZeros()) c.zeros = std::move(zeros);
  store_rows(c);
  Rows stored = c.rows;  // PETSc's own: methods write into it
  Data d;
  d.x = wrap(x);
  d.lower = wrap(lower);
  d.upper = wrap(upper);
  VecDuplicate(d.x, &d.F);
  const auto n = static_cast<PetscInt>(mcp.size());
  MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, stored.outerIndexPtr(), stored.innerIndexPtr(), stored.valuePtr(),
                            &d.J);
  if (task.gradient) {
    c.q = ncp::Vec::Zero(mcp.size());
    mcp.eval(ncp::Vec(c.q), c.q);
    MatSetOption(d.J, MAT_SYMMETRIC, PETSC_TRUE);
    MatSetOption(d.J, MAT_SPD, PETSC_TRUE);
  }
  const auto begin = Clock::now();
  c.deadline = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(task.seconds));
  PetscAnswer answer = task.tao ? solve_tao(c, d) : solve_snes(c, d);
  answer.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  // The natural residual is tested at the projection; by PETSc's own tests the point is as PETSc leaves it.
  answer.peer.x = task.natural && x.allFinite() ? lcp::project(mcp.box(), x) : x;
  for (Vec* v : {&d.lower, &d.upper, &d.F, &d.x}) VecDestroy(v);
  MatDestroy(&d.J);
  return answer;
}

}  // namespace perp::bench
