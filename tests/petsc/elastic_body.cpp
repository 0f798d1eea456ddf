// SPDX-License-Identifier: Apache-2.0
#include "petsc/elastic_body.hpp"

#include <algorithm>
#include <vector>

namespace perp::petsc_tests {
namespace {

/// The matrix of a square bilinear element, lambda = 1, mu = 1/2, by 2 x 2 points of Gauss.
void element(PetscScalar K[8][8]) {
  constexpr double lambda = 1;
  constexpr double mu = 0.5;
  constexpr double points[] = {0.21132486540518712, 0.78867513459481288};
  constexpr double cx[] = {0, 1, 1, 0};
  constexpr double cy[] = {0, 0, 1, 1};
  for (const double gx : points)
    for (const double gy : points) {
      double d[4][2];
      for (int a = 0; a < 4; ++a) {
        d[a][0] = (2 * cx[a] - 1) * (cy[a] > 0 ? gy : 1 - gy);
        d[a][1] = (2 * cy[a] - 1) * (cx[a] > 0 ? gx : 1 - gx);
      }
      for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
          const double* p = d[i / 2];
          const double* q = d[j / 2];
          const double same = i % 2 == j % 2 ? p[0] * q[0] + p[1] * q[1] : 0;
          K[i][j] += 0.25 * (lambda * p[i % 2] * q[j % 2] + mu * (p[j % 2] * q[i % 2] + same));
        }
    }
}

PetscErrorCode assemble(DM dm, Mat stiffness) {
  PetscScalar K[8][8] = {};
  DMDALocalInfo grid;
  element(K);
  PetscCall(DMDAGetLocalInfo(dm, &grid));
  for (PetscInt j = grid.ys; j < std::min(grid.ys + grid.ym, grid.my - 1); ++j)
    for (PetscInt i = grid.xs; i < std::min(grid.xs + grid.xm, grid.mx - 1); ++i) {
      MatStencil at[8];
      const PetscInt corner[4][2] = {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
      for (int a = 0; a < 8; ++a) at[a] = {.k = 0, .j = corner[a / 2][1], .i = corner[a / 2][0], .c = a % 2};
      PetscCall(MatSetValuesStencil(stiffness, 8, at, 8, at, K[0], ADD_VALUES));
    }
  PetscCall(MatAssemblyBegin(stiffness, MAT_FINAL_ASSEMBLY));
  return MatAssemblyEnd(stiffness, MAT_FINAL_ASSEMBLY);
}

PetscErrorCode function(SNES, Vec x, Vec F, void* data) {
  const auto& body = *static_cast<ElasticBody*>(data);
  PetscCall(MatMult(body.stiffness, x, F));
  return VecAXPY(F, -1, body.load);
}

PetscErrorCode jacobian(SNES, Vec, Mat, Mat J, void* data) {
  return MatCopy(static_cast<ElasticBody*>(data)->stiffness, J, SAME_NONZERO_PATTERN);
}

}  // namespace

PetscErrorCode make_elastic_body(PetscInt n, ElasticBody* body) {
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_BOX, n, n, PETSC_DECIDE,
                         PETSC_DECIDE, 2, 1, nullptr, nullptr, &body->dm));
  PetscCall(DMSetUp(body->dm));
  PetscCall(DMCreateMatrix(body->dm, &body->stiffness));
  for (Vec* v : {&body->load, &body->lower, &body->upper}) PetscCall(DMCreateGlobalVector(body->dm, v));
  PetscCall(assemble(body->dm, body->stiffness));
  PetscCall(VecSet(body->lower, PETSC_NINFINITY));
  PetscCall(VecSet(body->upper, PETSC_INFINITY));
  DMDALocalInfo grid;
  PetscScalar*** l = nullptr;
  PetscScalar*** f = nullptr;
  std::vector<MatStencil> top;
  PetscCall(DMDAGetLocalInfo(body->dm, &grid));
  PetscCall(DMDAVecGetArrayDOF(body->dm, body->lower, &l));
  PetscCall(DMDAVecGetArrayDOF(body->dm, body->load, &f));
  for (PetscInt i = grid.xs; i < grid.xs + grid.xm; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(n - 1);
    if (grid.ys == 0) l[0][i][1] = -0.02 - 0.2 * (x - 0.4) * (x - 0.4);
    if (grid.ys + grid.ym < grid.my) continue;
    for (PetscInt c = 0; c < 2; ++c) top.push_back({.k = 0, .j = grid.my - 1, .i = i, .c = c});
    f[grid.my - 1][i][1] = -0.1;
  }
  PetscCall(DMDAVecRestoreArrayDOF(body->dm, body->lower, &l));
  PetscCall(DMDAVecRestoreArrayDOF(body->dm, body->load, &f));
  PetscCall(MatSetOption(body->stiffness, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  return MatZeroRowsStencil(body->stiffness, static_cast<PetscInt>(top.size()), top.data(), 1, nullptr, nullptr);
}

PetscErrorCode make_snes(ElasticBody* body, SNES* snes) {
  PetscCall(SNESCreate(PETSC_COMM_WORLD, snes));
  PetscCall(SNESSetDM(*snes, body->dm));
  PetscCall(SNESSetFunction(*snes, nullptr, function, body));
  PetscCall(SNESSetJacobian(*snes, nullptr, nullptr, jacobian, body));
  PetscCall(SNESVISetVariableBounds(*snes, body->lower, body->upper));
  return SNESSetFromOptions(*snes);
}

PetscErrorCode destroy(ElasticBody* body) {
  PetscCall(MatDestroy(&body->stiffness));
  for (Vec* v : {&body->load, &body->lower, &body->upper}) PetscCall(VecDestroy(v));
  return DMDestroy(&body->dm);
}

}  // namespace perp::petsc_tests
