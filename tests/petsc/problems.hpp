// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Problems for the tests of SNES type perp, written against PETSc's public interface alone, as a user would.
#include <petscdmda.h>
#include <petscsnes.h>

#include <string>

namespace perp::petsc_tests {

/// On the unit square with u = 0 on the boundary, h^2 times the five-point equations.
struct Membrane {
  PetscReal load = 0;      ///< -Laplace u = load
  PetscReal bratu = 0;     ///< ... + bratu exp(u)
  PetscReal wind = 0;      ///< ... - wind u_x, upwind
  PetscReal slope = 0;     ///< |u| <= slope * (distance to the boundary): torsion
  bool obstacle = false;   ///< u >= 1/4 - 8 |x - (0.4, 0.45)|^2
  PetscReal ceiling = 0;   ///< u <= ceiling where that is positive
  PetscReal nan_from = 0;  ///< F is not a number on the last rank from this evaluation on, where positive
  PetscReal error_from = 0;
  PetscReal outside_from = 0;        ///< the last rank says SNESSetFunctionDomainError
  bool nan_in_jacobian = false;      ///< on the last rank
  bool error_in_jacobian = false;    ///< likewise, after the assembly
  bool outside_in_jacobian = false;  ///< likewise: SNESSetJacobianDomainError
  bool error_in_bounds = false;      ///< likewise
  int evaluations = 0;
  SNES snes = nullptr;
};

/// How the bounds reach SNES.
enum class Bounds { Vectors, Function, Dm };

/// A SNES with a grid of n x n points; set from the options.
PetscErrorCode make_membrane(PetscInt n, Bounds bounds, Membrane* membrane, DM* dm, SNES* snes);
PetscErrorCode fill_bounds(DM dm, const Membrane& membrane, Vec lower, Vec upper);

/// |x - mid(l, x - F, u)| at its largest, from F computed again: without any code of the library.
PetscErrorCode independent_residual(SNES snes, Vec x, Vec lower, Vec upper, PetscReal* largest);

}  // namespace perp::petsc_tests
