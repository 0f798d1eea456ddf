// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Steps and changes of single rows of a distributed matrix of type aij, for active-set steps.
#include "petsc/box.hpp"

namespace perp::petsc {

/// The linearised problem in a box: g = A z + q at z; all of it changes along together.
struct BoxProblem {
  Mat A = nullptr;
  Vec diagonal = nullptr;
  Box box{};
  Vec z = nullptr;
  Vec g = nullptr;
  bool symmetric = false;  ///< then z minimises phi(z) = 1/2 z'A z + q'z, which no step may raise
};

/// An error unless the rows of the matrix can be read.
PetscErrorCode check_is_aij(Mat J);

/// 1 where the row has nothing but its diagonal entry, which is not zero, and the variable has no bound: an equation of
/// its own, such as a boundary condition; 0 elsewhere.
PetscErrorCode lonely_rows(Mat A, const Box& box, Vec lonely);

/// The step that solves the rows marked in `lonely`.
PetscErrorCode lonely_step(const BoxProblem& problem, Vec lonely, Vec step);

/// The step of a projected Gauss-Seidel sweep, forth and back, on each rank's own block (other ranks' variables stay
/// as they are). Rows whose diagonal entry is not positive are left out, and those with open[i] = 0.
PetscErrorCode sweep_step(const BoxProblem& problem, Vec open, Vec step);

/// Whether u'A v = v'A u for two made-up vectors, up to rounding, on the variables with free[i] = 1.
PetscErrorCode looks_symmetric(Mat A, Vec free, bool* symmetric);

/// A := diag(m) A diag(m) + diag((1 - m) d), d the diagonal given: the rows with m[i] = 0 are cut off.
PetscErrorCode cut_off(Mat A, Vec mask, Vec diagonal);

/// The second half of it: A := A + diag((1 - m) d).
PetscErrorCode set_cut_off_diagonal(Mat A, Vec mask, Vec diagonal);

}  // namespace perp::petsc
