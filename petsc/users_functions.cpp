// SPDX-License-Identifier: Apache-2.0
#include "petsc/users_functions.hpp"

#include <petsc/private/snesimpl.h>

#include "petsc/handle.hpp"

namespace perp::petsc {
namespace {

/// On any rank.
PetscErrorCode any(MPI_Comm comm, PetscBool* flag) {
  int set = *flag == PETSC_TRUE ? 1 : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &set, 1, MPI_INT, MPI_MAX, comm));
  *flag = set != 0 ? PETSC_TRUE : PETSC_FALSE;
  return ok;
}

/// Positive for errors; petsc4py's code for an exception, -1, means nothing where the exception is not.
int code_of(PetscErrorCode own) {
  const int code = static_cast<int>(own);
  return code >= 0 ? code : PETSC_ERR_USER;
}

PetscErrorCode fail_if(PetscErrorCode own, int failed, const char* what) {
  PetscCall(own);
  PetscCheck(failed == 0, PETSC_COMM_SELF, static_cast<PetscErrorCode>(failed), "perp: %s failed on another rank",
             what);
  return ok;
}

}  // namespace

PetscErrorCode on_every_rank(MPI_Comm comm, PetscErrorCode own, const char* what) {
  int failed = code_of(own);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, comm));
  return fail_if(own, failed, what);
}

PetscErrorCode compute_function(SNES snes, Vec x, Vec F) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(snes));
  snes->domainerror = PETSC_FALSE;
  PetscCall(on_every_rank(comm, SNESComputeFunction(snes, x, F), "F"));
  PetscCall(any(comm, &snes->domainerror));
  return snes->domainerror == PETSC_TRUE ? VecSetInf(F) : ok;
}

PetscErrorCode compute_jacobian(SNES snes, Vec x, bool* defined) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(snes));
  snes->jacobiandomainerror = PETSC_FALSE;
  PetscCall(on_every_rank(comm, SNESComputeJacobian(snes, x, snes->jacobian, snes->jacobian_pre), "the Jacobian"));
  PetscCall(any(comm, &snes->jacobiandomainerror));
  *defined = snes->jacobiandomainerror == PETSC_FALSE;
  snes->jacobiandomainerror = PETSC_FALSE;
  return ok;
}

PetscErrorCode monitor_and_test(SNES snes, PetscInt k, PetscReal length, PetscReal moved, PetscReal norm,
                                SNESConvergedReason* reason) {
  *reason = SNES_CONVERGED_ITERATING;
  PetscErrorCode code = SNESMonitor(snes, k, norm);
  if (code == ok) code = (*snes->ops->converged)(snes, k, length, moved, norm, reason, snes->cnvP);
  int most[3] = {code_of(code), static_cast<int>(*reason), -static_cast<int>(*reason)};
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_INT, MPI_MAX, PetscObjectComm(reinterpret_cast<PetscObject>(snes))));
  *reason = static_cast<SNESConvergedReason>(most[2] > 0 ? -most[2] : most[1]);
  return fail_if(code, most[0], "a monitor or the convergence test");
}

PetscErrorCode set_up_solver(KSP ksp, bool* failed) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(ksp));
  PC pc = nullptr;
  PCFailedReason why = PC_NOERROR;
  PetscErrorCode code = KSPSetUp(ksp);
  if (code == ok) code = KSPSetUpOnBlocks(ksp);
  PetscCall(on_every_rank(comm, code, "the setup of the KSP"));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCGetFailedReasonRank(pc, &why));
  PetscBool any_failed = why != PC_NOERROR ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(any(comm, &any_failed));
  *failed = any_failed == PETSC_TRUE;
  return ok;
}

}  // namespace perp::petsc
