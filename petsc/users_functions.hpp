// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The user's functions, and what else may fail on one rank, on all ranks. What goes wrong on one rank goes wrong on
/// every rank: the others would wait for it forever.
#include <petscsnes.h>

namespace perp::petsc {

/// `own` where it is an error; else the error of another rank, whose `what` failed.
PetscErrorCode on_every_rank(MPI_Comm comm, PetscErrorCode own, const char* what);

/// F at x, infinite on every rank where a rank has called SNESSetFunctionDomainError; then so is snes->domainerror.
PetscErrorCode compute_function(SNES snes, Vec x, Vec F);

/// The Jacobian at x, into the SNES's matrices. *defined: no rank has called SNESSetJacobianDomainError.
PetscErrorCode compute_jacobian(SNES snes, Vec x, bool* defined);

/// SNES's monitors and its test of the k-th point. The same reason on every rank: if they differ, an end rather than
/// none, and a failure rather than a success.
PetscErrorCode monitor_and_test(SNES snes, PetscInt k, PetscReal length, PetscReal moved, PetscReal norm,
                                SNESConvergedReason* reason);

/// Sets up the KSP and its PC. *failed: on a rank the PC has not been built (a zero pivot). KSPSolve would end on that
/// rank alone, and the others would wait for it.
PetscErrorCode set_up_solver(KSP ksp, bool* failed);

}  // namespace perp::petsc
