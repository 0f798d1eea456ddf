/// PETSc for `perp compare --external`: SNESVI (reduced space, semismooth) and TAO's semismooth methods.
#include <petsc.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>

#include "peer.hpp"

namespace perp::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

/// What the callbacks see.
struct Context {
  const ncp::Mcp& mcp;
  ncp::SpMat J;
  Rows diagonal{};  ///< zeros: methods add to the diagonal, and ILU wants to see it
  Rows rows{};      ///< J with a full diagonal, as PETSc stores it
  bool natural = true;
  double tol = 0;
  int most = 0;
  Clock::time_point deadline{};
  bool late = false;
};

Context& context(void* data) { return *static_cast<Context*>(data); }

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
    if (!point.allFinite() || !c.mcp.jacobian(point, c.J)) return PetscErrorCode{PETSC_ERR_FP};
    const Rows all = Rows(c.J) + c.diagonal;
    PetscScalar* values = nullptr;
    MatSeqAIJGetArray(J, &values);
    std::copy_n(all.valuePtr(), all.nonZeros(), values);
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

PetscErrorCode snes_test(SNES snes, PetscInt it, PetscReal xnorm, PetscReal step, PetscReal norm,
                         SNESConvergedReason* reason, void* data) {
  Context& c = context(data);
  c.late = Clock::now() > c.deadline;
  if (!c.natural) {
    const PetscErrorCode code = SNESConvergedDefault(snes, it, xnorm, step, norm, reason, nullptr);
    if (c.late && *reason == SNES_CONVERGED_ITERATING) *reason = SNES_DIVERGED_MAX_IT;
    return code;
  }
  Vec x = nullptr;
  SNESGetSolution(snes, &x);
  *reason = natural_residual(c, x) <= c.tol ? SNES_CONVERGED_FNORM_ABS
            : c.late || it >= c.most        ? SNES_DIVERGED_MAX_IT
                                            : SNES_CONVERGED_ITERATING;
  return 0;
}

PetscErrorCode tao_test(Tao tao, void* data) {
  Context& c = context(data);
  c.late = Clock::now() > c.deadline;
  if (!c.natural) {
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
  TaoSetConvergedReason(tao, natural_residual(c, x) <= c.tol ? TAO_CONVERGED_USER
                             : c.late || it >= c.most        ? TAO_DIVERGED_MAXITS
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

PeerAnswer solve_snes(Context& c, const Data& d) {
  SNES snes = nullptr;
  SNESCreate(PETSC_COMM_SELF, &snes);
  SNESSetFunction(snes, d.F, snes_function, &c);
  SNESSetJacobian(snes, d.J, d.J, snes_jacobian, &c);
  SNESSetTolerances(snes, c.tol, 0, 0, c.most, 1000000);
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
  PeerAnswer answer;
  answer.words = std::string(words == nullptr ? "" : words) + ", iteration " + std::to_string(iterations);
  if (code != 0) {
    answer.words = error_text(code) + ", iteration " + std::to_string(iterations);
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
  return answer;
}

PeerAnswer solve_tao(Context& c, const Data& d) {
  Tao tao = nullptr;
  TaoCreate(PETSC_COMM_SELF, &tao);
  TaoSetSolution(tao, d.x);
  TaoSetConstraintsRoutine(tao, d.F, tao_function, &c);
  TaoSetJacobianRoutine(tao, d.J, d.J, tao_jacobian, &c);
  TaoSetVariableBounds(tao, d.lower, d.upper);
  TaoSetTolerances(tao, c.natural ? 0 : c.tol, 0, 0);
  TaoSetConstraintTolerances(tao, c.natural ? 0 : c.tol, 0);
  TaoSetMaximumIterations(tao, c.most);
  TaoSetFromOptions(tao);
  TaoSetConvergenceTest(tao, tao_test, &c);
  const PetscErrorCode code = TaoSolve(tao);
  PetscInt iterations = 0;
  TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
  TaoGetIterationNumber(tao, &iterations);
  TaoGetConvergedReason(tao, &reason);
  PeerAnswer answer;
  answer.words = std::string(TaoConvergedReasons[reason]) + ", iteration " + std::to_string(iterations);
  if (code != 0) {
    answer.words = error_text(code) + ", iteration " + std::to_string(iterations);
    answer.end = code == PETSC_ERR_FP ? End::Undefined : End::Failed;
  } else if (reason > 0) {
    answer.end = End::Claimed;
  } else if (reason == TAO_DIVERGED_MAXITS || reason == TAO_DIVERGED_MAXFCN) {
    answer.end = c.late ? End::TimeLimit : End::IterationLimit;
  } else if (reason == TAO_DIVERGED_NAN) {
    answer.end = End::Undefined;
  }
  TaoDestroy(&tao);
  return answer;
}

Vec wrap(ncp::Vec& v) {
  Vec x = nullptr;
  VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(v.size()), v.data(), &x);
  return x;
}

/// The user's PETSC_OPTIONS come last and win.
void set_options(const std::string& solver, const std::string& linear) {
  const bool tao = solver != "rsls" && solver != "ssls";
  std::string text = tao ? "-tao_type " + solver : "-snes_type vinewton" + solver;
  PetscBool mumps = PETSC_FALSE;
  PetscHasExternalPackage("mumps", &mumps);
  text += linear == "direct" ? " -ksp_type preonly -pc_type lu" : " -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5";
  if (linear == "direct" && mumps) text += " -pc_factor_mat_solver_type mumps";
  PetscOptionsInsertString(nullptr, text.c_str());
  if (const char* own = std::getenv("PETSC_OPTIONS")) PetscOptionsInsertString(nullptr, own);
}

PeerAnswer solve(const ncp::Mcp& mcp, ncp::In x0, const PeerOptions& options) {
  // One process needs neither Open MPI's daemon nor its networks, which take half a second, nor its folders in /tmp,
  // which without the daemon two processes at a time take away from each other.
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_btl", "self", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  PetscInitializeNoArguments();
  PetscPopSignalHandler();                                  // a crash is to be seen as one
  PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr);  // errors come back as codes
  const std::string& solver = options.text("solver");
  set_options(solver, options.text("linear"));
  Context c{.mcp = mcp, .J = mcp.jacobian_pattern()};
  c.natural = options.text("test") == "natural";
  c.tol = options.number("tol");
  c.most = static_cast<int>(std::min(options.number("iterations"), 1e9));
  c.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                  std::chrono::duration<double>(std::min(options.number("time"), 1e8)));
  ncp::Vec x = x0;
  ncp::Vec lower = mcp.box().lower.cwiseMax(PETSC_NINFINITY);
  ncp::Vec upper = mcp.box().upper.cwiseMin(PETSC_INFINITY);
  if (!mcp.jacobian(x, c.J)) return {.end = End::Undefined, .words = "J is not defined at the start", .x = x};
  c.diagonal.resize(mcp.size(), mcp.size());
  c.diagonal.setIdentity();
  c.diagonal *= 0;
  c.rows = Rows(c.J) + c.diagonal;
  c.rows.makeCompressed();
  Data d;
  d.x = wrap(x);
  d.lower = wrap(lower);
  d.upper = wrap(upper);
  VecDuplicate(d.x, &d.F);
  const auto n = static_cast<PetscInt>(mcp.size());
  MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, c.rows.outerIndexPtr(), c.rows.innerIndexPtr(), c.rows.valuePtr(),
                            &d.J);
  PeerAnswer answer = solver == "rsls" || solver == "ssls" ? solve_snes(c, d) : solve_tao(c, d);
  answer.words = solver + ", " + options.text("linear") + ": " + answer.words;
  // The natural residual is tested at the projection; by PETSc's own tests the point is as PETSc leaves it.
  answer.x = c.natural && x.allFinite() ? lcp::project(mcp.box(), x) : x;
  for (Vec* v : {&d.lower, &d.upper, &d.F, &d.x}) VecDestroy(v);
  MatDestroy(&d.J);
  PetscFinalize();
  return answer;
}

std::string version() {
  PetscInt major = 0, minor = 0, patch = 0, release = 0;
  PetscGetVersionNumber(&major, &minor, &patch, &release);
  return "PETSc " + std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  using namespace perp::bench;
  return run_peer(
      {.name = "petsc_peer",
       .version = version(),
       .options =
           {{"solver",
             "ssils",
             {"rsls", "ssls", "ssils", "ssfls", "asils", "asfls"},
             "SNESVI: rsls, ssls; TAO: the others"},
            {"linear", "direct", {"direct", "gmres"}, "MUMPS (or PETSc's LU), or GMRES with ILU"},
            {"test", "natural", {"natural", "own"}, "natural residual <= tol (inf-norm), or PETSc's test with tol"},
            {"tol", "1e-6", {}, "absolute tolerance"},
            {"iterations", "500", {}, "at most so many"},
            {"time", "1e8", {}, "seconds, looked at once an iteration"}},
       .solve = solve},
      argc, argv);
}
