// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A start from coarse grids: the linearised problem is solved for coarse unknowns c, z = P c, with the bounds at the
/// coarse points, from the coarsest grid to the finest but one. That places the free boundary within a cell or two, so
/// that the steps on the finest grid do not grow with the grid.
#include "petsc/active_set.hpp"
#include "petsc/multigrid.hpp"

namespace perp::petsc {

/// problem: that of the finest level of the grids, which have its matrix. z and g change to the point found if phi is
/// lower there, or, where A is not symmetric, the natural residual.
PetscErrorCode nested_start(const BoxProblem& problem, const Face& face, Multigrid& grids, bool* taken);

/// The same for z = z0 + P c, with the bounds at the coarse points less z0: where a Newton step moves the free boundary
/// by many cells, but z0 has details that coarse grids have not.
PetscErrorCode nested_correction(const BoxProblem& problem, const Face& face, Multigrid& grids, bool* taken);

}  // namespace perp::petsc
