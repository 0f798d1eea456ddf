// SPDX-License-Identifier: Apache-2.0
/// The linear algebra of a solver: its matrix, its KSP and PC, the equations on a face.
#include <petsc/private/snesimpl.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "petsc/solver.hpp"
#include "petsc/users_functions.hpp"

namespace perp::petsc {
namespace {

constexpr double multigrid_loose =
    0.03;                              // rtol of the KSP where the face may still change: the error is that of the face
constexpr double amg_loose = 1e-2;     // ... where the PC is costly to build a few iterations more cost little
constexpr double few = 1e-4;           // changes, beside what is held, after which the face is most likely the last one
constexpr double ends = 2;             // ... and besides: the free boundary of a line of contact, however many are held
constexpr double default_rtol = 1e-5;  // of PETSc's KSP
constexpr PetscInt default_limit = 10000;  // likewise
constexpr PetscInt amg_limit = 500;        // iterations after which multigrid has failed
constexpr double shift = 1e-10;            // of the diagonal, where nothing holds the face
constexpr int most_shifts = 3;             // with a J: nothing may ever hold the face of an unsolvable problem
constexpr double tightest = 1e-10;
constexpr double tightest_nonlinear = 1e-4;  // beyond this J, not the equations, limits the step

PetscErrorCode is_set(KSP ksp, const char* key, bool* set) {
  const char* prefix = nullptr;
  PetscBool found = PETSC_FALSE;
  PetscOptions options = nullptr;
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  PetscCall(PetscObjectGetOptions(reinterpret_cast<PetscObject>(ksp), &options));
  PetscCall(PetscOptionsHasName(options, prefix, key, &found));
  *set = found == PETSC_TRUE;
  return ok;
}

bool any_of(const char* name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return std::strcmp(n, name) == 0; });
}

}  // namespace

/// Whose choice the KSP and the PC are: PETSc's defaults count as nobody's.
PetscErrorCode Solver::set_up(SNES snes) {
  snes_ = snes;
  KSP ksp = nullptr;
  PC pc = nullptr;
  KSPType ksp_type = nullptr;
  PCType pc_type = nullptr;
  bool set[3];
  PetscReal rtol = 0;
  PetscInt limit = 0;
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(KSPGetType(ksp, &ksp_type));
  PetscCall(PCGetType(pc, &pc_type));
  PetscCall(is_set(ksp, "-ksp_type", &set[0]));
  PetscCall(is_set(ksp, "-pc_type", &set[1]));
  PetscCall(is_set(ksp, "-ksp_rtol", &set[2]));
  PetscCall(KSPGetTolerances(ksp, &rtol, nullptr, nullptr, &limit));
  chosen_ksp_ = ksp_type == nullptr || (!set[0] && std::strcmp(ksp_type, KSPGMRES) == 0);
  chosen_pc_ = pc_type == nullptr || (!set[1] && any_of(pc_type, {PCILU, PCICC, PCBJACOBI}));
  chosen_rtol_ = !set[2] && rtol == default_rtol && snes->ksp_ewconv == PETSC_FALSE;
  chosen_limit_ = limit == default_limit;
  const bool mg = pc_type != nullptr && std::strcmp(pc_type, PCMG) == 0;
  took_mg_ = mg;
  multigrid_ = false;
  if (wants_multigrid_ && (chosen_pc_ || mg) && snes->dm != nullptr)
    PetscCall(grids_.take_hierarchy(snes->dm, &multigrid_));
  if (!multigrid_) return ok;
  PetscInt sizes[2];  // the DM need not be that of the unknowns
  PetscCall(VecGetLocalSize(grids_.levels()[0].b, &sizes[0]));
  PetscCall(VecGetLocalSize(snes->vec_sol, &sizes[1]));
  int fits = sizes[0] == sizes[1] ? 1 : 0;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &fits, 1, MPI_INT, MPI_MIN, PetscObjectComm(reinterpret_cast<PetscObject>(snes))));
  multigrid_ = fits != 0;
  return ok;
}

/// PETSc's defaults where the choice was ours, which the next set_up then knows for nobody's. The PC must not keep the
/// grids, which go with this object.
PetscErrorCode Solver::release() {
  if (snes_ == nullptr || snes_->ksp == nullptr) return ok;
  const KSP ksp = snes_->ksp;
  PC pc = nullptr;
  PetscBool shell = PETSC_FALSE;
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &shell));
  PetscCall(KSPReset(ksp));
  if (shell && !chosen_pc_ && took_mg_) PetscCall(PCSetType(pc, PCMG));
  if (chosen_pc_) PetscCall(PCSetType(pc, PCBJACOBI));
  if (chosen_ksp_) {
    PetscCall(KSPSetType(ksp, KSPGMRES));
    PetscCall(KSPSetPCSide(ksp, PC_SIDE_DEFAULT));
    PetscCall(KSPSetNormType(ksp, KSP_NORM_DEFAULT));
  }
  return KSPSetTolerances(ksp, chosen_rtol_ ? default_rtol : static_cast<PetscReal>(PETSC_DEFAULT), PETSC_DEFAULT,
                          PETSC_DEFAULT, chosen_limit_ ? default_limit : PETSC_DEFAULT);
}

PetscErrorCode Solver::take_matrix(Mat J) {
  PetscBool gap = PETSC_FALSE;
  PetscObjectState pattern = 0;
  PetscCall(MatMissingDiagonal(J, &gap, nullptr));
  int gaps = gap == PETSC_TRUE ? 1 : 0;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &gaps, 1, MPI_INT, MPI_MAX, PetscObjectComm(reinterpret_cast<PetscObject>(J))));
  PetscCheck(gaps == 0, PetscObjectComm(reinterpret_cast<PetscObject>(J)), PETSC_ERR_ARG_WRONGSTATE,
             "perp: the pattern of the Jacobian lacks a diagonal entry: store it, if only as 0");
  PetscCall(MatGetNonzeroState(J, &pattern));
  const bool other = J != J_ || pattern != pattern_;
  J_ = J;
  pattern_ = pattern;
  PetscCall(MatGetDiagonal(J, diagonal_));
  PetscCall(lonely_rows(J, box_, face_.lonely));
  PetscCall(VecSet(face_.open, 1));
  PetscCall(VecAXPY(face_.open, -1, face_.lonely));
  PetscCall(looks_symmetric(J, face_.open, &symmetric_));
  symmetric_ = symmetric_ && !indefinite_;
  face_.fresh = true;
  shifts_ = 0;
  if (multigrid_) {
    if (other && grids_.levels()[0].T != nullptr) PetscCall(grids_.take_hierarchy(snes_->dm, &multigrid_));
    PetscCall(grids_.take_matrix(J, face_.open));
  } else if (other || T_ == nullptr) {
    PetscCall(MatDuplicate(J, MAT_COPY_VALUES, T_.out()));
  }
  return choose_linear_solver();
}

/// Conjugate gradients or GMRES, until the residual itself is small: preconditioned it can be small where it is not.
PetscErrorCode Solver::take_krylov_method() {
  bool norm = false;
  const bool conjugate = symmetric_ && !plain_;
  PetscCall(KSPSetType(snes_->ksp, conjugate ? KSPCG : KSPGMRES));
  PetscCall(is_set(snes_->ksp, "-ksp_norm_type", &norm));
  if (norm) return ok;
  PetscCall(KSPSetPCSide(snes_->ksp, conjugate ? PC_LEFT : PC_RIGHT));
  return KSPSetNormType(snes_->ksp, KSP_NORM_UNPRECONDITIONED);
}

PetscErrorCode Solver::choose_linear_solver() {
  PC pc = nullptr;
  PetscCall(KSPGetPC(snes_->ksp, &pc));
  if (chosen_ksp_) PetscCall(take_krylov_method());
  if (multigrid_) return grids_.become(pc);
  if (!chosen_pc_) return ok;
  if (plain_) return PCSetType(pc, PCBJACOBI);
  PetscCall(set_algebraic_multigrid(pc));
  return PCSetFromOptions(pc);
}

/// Loose while the face changes; on a settled one as exact as the rest of the run needs.
PetscErrorCode Solver::face_tolerance(Vec b, bool changed) {
  if (!chosen_rtol_) return ok;
  PetscReal length = 0;
  PetscCall(VecNorm(b, NORM_2, &length));
  const PetscReal loose = multigrid_ ? multigrid_loose : amg_loose;
  const PetscReal wanted = 0.1 * std::max(snes_->abstol, snes_->ttol);
  PetscInt all = 0;
  PetscCall(VecGetSize(b, &all));
  const double held = static_cast<double>(all - face_.size);
  const bool settled = !changed || (affine_ && static_cast<double>(face_.changes) <= few * held + ends);
  const PetscReal share = length > 0 ? wanted / length : loose;
  const PetscReal least = affine_ ? tightest : tightest_nonlinear;
  const PetscReal rtol = settled || !affine_ ? std::clamp(share, least, loose) : loose;
  const PetscInt limit = chosen_limit_ && chosen_pc_ && !plain_ ? amg_limit
                         : chosen_limit_                        ? default_limit
                                                                : PETSC_DEFAULT;
  return KSPSetTolerances(snes_->ksp, rtol, PETSC_DEFAULT, PETSC_DEFAULT, limit);
}

/// The face's matrix for the KSP: J with what is held cut off.
PetscErrorCode Solver::take_face(Mat J, Vec mask) {
  if (multigrid_) {
    PetscCall(grids_.take_face(0, mask));
  } else {
    PetscCall(MatCopy(J, T_, SAME_NONZERO_PATTERN));
    PetscCall(cut_off(T_, mask, diagonal_));
  }
  const Mat T = multigrid_ ? static_cast<Mat>(grids_.levels()[0].T) : static_cast<Mat>(T_);
  return KSPSetOperators(snes_->ksp, T, T);
}

/// The face's equations by SNES's KSP.
PetscErrorCode Solver::solve(Vec mask, bool changed, Vec b, Vec d, bool* failed) {
  *failed = false;
  if (unheld) {
    PetscCall(unshift());
  } else if (changed) {
    PetscCall(take_face(J_, mask));
  }
  counts_.faces += changed ? 1 : 0;
  PetscCall(face_tolerance(b, changed));
  for (bool retry = true; retry;) {
    KSPConvergedReason why = KSP_CONVERGED_ITERATING;
    PetscInt iterations = 0;
    bool unbuilt = false;
    PetscCall(set_up_solver(snes_->ksp, &unbuilt));
    if (!unbuilt) {
      PetscCall(KSPSolve(snes_->ksp, b, d));
      PetscCall(KSPGetConvergedReason(snes_->ksp, &why));
      PetscCall(KSPGetIterationNumber(snes_->ksp, &iterations));
    }
    if (unbuilt) why = KSP_DIVERGED_PC_FAILED;
    snes_->linear_its += iterations;
    if (why >= 0) return ok;
    PetscCall(give_up_on_linear_solver(why, &retry));
  }
  *failed = true;
  return ok;
}

/// The face's matrix with a little of its diagonal: definite where phi has a direction without curvature, in which the
/// solution is then long. A membrane that nothing holds falls until it touches its obstacle.
PetscErrorCode Solver::shift_face() {
  OwnMat A;
  OwnVec little;
  unheld = true;
  ++shifts_;
  PetscCall(MatDuplicate(J_, MAT_COPY_VALUES, A.out()));
  PetscCall(VecDuplicate(diagonal_, little.out()));
  PetscCall(VecCopy(diagonal_, little));
  PetscCall(VecScale(little, shift));
  PetscCall(MatDiagonalSet(A, little, ADD_VALUES));
  if (multigrid_) {
    grids_.renew_coarsest();
    PetscCall(grids_.take_matrix(A, face_.open));
  }
  return take_face(A, face_.mask);
}

PetscErrorCode Solver::unshift() {
  unheld = false;
  if (multigrid_) PetscCall(grids_.take_matrix(J_, face_.open));
  return take_face(J_, face_.mask);
}

/// Another matrix or another solver where the choice is ours; else what SNES does with a failure.
PetscErrorCode Solver::give_up_on_linear_solver(KSPConvergedReason why, bool* retry) {
  PetscCall(PetscInfo(snes_, "the equations on a face were not solved: %s\n", KSPConvergedReasons[why]));
  const bool curved = why == KSP_DIVERGED_INDEFINITE_MAT || why == KSP_DIVERGED_INDEFINITE_PC;
  const bool singular = curved || why == KSP_DIVERGED_NANORINF || why == KSP_DIVERGED_PC_FAILED;
  *retry = false;
  if (chosen_ksp_ && chosen_pc_ && symmetric_ && !plain_ && !unheld && singular && shifts_ < most_shifts) {
    *retry = true;
    return shift_face();
  }
  if (unheld) PetscCall(unshift());
  if (chosen_ksp_ && symmetric_ && (curved || why == KSP_DIVERGED_BREAKDOWN)) {
    // phi has no minimum on the face, but the equations may have a solution.
    indefinite_ = true;
    symmetric_ = false;
    *retry = true;
    return take_krylov_method();
  }
  if (chosen_pc_ && chosen_ksp_ && !plain_) {
    plain_ = *retry = true;
    multigrid_ = false;
    if (T_ == nullptr) {
      PetscCall(MatDuplicate(J_, MAT_COPY_VALUES, T_.out()));
      PetscCall(cut_off(T_, face_.mask, diagonal_));
    }
    PetscCall(KSPSetOperators(snes_->ksp, T_, T_));
    return choose_linear_solver();
  }
  if (++snes_->numLinearSolveFailures >= snes_->maxLinearSolveFailures) snes_->reason = SNES_DIVERGED_LINEAR_SOLVE;
  return ok;
}

}  // namespace perp::petsc
