// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The cases of petsc_tests that have files of their own; and how a case says that it does not hold.
#include <petscsnes.h>

#include <cstdio>

#define EXPECT(condition, ...)                                                     \
  do {                                                                             \
    if (!(condition)) {                                                            \
      std::fprintf(stderr, "%s:%d: not so: %s; ", __FILE__, __LINE__, #condition); \
      std::fprintf(stderr, __VA_ARGS__);                                           \
      std::fprintf(stderr, "\n");                                                  \
      return PETSC_ERR_PLIB;                                                       \
    }                                                                              \
  } while (false)

namespace perp::petsc_tests {

struct Solved {
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt steps = 0;
  PetscReal residual = 0;
  PetscReal active = 0;  ///< share of the variables at a bound
  PetscErrorCode code = 0;
};

/// The point of the SNES, by the residual computed again.
PetscErrorCode judge(SNES snes, Vec x, Vec lower, Vec upper, Solved* solved);

// grids_test.cpp
PetscErrorCode grids_in_space();
PetscErrorCode periodic_grids();
PetscErrorCode free_edges();
PetscErrorCode odd_coarsenings();

// awkward_test.cpp
PetscErrorCode hardly_a_problem();
PetscErrorCode no_numbers();
PetscErrorCode refused_options();

// affine_test.cpp
PetscErrorCode cycling();
PetscErrorCode empty_rank();
PetscErrorCode crossing_bounds();
PetscErrorCode error_in_semismooth_step();
PetscErrorCode domain_error_without_rows();
PetscErrorCode no_variables();
PetscErrorCode error_of_python();
PetscErrorCode unsolvable();
PetscErrorCode zero_pivot_on_one_rank();
PetscErrorCode error_in_monitor();
PetscErrorCode test_on_one_rank();

}  // namespace perp::petsc_tests
