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

}  // namespace

PetscErrorCode on_every_rank(MPI_Comm comm, PetscErrorCode own, const char* what) {
  int failed = static_cast<int>(own);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, comm));
  PetscCall(own);
  PetscCheck(failed == 0, PETSC_COMM_SELF, static_cast<PetscErrorCode>(failed), "perp: %s failed on another rank",
             what);
  return ok;
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

}  // namespace perp::petsc
