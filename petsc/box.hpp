// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problem on the ranks of a communicator, and its judge: find l <= x <= u with, for every i,
///     F_i(x) >= 0 where x_i = l_i,    F_i(x) <= 0 where x_i = u_i,    F_i(x) = 0 between them.
/// The natural residual is r_i = |x_i - mid(l_i, x_i - F_i, u_i)|, zero exactly at solutions.
/// All functions here are collective; vectors are distributed alike, and no rank sees another one's entries.
#include "petsc/handle.hpp"

namespace perp::petsc {

/// Bounds of this size are none.
inline constexpr PetscReal infinite = 1e20;

struct Box {
  Vec lower = nullptr;
  Vec upper = nullptr;
};

/// An error on every rank where l_i > u_i, l_i is infinity, u_i is minus infinity, or a bound is not a number; it names
/// the first such i and both values.
PetscErrorCode check_box(const Box& box);

/// x_i = mid(l_i, x_i, u_i).
PetscErrorCode project(const Box& box, Vec x);

struct Residual {
  PetscReal norm = 0;   ///< the 2-norm, as SNES measures F; not finite where an F_i on any rank is not
  PetscReal worst = 0;  ///< max_i r_i, perp's measure
  PetscInt row = -1;    ///< where that is
};
PetscErrorCode natural_residual(const Box& box, Vec x, Vec F, Residual* residual);

/// mid(z - u, F, z - l) does not lose F beside z, as z - mid(l, z - F, u) would.
inline PetscReal row_residual(PetscReal l, PetscReal u, PetscReal x, PetscReal F) {
  const PetscReal below = x - u;
  const PetscReal above = x - l;
  return F < below ? below : F > above ? above : F;
}

}  // namespace perp::petsc
