// SPDX-License-Identifier: Apache-2.0
#include "grid_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace perp::bench {
namespace {

constexpr double eccentricity = 0.1;

struct Grid {
  explicit Grid(const GridProblem& p) : problem(p) {
    DMDAGetLocalInfo(p.dm, &info);
    hx = p.width / static_cast<double>(info.mx - 1);
    hy = p.height / static_cast<double>(info.my - 1);
  }
  bool boundary(PetscInt i, PetscInt j) const { return i == 0 || j == 0 || i == info.mx - 1 || j == info.my - 1; }
  double x(double i) const { return i * hx; }
  double y(double j) const { return j * hy; }
  double conductivity(double i) const {
    return problem.name == "journal-bearing" ? std::pow(1 + eccentricity * std::cos(x(i)), 3) : 1;
  }
  double load(PetscInt i) const {
    const double source = problem.name == "journal-bearing" ? eccentricity * std::sin(x(static_cast<double>(i)))
                          : problem.name == "obstacle"      ? 1
                          : problem.name == "torsion"       ? 5
                                                            : 0;
    return hx * hy * source;
  }
  /// West, east, south, north.
  std::array<double, 4> weights(PetscInt k) const {
    const auto i = static_cast<double>(k);
    const double along = conductivity(i) * hx / hy;
    return {conductivity(i - 0.5) * hy / hx, conductivity(i + 0.5) * hy / hx, along, along};
  }

  const GridProblem& problem;
  DMDALocalInfo info{};
  double hx = 0, hy = 0;
};

PetscErrorCode bounds_of_membrane(const GridProblem& p, Vec lower, Vec upper) {
  const Grid grid(p);
  PetscScalar** l = nullptr;
  PetscScalar** u = nullptr;
  PetscCall(DMDAVecGetArray(p.dm, lower, &l));
  PetscCall(DMDAVecGetArray(p.dm, upper, &u));
  for (PetscInt j = grid.info.ys; j < grid.info.ys + grid.info.ym; ++j)
    for (PetscInt i = grid.info.xs; i < grid.info.xs + grid.info.xm; ++i) {
      if (grid.boundary(i, j)) continue;
      const double x = grid.x(static_cast<double>(i));
      const double y = grid.y(static_cast<double>(j));
      if (p.name == "obstacle") {
        const double wave = std::sin(9.2 * x) * std::sin(9.3 * y);
        l[j][i] = wave * wave * wave;
        u[j][i] = wave * wave + 0.02;
      } else if (p.name == "torsion") {
        u[j][i] = std::min({x, 1 - x, y, 1 - y});
        l[j][i] = -u[j][i];
      } else if (p.name == "journal-bearing") {
        l[j][i] = 0;
      } else {
        u[j][i] = 0.4;
      }
    }
  PetscCall(DMDAVecRestoreArray(p.dm, lower, &l));
  return DMDAVecRestoreArray(p.dm, upper, &u);
}

/// The matrix of a square bilinear element in plane strain, lambda = 1, mu = 1/2: 2 x 2 points of Gauss.
std::array<std::array<double, 8>, 8> element() {
  constexpr double lambda = 1;
  constexpr double mu = 0.5;
  constexpr double cx[] = {0, 1, 1, 0};
  constexpr double cy[] = {0, 0, 1, 1};
  std::array<std::array<double, 8>, 8> K{};
  for (const double gx : {0.5 - 0.5 / std::numbers::sqrt3, 0.5 + 0.5 / std::numbers::sqrt3})
    for (const double gy : {0.5 - 0.5 / std::numbers::sqrt3, 0.5 + 0.5 / std::numbers::sqrt3}) {
      double d[4][2];
      for (int a = 0; a < 4; ++a) {
        d[a][0] = (2 * cx[a] - 1) * (cy[a] > 0 ? gy : 1 - gy);
        d[a][1] = (2 * cy[a] - 1) * (cx[a] > 0 ? gx : 1 - gx);
      }
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
          for (int r = 0; r < 2; ++r)
            for (int s = 0; s < 2; ++s) {
              const double same = r == s ? d[a][0] * d[b][0] + d[a][1] * d[b][1] : 0;
              K[static_cast<std::size_t>(2 * a + r)][static_cast<std::size_t>(2 * b + s)] +=
                  0.25 * (lambda * d[a][r] * d[b][s] + mu * (d[a][s] * d[b][r] + same));
            }
    }
  return K;
}

/// The gap under the bottom.
PetscErrorCode bounds_of_body(const GridProblem& p, Vec lower) {
  const Grid grid(p);
  PetscScalar*** l = nullptr;
  PetscCall(DMDAVecGetArrayDOF(p.dm, lower, &l));
  for (PetscInt i = grid.info.xs; i < grid.info.xs + grid.info.xm && grid.info.ys == 0; ++i) {
    const double x = grid.x(static_cast<double>(i));
    l[0][i][1] = -0.02 - 0.2 * (x - 0.4) * (x - 0.4);
  }
  return DMDAVecRestoreArrayDOF(p.dm, lower, &l);
}

/// The stiffness matrix with u given on top, and the load that says so. The columns of what is given are left out too,
/// so that it is symmetric.
PetscErrorCode make_body(GridProblem* p) {
  const Grid grid(*p);
  const auto K = element();
  PetscInt xs = 0;
  PetscInt ys = 0;
  PetscInt xm = 0;
  PetscInt ym = 0;
  PetscCall(DMCreateMatrix(p->dm, &p->stiffness));
  PetscCall(DMDAGetCorners(p->dm, &xs, &ys, nullptr, &xm, &ym, nullptr));
  for (PetscInt j = ys; j < std::min(ys + ym, grid.info.my - 1); ++j)
    for (PetscInt i = xs; i < std::min(xs + xm, grid.info.mx - 1); ++i) {
      MatStencil at[8];
      const PetscInt corner[4][2] = {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
      for (int a = 0; a < 8; ++a) at[a] = {.k = 0, .j = corner[a / 2][1], .i = corner[a / 2][0], .c = a % 2};
      PetscCall(MatSetValuesStencil(p->stiffness, 8, at, 8, at, K[0].data(), ADD_VALUES));
    }
  PetscCall(MatAssemblyBegin(p->stiffness, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(p->stiffness, MAT_FINAL_ASSEMBLY));
  std::vector<MatStencil> top;
  Vec given = nullptr;
  PetscScalar*** u = nullptr;
  PetscCall(DMCreateGlobalVector(p->dm, &p->load));
  PetscCall(VecDuplicate(p->load, &given));
  PetscCall(DMDAVecGetArrayDOF(p->dm, given, &u));
  for (PetscInt i = xs; i < xs + xm && ys + ym == grid.info.my; ++i) {
    for (PetscInt c = 0; c < 2; ++c) top.push_back({.k = 0, .j = grid.info.my - 1, .i = i, .c = c});
    u[grid.info.my - 1][i][1] = -0.1;
  }
  PetscCall(DMDAVecRestoreArrayDOF(p->dm, given, &u));
  PetscCall(MatSetOption(p->stiffness, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  PetscCall(MatZeroRowsColumnsStencil(p->stiffness, static_cast<PetscInt>(top.size()), top.data(), 1, given, p->load));
  return VecDestroy(&given);
}

}  // namespace

PetscErrorCode make_problem(const std::string& name, PetscInt points, GridProblem* p) {
  const bool body = name == "signorini";
  DM dm = nullptr;
  if (!body && name != "obstacle" && name != "torsion" && name != "journal-bearing" && name != "bratu")
    SETERRQ(PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "there is no problem %s", name.c_str());
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE,
                         body ? DMDA_STENCIL_BOX : DMDA_STENCIL_STAR, points, points, PETSC_DECIDE, PETSC_DECIDE,
                         body ? 2 : 1, 1, nullptr, nullptr, &dm));
  PetscCall(DMSetFromOptions(dm));
  PetscCall(DMSetUp(dm));
  PetscCall(on_grid(name, dm, p));
  return DMDestroy(&dm);
}

PetscErrorCode on_grid(const std::string& name, DM dm, GridProblem* p) {
  p->name = name;
  PetscCall(PetscObjectReference(reinterpret_cast<PetscObject>(dm)));
  p->dm = dm;
  if (name == "journal-bearing") p->width = 2 * std::numbers::pi;
  if (name == "journal-bearing") p->height = 20;
  if (name == "bratu") p->exponential = 6;
  return name == "signorini" ? make_body(p) : 0;
}

PetscErrorCode bounds(const GridProblem& p, Vec lower, Vec upper) {
  PetscCall(VecSet(lower, PETSC_NINFINITY));
  PetscCall(VecSet(upper, PETSC_INFINITY));
  return p.stiffness != nullptr ? bounds_of_body(p, lower) : bounds_of_membrane(p, lower, upper);
}

PetscErrorCode evaluate(const GridProblem& p, Vec x, Vec F) {
  if (p.stiffness != nullptr) {
    PetscCall(MatMult(p.stiffness, x, F));
    return VecAXPY(F, -1, p.load);
  }
  const Grid grid(p);
  Vec local = nullptr;
  PetscScalar** u = nullptr;
  PetscScalar** f = nullptr;
  PetscCall(DMGetLocalVector(p.dm, &local));
  PetscCall(DMGlobalToLocal(p.dm, x, INSERT_VALUES, local));
  PetscCall(DMDAVecGetArrayRead(p.dm, local, &u));
  PetscCall(DMDAVecGetArray(p.dm, F, &f));
  for (PetscInt j = grid.info.ys; j < grid.info.ys + grid.info.ym; ++j)
    for (PetscInt i = grid.info.xs; i < grid.info.xs + grid.info.xm; ++i) {
      f[j][i] = u[j][i];
      if (grid.boundary(i, j)) continue;
      const auto [w, e, s, n] = grid.weights(i);
      f[j][i] = w * (u[j][i] - u[j][i - 1]) + e * (u[j][i] - u[j][i + 1]) + s * (u[j][i] - u[j - 1][i]) +
                n * (u[j][i] - u[j + 1][i]) - grid.load(i);
      if (p.exponential > 0) f[j][i] -= p.exponential * grid.hx * grid.hy * std::exp(u[j][i]);
    }
  PetscCall(DMDAVecRestoreArrayRead(p.dm, local, &u));
  PetscCall(DMDAVecRestoreArray(p.dm, F, &f));
  return DMRestoreLocalVector(p.dm, &local);
}

/// The columns of boundary points are left out, so that J is symmetric: u is 0 there and stays so.
PetscErrorCode jacobian(const GridProblem& p, Vec x, Mat J) {
  if (p.stiffness != nullptr) return MatCopy(p.stiffness, J, SAME_NONZERO_PATTERN);
  const Grid grid(p);
  PetscScalar** u = nullptr;
  PetscCall(DMDAVecGetArrayRead(p.dm, x, &u));
  for (PetscInt j = grid.info.ys; j < grid.info.ys + grid.info.ym; ++j)
    for (PetscInt i = grid.info.xs; i < grid.info.xs + grid.info.xm; ++i) {
      const MatStencil row{.k = 0, .j = j, .i = i, .c = 0};
      std::array<MatStencil, 5> columns{row};
      std::array<PetscScalar, 5> values{1};
      PetscInt n = 1;
      if (!grid.boundary(i, j)) {
        const auto weights = grid.weights(i);
        constexpr PetscInt steps[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
        values[0] = weights[0] + weights[1] + weights[2] + weights[3];
        if (p.exponential > 0) values[0] -= p.exponential * grid.hx * grid.hy * std::exp(u[j][i]);
        for (std::size_t k = 0; k < 4; ++k) {
          const PetscInt i2 = i + steps[k][0];
          const PetscInt j2 = j + steps[k][1];
          if (grid.boundary(i2, j2)) continue;
          columns[static_cast<std::size_t>(n)] = {.k = 0, .j = j2, .i = i2, .c = 0};
          values[static_cast<std::size_t>(n++)] = -weights[k];
        }
      }
      PetscCall(MatSetValuesStencil(J, 1, &row, n, columns.data(), values.data(), INSERT_VALUES));
    }
  PetscCall(DMDAVecRestoreArrayRead(p.dm, x, &u));
  PetscCall(MatAssemblyBegin(J, MAT_FINAL_ASSEMBLY));
  return MatAssemblyEnd(J, MAT_FINAL_ASSEMBLY);
}

/// For an affine F, x'(F(x) + F(0)) / 2; Bratu's exponential is added.
PetscErrorCode objective(const GridProblem& p, Vec x, PetscReal* value, Vec F) {
  Vec other = nullptr;
  PetscScalar at_x = 0;
  PetscScalar at_0 = 0;
  GridProblem affine = p;
  affine.exponential = 0;
  PetscCall(VecDuplicate(x, &other));
  PetscCall(VecSet(other, 0));
  PetscCall(evaluate(affine, other, F));
  PetscCall(VecDot(x, F, &at_0));
  PetscCall(evaluate(affine, x, F));
  PetscCall(VecDot(x, F, &at_x));
  *value = 0.5 * (at_x + at_0);
  if (p.exponential > 0) {
    const Grid grid(p);
    PetscScalar sum = 0;
    PetscCall(VecCopy(x, other));
    PetscCall(VecExp(other));
    PetscCall(VecSum(other, &sum));
    *value -= p.exponential * grid.hx * grid.hy * sum;  // the boundary adds a constant
    PetscCall(evaluate(p, x, F));
  }
  return VecDestroy(&other);
}

PetscErrorCode destroy(GridProblem* p) {
  PetscCall(MatDestroy(&p->stiffness));
  PetscCall(VecDestroy(&p->load));
  return DMDestroy(&p->dm);
}

}  // namespace perp::bench
