// SPDX-License-Identifier: Apache-2.0
/// Membranes over obstacles on grids of one, two and three dimensions, periodic ones, and such as cannot be coarsened
/// or only look as if they could. Written against PETSc's public interface alone.
#include <petscdmda.h>
#include <petscsnes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "petsc/cases.hpp"
#include "petsc/problems.hpp"

namespace perp::petsc_tests {
namespace {

enum class Edge { Fixed, Free, Periodic };  // u = 0; no force; none

struct Grid {
  const char* name;
  std::array<PetscInt, 3> points;
  Edge edge = Edge::Fixed;
  bool multigrid = true;  ///< expected
  DMDAInterpolationType interpolation = DMDA_Q1;
  const char* coarsen = nullptr;  ///< by so many, as -da_refine_x and so on say; 2 where null
  int alone = -1;                 ///< the rank that has one point alone in the first direction
};

struct Problem {
  Mat A = nullptr;
  Vec q = nullptr, lower = nullptr, upper = nullptr;
  DM dm = nullptr;
  DMDALocalInfo info{};
};

PetscInt dimensions(const Grid& g) { return g.points[2] > 0 ? 3 : g.points[1] > 0 ? 2 : 1; }

PetscErrorCode make_grid(const Grid& g, DM* dm) {
  const PetscInt dim = dimensions(g);
  const DMBoundaryType b = g.edge == Edge::Periodic ? DM_BOUNDARY_PERIODIC : DM_BOUNDARY_NONE;
  int ranks = 0;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  const bool uneven = g.alone >= 0 && g.alone < ranks && ranks > 1;
  std::vector<PetscInt> x(static_cast<std::size_t>(ranks), 0);
  for (PetscInt left = g.points[0] - 1, k = 0; uneven && left > 0; ++k) {
    const auto rank = static_cast<int>(k % ranks);
    if (rank == g.alone) continue;
    ++x[static_cast<std::size_t>(rank)];
    --left;
  }
  if (uneven) x[static_cast<std::size_t>(g.alone)] = 1;
  PetscCall(DMDACreate(PETSC_COMM_WORLD, dm));
  PetscCall(DMSetDimension(*dm, dim));
  PetscCall(DMDASetSizes(*dm, g.points[0], std::max<PetscInt>(g.points[1], 1), std::max<PetscInt>(g.points[2], 1)));
  PetscCall(DMDASetBoundaryType(*dm, b, b, b));
  PetscCall(DMDASetDof(*dm, 1));
  PetscCall(DMDASetStencilType(*dm, DMDA_STENCIL_STAR));
  PetscCall(DMDASetStencilWidth(*dm, 1));
  if (uneven) {
    PetscCall(DMDASetNumProcs(*dm, ranks, 1, 1));
    PetscCall(DMDASetOwnershipRanges(*dm, x.data(), nullptr, nullptr));
  }
  for (const char* key : {"-da_refine_x", "-da_refine_y", "-da_refine_z"})
    if (g.coarsen != nullptr) PetscCall(PetscOptionsSetValue(nullptr, key, g.coarsen));
  PetscCall(DMSetFromOptions(*dm));
  for (const char* key : {"-da_refine_x", "-da_refine_y", "-da_refine_z"})
    if (g.coarsen != nullptr) PetscCall(PetscOptionsClearValue(nullptr, key));
  PetscCall(DMDASetInterpolationType(*dm, g.interpolation));
  return DMSetUp(*dm);
}

/// h^2 times the equations -Laplace u = -4, and an obstacle that is highest in the middle, or a wave.
PetscErrorCode assemble(const Grid& g, Problem* p) {
  const PetscInt dim = dimensions(g);
  const DMDALocalInfo& at = p->info;
  const std::array<PetscInt, 3> begin{at.xs, at.ys, at.zs};
  const std::array<PetscInt, 3> count{at.xm, at.ym, at.zm};
  const PetscReal h = 1.0 / static_cast<PetscReal>(g.points[0]);
  const auto d_of = [](PetscInt d) { return static_cast<std::size_t>(d); };
  const auto fixed = [&](const std::array<PetscInt, 3>& i) {
    bool edge = false;
    for (PetscInt d = 0; d < dim; ++d) edge = edge || i[d_of(d)] == 0 || i[d_of(d)] == g.points[d_of(d)] - 1;
    return edge && g.edge == Edge::Fixed;
  };
  const auto set = [&](Mat A, const std::array<PetscInt, 3>& i, const std::array<PetscInt, 3>& j, PetscReal value) {
    const MatStencil row{.k = i[2], .j = i[1], .i = i[0], .c = 0};
    const MatStencil column{.k = j[2], .j = j[1], .i = j[0], .c = 0};
    return MatSetValuesStencil(A, 1, &row, 1, &column, &value, ADD_VALUES);
  };
  PetscCall(VecSet(p->lower, PETSC_NINFINITY));
  PetscCall(VecSet(p->upper, PETSC_INFINITY));
  ISLocalToGlobalMapping numbers = nullptr;
  PetscCall(DMGetLocalToGlobalMapping(p->dm, &numbers));
  const PetscInt all = count[0] * count[1] * count[2];
  PetscInt row = 0;
  PetscCall(VecGetOwnershipRange(p->q, &row, nullptr));
  for (PetscInt k = 0; k < all; ++k, ++row) {  // the order of PETSc's vectors
    const std::array<PetscInt, 3> i{begin[0] + k % count[0], begin[1] + k / count[0] % count[1],
                                    begin[2] + k / (count[0] * count[1])};
    PetscReal obstacle = g.edge == Edge::Fixed ? 0.25 : 0;
    for (PetscInt d = 0; d < dim; ++d) {
      const PetscReal x = static_cast<PetscReal>(i[d_of(d)]) / static_cast<PetscReal>(g.points[d_of(d)]);
      obstacle += g.edge == Edge::Fixed ? -4 * (x - 0.45) * (x - 0.45) : 0.3 * std::sin(2 * PETSC_PI * (x + 0.1));
    }
    if (fixed(i)) {
      PetscCall(set(p->A, i, i, 1));
      continue;
    }
    PetscCall(VecSetValue(p->q, row, 4 * h * h, INSERT_VALUES));
    PetscCall(VecSetValue(p->lower, row, obstacle, INSERT_VALUES));
    for (PetscInt d = 0; d < dim; ++d)
      for (PetscInt side : {-1, 1}) {
        auto j = i;
        j[d_of(d)] += side;
        const bool outside = j[d_of(d)] < 0 || j[d_of(d)] >= g.points[d_of(d)];
        if (outside && g.edge != Edge::Periodic) continue;
        PetscCall(set(p->A, i, i, 1));
        if (!fixed(j)) PetscCall(set(p->A, i, j, -1));
      }
  }
  for (Vec v : {p->q, p->lower}) {
    PetscCall(VecAssemblyBegin(v));
    PetscCall(VecAssemblyEnd(v));
  }
  PetscCall(MatAssemblyBegin(p->A, MAT_FINAL_ASSEMBLY));
  return MatAssemblyEnd(p->A, MAT_FINAL_ASSEMBLY);
}

PetscErrorCode function(SNES, Vec x, Vec F, void* data) {
  const auto& p = *static_cast<Problem*>(data);
  return MatMultAdd(p.A, x, p.q, F);
}
PetscErrorCode jacobian(SNES, Vec, Mat, Mat J, void* data) {
  return MatCopy(static_cast<Problem*>(data)->A, J, SAME_NONZERO_PATTERN);
}

PetscErrorCode check(const Grid& g, PetscReal start = 0) {
  Problem p;
  SNES snes = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  Vec x = nullptr;
  Solved s;
  PetscBool multigrid = PETSC_FALSE;
  PetscCall(make_grid(g, &p.dm));
  PetscCall(DMDAGetLocalInfo(p.dm, &p.info));
  PetscCall(DMCreateMatrix(p.dm, &p.A));
  for (Vec* v : {&p.q, &p.lower, &p.upper, &x}) PetscCall(DMCreateGlobalVector(p.dm, v));
  PetscCall(assemble(g, &p));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetDM(snes, p.dm));
  PetscCall(SNESSetFunction(snes, nullptr, function, &p));
  PetscCall(SNESSetJacobian(snes, nullptr, nullptr, jacobian, &p));
  PetscCall(SNESVISetVariableBounds(snes, p.lower, p.upper));
  PetscCall(SNESSetTolerances(snes, 1e-12, 0, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(VecSet(x, start));
  s.code = SNESSolve(snes, nullptr, x);
  EXPECT(s.code == 0, "%s: error %d", g.name, static_cast<int>(s.code));
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &multigrid));
  PetscCall(judge(snes, x, p.lower, p.upper, &s));
  EXPECT(s.reason > 0 && s.residual <= 1e-10, "%s: reason %d, residual %g", g.name, static_cast<int>(s.reason),
         s.residual);
  EXPECT(s.active > 0.01 && s.active < 0.99, "%s: %g of the variables are at bounds", g.name, s.active);
  EXPECT(s.steps <= 12, "%s: %d steps", g.name, static_cast<int>(s.steps));
  EXPECT((multigrid == PETSC_TRUE) == g.multigrid, "%s: multigrid is %s", g.name, multigrid ? "used" : "not used");
  for (Vec* v : {&p.q, &p.lower, &p.upper, &x}) PetscCall(VecDestroy(v));
  PetscCall(MatDestroy(&p.A));
  PetscCall(SNESDestroy(&snes));
  return DMDestroy(&p.dm);
}

}  // namespace

PetscErrorCode grids_in_space() {
  for (const Grid& g : {Grid{.name = "line", .points = {257, 0, 0}}, Grid{.name = "space", .points = {33, 33, 33}},
                        Grid{.name = "slab", .points = {65, 33, 17}},
                        Grid{.name = "thin slab", .points = {65, 65, 3}, .multigrid = false},
                        Grid{.name = "even", .points = {16, 17, 17}, .multigrid = false}})
    PetscCall(check(g));
  return 0;
}

PetscErrorCode periodic_grids() {
  for (const Grid& g : {Grid{.name = "line", .points = {256, 0, 0}, .edge = Edge::Periodic},
                        Grid{.name = "plane", .points = {64, 64, 0}, .edge = Edge::Periodic},
                        Grid{.name = "space", .points = {24, 24, 24}, .edge = Edge::Periodic},
                        Grid{.name = "odd", .points = {33, 33, 0}, .edge = Edge::Periodic, .multigrid = false}})
    for (PetscReal start : {0, 2}) PetscCall(check(g, start));
  return 0;
}

/// Without contact nothing holds the membrane: the equations on the whole grid are singular.
PetscErrorCode free_edges() {
  for (const Grid& g : {Grid{.name = "line", .points = {257, 0, 0}, .edge = Edge::Free},
                        Grid{.name = "plane", .points = {65, 65, 0}, .edge = Edge::Free},
                        Grid{.name = "space", .points = {17, 17, 17}, .edge = Edge::Free},
                        Grid{.name = "uncoarsened", .points = {50, 50, 0}, .edge = Edge::Free, .multigrid = false}})
    for (PetscReal start : {0, 2}) PetscCall(check(g, start));
  return 0;
}

/// Piecewise constants, a third of the points, a rank with one point.
PetscErrorCode odd_coarsenings() {
  for (const Grid& g :
       {Grid{.name = "constants", .points = {65, 65, 0}, .multigrid = false, .interpolation = DMDA_Q0},
        Grid{.name = "even constants", .points = {64, 64, 0}, .multigrid = false, .interpolation = DMDA_Q0},
        Grid{.name = "by three", .points = {65, 65, 0}, .multigrid = false, .coarsen = "3"},
        Grid{.name = "first alone", .points = {65, 65, 0}, .alone = 0},
        Grid{.name = "second alone", .points = {65, 65, 0}, .alone = 1},
        Grid{.name = "line", .points = {513, 0, 0}, .alone = 1}})
    PetscCall(check(g));
  return 0;
}

}  // namespace perp::petsc_tests
