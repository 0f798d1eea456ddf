// SPDX-License-Identifier: Apache-2.0
/// The truncated matrices of all levels, against products that PETSc makes from the beginning for each face.
#include "petsc/multigrid.hpp"

#include <petscdmda.h>

#include <cmath>
#include <tuple>

#include "petsc/cases.hpp"

namespace perp::petsc_tests {
namespace {

using petsc::OwnDm;
using petsc::OwnMat;
using petsc::OwnVec;

struct Grid {
  PetscInt points, width;
  DMDAStencilType stencil;
};

/// Numbers between 0 and 1 that do not depend on the ranks' number.
PetscReal made_up(PetscInt i, PetscInt j) {
  const double x = std::sin(12.9898 * static_cast<double>(i + 1) + 78.233 * static_cast<double>(j + 3)) * 43758.5453;
  return x - std::floor(x);
}

/// The pattern of the grid with entries that look random, and a diagonal of about ten; not symmetric.
PetscErrorCode fill(Mat A, PetscInt seed) {
  PetscInt begin = 0;
  PetscInt end = 0;
  OwnMat pattern;
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  PetscCall(MatDuplicate(A, MAT_DO_NOT_COPY_VALUES, pattern.out()));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt n = 0;
    const PetscInt* column = nullptr;
    PetscCall(MatGetRow(pattern, i, &n, &column, nullptr));
    for (PetscInt k = 0; k < n; ++k) {
      const PetscReal value = made_up(i + seed, column[k]) + (column[k] == i ? 9.5 : -0.5);
      PetscCall(MatSetValue(A, i, column[k], value, INSERT_VALUES));
    }
    PetscCall(MatRestoreRow(pattern, i, &n, &column, nullptr));
  }
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  return MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY);
}

/// The share of the variables that are held is that of a block in the middle, some more, and of those that flip.
PetscErrorCode make_mask(Vec mask, Vec open, PetscReal held, PetscReal flipped, PetscInt seed) {
  PetscInt begin = 0;
  PetscInt all = 0;
  PetscCall(VecGetOwnershipRange(mask, &begin, nullptr));
  PetscCall(VecGetSize(mask, &all));
  const petsc::Reading is_open(open);
  petsc::Values m(mask);
  for (PetscInt k = 0; k < is_open.size(); ++k) {
    const PetscInt i = begin + k;
    const PetscReal place = static_cast<PetscReal>(i) / static_cast<PetscReal>(all);
    bool inside = std::abs(place - 0.5) > held / 2;
    if (made_up(i, seed) < flipped) inside = !inside;
    m[k] = inside && is_open[k] != 0 ? 1 : 0;
  }
  return 0;
}

PetscErrorCode difference(Mat expected, Mat found, PetscReal* relative) {
  OwnMat rest;
  PetscReal size = 0;
  PetscCall(MatNorm(expected, NORM_FROBENIUS, &size));
  PetscCall(MatDuplicate(expected, MAT_COPY_VALUES, rest.out()));
  PetscCall(MatAXPY(rest, -1, found, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatNorm(rest, NORM_FROBENIUS, relative));
  *relative /= size > 0 ? size : 1;
  return 0;
}

/// T := m T m, then (1 - m) d on the diagonal.
PetscErrorCode check_levels(petsc::Multigrid& grids, std::size_t first, Vec mask) {
  auto& levels = grids.levels();
  OwnMat T;
  OwnVec m;
  PetscCall(MatDuplicate(levels[first].A, MAT_COPY_VALUES, T.out()));
  PetscCall(VecDuplicate(mask, m.out()));
  PetscCall(VecCopy(mask, m));
  for (std::size_t k = first; k < levels.size(); ++k) {
    OwnMat S;
    OwnVec of_coarse;
    PetscReal wrong = 0;
    PetscBool same = PETSC_FALSE;
    PetscCall(VecEqual(m, levels[k].mask, &same));
    EXPECT(same, "the mask of level %d", static_cast<int>(k));
    PetscCall(MatDiagonalScale(T, m, m));
    if (k + 1 < levels.size()) {
      PetscCall(MatPtAP(T, levels[k].P, MAT_INITIAL_MATRIX, 2, S.out()));
      PetscCall(VecDuplicate(levels[k + 1].mask, of_coarse.out()));
      PetscCall(MatGetDiagonal(S, of_coarse));
      const petsc::Reading open(levels[k + 1].open);
      petsc::Values c(of_coarse);
      for (PetscInt i = 0; i < open.size(); ++i) c[i] = open[i] != 0 && std::abs(c[i]) > 1e-9 ? 1 : 0;
    }
    PetscCall(petsc::set_cut_off_diagonal(T, m, levels[k].diagonal));
    PetscCall(difference(T, levels[k].T, &wrong));
    EXPECT(wrong < 1e-13, "level %d of %d from %d: %g", static_cast<int>(k), static_cast<int>(levels.size()),
           static_cast<int>(first), wrong);
    T = std::move(S);
    m = std::move(of_coarse);
  }
  return 0;
}

PetscErrorCode check_faces(const Grid& g) {
  OwnDm dm;
  OwnMat A;
  OwnVec open;
  petsc::Multigrid grids;
  bool usable = false;
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, g.stencil, g.points, g.points,
                         PETSC_DECIDE, PETSC_DECIDE, g.width, 1, nullptr, nullptr, dm.out()));
  PetscCall(DMSetUp(dm));
  PetscCall(DMCreateMatrix(dm, A.out()));
  PetscCall(DMCreateGlobalVector(dm, open.out()));
  PetscCall(grids.take_hierarchy(dm, 20, &usable));
  EXPECT(usable && grids.levels().size() > 2, "%d levels", static_cast<int>(grids.levels().size()));
  PetscCall(VecSet(open, 1));
  PetscCall(make_mask(open, open, 0, 0.02, 3));
  for (PetscInt seed : {0, 5}) {  // J changes, its pattern does not
    PetscCall(fill(A, seed));
    PetscCall(grids.take_matrix(A, open));
    // Much, little and nothing changes; everything is held, and free again; coarse levels alone, as for a start.
    for (auto [first, held, flipped] : {std::tuple{1, 0.2, 0.1},
                                        {1, 0.2, 0.11},
                                        {2, 0.3, 0.0},
                                        {0, 0.3, 0.0},
                                        {0, 0.3, 0.01},
                                        {0, 0.3, 0.01},
                                        {0, 0.0, 1.0},
                                        {0, 0.0, 0.3},
                                        {0, 0.0, 0.0},
                                        {1, 0.5, 0.0},
                                        {0, 0.31, 0.02}}) {
      auto& level = grids.levels()[static_cast<std::size_t>(first)];
      OwnVec mask;
      PetscCall(VecDuplicate(level.mask, mask.out()));
      PetscCall(make_mask(mask, level.open, held, flipped, 7));
      PetscCall(grids.take_face(static_cast<std::size_t>(first), mask));
      PetscCall(check_levels(grids, static_cast<std::size_t>(first), mask));
    }
  }
  return 0;
}

}  // namespace

/// Rows that a change of the face bears on, on this rank or another one, would be out of date.
PetscErrorCode truncated_products() {
  for (const Grid& g : {Grid{129, 1, DMDA_STENCIL_STAR}, Grid{97, 2, DMDA_STENCIL_BOX}}) PetscCall(check_faces(g));
  return 0;
}

}  // namespace perp::petsc_tests
