// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problems of bench_petsc on a square grid of points, for any number of ranks. All but `signorini` are h_x h_y
/// times finite differences on the grid, u = 0 on the boundary:
///     obstacle          -Laplace u = 1, (s t)^3 <= u <= (s t)^2 + 0.02 with s = sin 9.2 x, t = sin 9.3 y (MINPACK-2)
///     torsion           -Laplace u = 5, |u| <= distance to the boundary (MINPACK-2)
///     journal-bearing   -div(w^3 grad u) = e sin x on (0, 2 pi) x (0, 20), w = 1 + e cos x, e = 0.1, u >= 0
///     (MINPACK-2) bratu             -Laplace u = 6 exp u, u <= 0.4 signorini         plane strain, bilinear elements,
///     pressed down by 0.1 on a rigid plane under a rounded bottom
#include <petscdmda.h>

#include <string>

namespace perp::bench {

struct GridProblem {
  std::string name;
  DM dm = nullptr;
  Mat stiffness = nullptr;  ///< of signorini: F = stiffness x - load
  Vec load = nullptr;
  PetscReal width = 1, height = 1, exponential = 0;
};

/// An error if there is no problem of this name.
PetscErrorCode make_problem(const std::string& name, PetscInt points, GridProblem* problem);
/// The same problem on a grid that PETSc made.
PetscErrorCode on_grid(const std::string& name, DM dm, GridProblem* problem);
PetscErrorCode bounds(const GridProblem& problem, Vec lower, Vec upper);
PetscErrorCode evaluate(const GridProblem& problem, Vec x, Vec F);
PetscErrorCode jacobian(const GridProblem& problem, Vec x, Mat J);
/// The potential whose gradient F is, and F.
PetscErrorCode objective(const GridProblem& problem, Vec x, PetscReal* value, Vec F);
PetscErrorCode destroy(GridProblem* problem);

}  // namespace perp::bench
