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
/// residual has had no new minimum for 10 steps, the run goes back to the best point and makes semismooth steps
/// (semismooth.hpp), 5 at first, then twice as many. -snes_perp_multigrid false switches the multigrid off.
#include <petscsnes.h>

namespace perp::petsc {

constexpr const char* snes_type = "perp";

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
};

/// Registers the type: what PetscDLLibraryRegister_perp_petsc does for -dll_append libperp_petsc.so.
PetscErrorCode register_snes_perp();

/// The counts of the last solve of a SNES of this type.
PetscErrorCode counts_of(SNES snes, Counts* counts);

}  // namespace perp::petsc
