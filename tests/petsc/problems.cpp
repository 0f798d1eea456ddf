// SPDX-License-Identifier: Apache-2.0
#include "petsc/problems.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perp::petsc_tests {
namespace {

bool last_rank() {
  int rank = 0;
  int ranks = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  return rank == ranks - 1;
}

bool on_boundary(const DMDALocalInfo& grid, PetscInt i, PetscInt j) {
  return i == 0 || j == 0 || i == grid.mx - 1 || j == grid.my - 1;
}

PetscErrorCode function(DMDALocalInfo* grid, PetscScalar** u, PetscScalar** F, void* data) {
  auto& m = *static_cast<Membrane*>(data);
  const PetscReal h = 1.0 / static_cast<PetscReal>(grid->mx - 1);
  const bool last = last_rank();
  ++m.evaluations;
  if (last && m.error_from > 0 && m.evaluations >= m.error_from) return PETSC_ERR_USER;
  if (last && m.outside_from > 0 && m.evaluations >= m.outside_from) PetscCall(SNESSetFunctionDomainError(m.snes));
  for (PetscInt j = grid->ys; j < grid->ys + grid->ym; ++j)
    for (PetscInt i = grid->xs; i < grid->xs + grid->xm; ++i) {
      F[j][i] = u[j][i];
      if (on_boundary(*grid, i, j)) continue;
      F[j][i] = 4 * u[j][i] - u[j][i - 1] - u[j][i + 1] - u[j - 1][i] - u[j + 1][i] +
                h * m.wind * (u[j][i] - u[j][i - 1]) - h * h * (m.load + m.bratu * std::exp(u[j][i]));
    }
  if (last && m.nan_from > 0 && m.evaluations >= m.nan_from && grid->xm > 0 && grid->ym > 0)
    F[grid->ys][grid->xs] = std::numeric_limits<double>::quiet_NaN();
  return 0;
}

PetscErrorCode jacobian(DMDALocalInfo* grid, PetscScalar** u, Mat, Mat J, void* data) {
  const auto& m = *static_cast<Membrane*>(data);
  const PetscReal h = 1.0 / static_cast<PetscReal>(grid->mx - 1);
  for (PetscInt j = grid->ys; j < grid->ys + grid->ym; ++j)
    for (PetscInt i = grid->xs; i < grid->xs + grid->xm; ++i) {
      const MatStencil row{.k = 0, .j = j, .i = i, .c = 0};
      if (on_boundary(*grid, i, j)) {
        const PetscScalar one = 1;
        PetscCall(MatSetValuesStencil(J, 1, &row, 1, &row, &one, INSERT_VALUES));
        continue;
      }
      const MatStencil columns[] = {row,
                                    {.k = 0, .j = j, .i = i - 1, .c = 0},
                                    {.k = 0, .j = j, .i = i + 1, .c = 0},
                                    {.k = 0, .j = j - 1, .i = i, .c = 0},
                                    {.k = 0, .j = j + 1, .i = i, .c = 0}};
      const PetscScalar values[] = {4 + h * m.wind - h * h * m.bratu * std::exp(u[j][i]), -1 - h * m.wind, -1, -1, -1};
      PetscCall(MatSetValuesStencil(J, 1, &row, 5, columns, values, INSERT_VALUES));
    }
  const bool last = last_rank();
  const MatStencil corner{.k = 0, .j = grid->ys, .i = grid->xs, .c = 0};
  const PetscScalar nan = std::numeric_limits<double>::quiet_NaN();
  if (m.nan_in_jacobian && last) PetscCall(MatSetValuesStencil(J, 1, &corner, 1, &corner, &nan, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY));
  if (m.outside_in_jacobian && last) PetscCall(SNESSetJacobianDomainError(m.snes));
  return m.error_in_jacobian && last ? PETSC_ERR_USER : 0;
}

PetscErrorCode bounds_of_snes(SNES snes, Vec lower, Vec upper) {
  DM dm = nullptr;
  void* data = nullptr;
  PetscCall(SNESGetDM(snes, &dm));
  PetscCall(DMGetApplicationContext(dm, static_cast<void*>(&data)));
  const auto& m = *static_cast<Membrane*>(data);
  return m.error_in_bounds && last_rank() ? PETSC_ERR_USER : fill_bounds(dm, m, lower, upper);
}

PetscErrorCode bounds_of_dm(DM dm, Vec lower, Vec upper) {
  void* data = nullptr;
  PetscCall(DMGetApplicationContext(dm, static_cast<void*>(&data)));
  return fill_bounds(dm, *static_cast<Membrane*>(data), lower, upper);
}

}  // namespace

PetscErrorCode fill_bounds(DM dm, const Membrane& m, Vec lower, Vec upper) {
  DMDALocalInfo grid;
  PetscScalar** l = nullptr;
  PetscScalar** u = nullptr;
  PetscCall(DMDAGetLocalInfo(dm, &grid));
  PetscCall(VecSet(lower, PETSC_NINFINITY));
  PetscCall(VecSet(upper, PETSC_INFINITY));
  PetscCall(DMDAVecGetArray(dm, lower, &l));
  PetscCall(DMDAVecGetArray(dm, upper, &u));
  const PetscReal h = 1.0 / static_cast<PetscReal>(grid.mx - 1);
  for (PetscInt j = grid.ys; j < grid.ys + grid.ym; ++j)
    for (PetscInt i = grid.xs; i < grid.xs + grid.xm; ++i) {
      if (on_boundary(grid, i, j)) continue;
      const PetscReal x = static_cast<PetscReal>(i) * h;
      const PetscReal y = static_cast<PetscReal>(j) * h;
      if (m.obstacle) l[j][i] = 0.25 - 8 * ((x - 0.4) * (x - 0.4) + (y - 0.45) * (y - 0.45));
      if (m.ceiling > 0) u[j][i] = m.ceiling;
      if (m.slope > 0) u[j][i] = m.slope * std::min({x, 1 - x, y, 1 - y});
      if (m.slope > 0) l[j][i] = -u[j][i];
    }
  PetscCall(DMDAVecRestoreArray(dm, lower, &l));
  return DMDAVecRestoreArray(dm, upper, &u);
}

PetscErrorCode make_membrane(PetscInt n, Bounds bounds, Membrane* membrane, DM* dm, SNES* snes) {
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_STAR, n, n, PETSC_DECIDE,
                         PETSC_DECIDE, 1, 1, nullptr, nullptr, dm));
  PetscCall(DMSetFromOptions(*dm));
  PetscCall(DMSetUp(*dm));
  PetscCall(DMSetApplicationContext(*dm, membrane));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, snes));
  membrane->snes = *snes;
  PetscCall(SNESSetDM(*snes, *dm));
  PetscCall(DMDASNESSetFunctionLocal(*dm, INSERT_VALUES, reinterpret_cast<DMDASNESFunction>(function), membrane));
  PetscCall(DMDASNESSetJacobianLocal(*dm, reinterpret_cast<DMDASNESJacobian>(jacobian), membrane));
  if (bounds == Bounds::Function) PetscCall(SNESVISetComputeVariableBounds(*snes, bounds_of_snes));
  if (bounds == Bounds::Dm) PetscCall(DMSetVariableBounds(*dm, bounds_of_dm));
  PetscCall(SNESSetFromOptions(*snes));
  if (bounds != Bounds::Vectors) return 0;
  Vec lower = nullptr;
  Vec upper = nullptr;
  Vec F = nullptr;
  PetscCall(DMCreateGlobalVector(*dm, &lower));
  PetscCall(VecDuplicate(lower, &upper));
  PetscCall(VecDuplicate(lower, &F));
  PetscCall(fill_bounds(*dm, *membrane, lower, upper));
  PetscCall(SNESSetFunction(*snes, F, nullptr, nullptr));
  PetscCall(SNESVISetVariableBounds(*snes, lower, upper));
  for (Vec* v : {&lower, &upper, &F}) PetscCall(VecDestroy(v));
  return 0;
}

PetscErrorCode independent_residual(SNES snes, Vec x, Vec lower, Vec upper, PetscReal* largest) {
  Vec F = nullptr;
  Vec point = nullptr;
  PetscCall(VecDuplicate(x, &F));
  PetscCall(VecDuplicate(x, &point));
  PetscCall(SNESComputeFunction(snes, x, F));
  PetscCall(VecWAXPY(point, -1, F, x));             // x - F
  PetscCall(VecPointwiseMax(point, point, lower));  // on the box
  PetscCall(VecPointwiseMin(point, point, upper));
  PetscCall(VecAXPY(point, -1, x));
  PetscCall(VecNorm(point, NORM_INFINITY, largest));
  PetscCall(VecDestroy(&point));
  return VecDestroy(&F);
}

}  // namespace perp::petsc_tests
