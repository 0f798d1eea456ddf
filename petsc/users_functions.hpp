// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The user's functions on all ranks. What goes wrong on one rank goes wrong on every rank: the others would wait for
/// it forever.
#include <petscsnes.h>

namespace perp::petsc {

/// `own` where it is an error; else the error of another rank, whose `what` failed.
PetscErrorCode on_every_rank(MPI_Comm comm, PetscErrorCode own, const char* what);

/// F at x, infinite on every rank where a rank has called SNESSetFunctionDomainError; then so is snes->domainerror.
PetscErrorCode compute_function(SNES snes, Vec x, Vec F);

/// The Jacobian at x, into the SNES's matrices. *defined: no rank has called SNESSetJacobianDomainError.
PetscErrorCode compute_jacobian(SNES snes, Vec x, bool* defined);

}  // namespace perp::petsc
