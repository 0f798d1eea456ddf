// SPDX-License-Identifier: Apache-2.0
#pragma once
/// PETSc's nonlinear solver `perp` for variational inequalities: find lower <= x <= upper with F_i(x) >= 0 where x_i is
/// at its lower bound, <= 0 at its upper bound, = 0 between. What a program says to SNESVI's solvers it says to this
/// one: bounds by SNESVISetVariableBounds, SNESVISetComputeVariableBounds or the DM; F and J by SNES or the DM; SNES's
/// tolerances, monitors and options; the KSP and PC of the SNES.
///
/// SNES's norm is the 2-norm of the natural residual x - mid(lower, x - F(x), upper), and nothing else decides that a
/// point is a solution: SNES_CONVERGED_FNORM_ABS and _RELATIVE are its tests by -snes_atol and -snes_rtol. Short steps
/// (-snes_stol) end a run only where the residual is at the level of rounding, with SNES_CONVERGED_SNORM_RELATIVE.
///
/// An iteration is an active-set step (active_set.hpp). J is computed again only where its linear model has missed F.
/// The equations on the face are solved by SNES's KSP, on J with the held rows and columns cut off. Where no PC was
/// chosen, or "mg", and the DM can be coarsened, the PC is a truncated multigrid (multigrid.hpp), and a first step
/// comes from the coarse grids (nested_start.hpp); otherwise it is BoomerAMG where PETSc has it, else GAMG. Where the
/// residual has had no new minimum for `patience` steps, the run goes back to the best point and makes semismooth steps
/// (semismooth.hpp), 5 at first, then twice as many.
#include <petscsnes.h>

namespace perp::petsc {

constexpr const char* snes_type = "perp";

/// The options, with PETSc's key and default.
struct Options {
  PetscBool multigrid = PETSC_TRUE;  ///< -snes_perp_multigrid: with a DM that can be coarsened and no other PC chosen
  PetscBool nested = PETSC_TRUE;     ///< -snes_perp_nested: with it, a first step from the coarse grids
  PetscInt levels = 20;              ///< -snes_perp_levels: of the hierarchy, at most
  PetscInt patience = 10;            ///< -snes_perp_patience: steps without a new best point, at least 1
  PetscReal loose = 0.03;            ///< -snes_perp_loose: KSP's rtol where the face may still change, unless -ksp_rtol
  /// -snes_perp_interrupt: SIGINT and SIGTERM on any rank end the solve on all ranks at the next iteration, with the
  /// best point and SNES_DIVERGED_INNER; a second signal does what it did before the solve.
  PetscBool interrupt = PETSC_TRUE;
};

/// What a solve has cost, beyond what SNES counts.
struct Counts {
  PetscInt steps = 0;       ///< active-set steps
  PetscInt semismooth = 0;  ///< semismooth steps
  PetscInt jacobians = 0;
  PetscInt faces = 0;   ///< times that the PC was built for another face or J
  PetscInt cycles = 0;  ///< V-cycles on the finest grid
  PetscInt64 face = 0;  ///< variables between their bounds in the last step
  PetscReal worst = 0;  ///< max_i of the natural residual
  PetscInt row = -1;    ///< where that is
  PetscBool interrupted = PETSC_FALSE;
};

/// Registers the type: what PetscDLLibraryRegister_perp_petsc does for -dll_append libperp_petsc.so.
PetscErrorCode register_snes_perp();

/// The counts of the last solve of a SNES of this type.
PetscErrorCode counts_of(SNES snes, Counts* counts);

}  // namespace perp::petsc
