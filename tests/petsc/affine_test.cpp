// SPDX-License-Identifier: Apache-2.0
/// Affine problems of a few rows, without a DM: what goes wrong on one rank, and problems that have no solution.
#include <petscsnes.h>

#include <cmath>
#include <limits>

#include "petsc/cases.hpp"

namespace perp::petsc_tests {
namespace {

struct Setting {
  bool corner = false;   ///< the start is (1, 0, 0, ...)
  int error_from = 0;    ///< F fails on the last rank from this evaluation on, where positive
  int outside_from = 0;  ///< likewise: SNESSetFunctionDomainError
  PetscErrorCode error = PETSC_ERR_USER;
  int error_in_monitor = 0;  ///< the last rank's monitor fails in this iteration, where positive
  bool uneven = false;       ///< q varies about the load
  bool own_test = false;     ///< the last rank alone says at once that it has converged
};
struct Affine {
  Vec q = nullptr;
  Setting setting;
  int evaluations = 0;
};

bool on_last_rank() {
  int rank = 0;
  int ranks = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  return rank == ranks - 1;
}

PetscErrorCode affine_function(SNES snes, Vec x, Vec F, void* data) {
  Mat M = nullptr;
  auto& a = *static_cast<Affine*>(data);
  const auto due = [&](int from) { return on_last_rank() && from > 0 && a.evaluations >= from; };
  ++a.evaluations;
  if (due(a.setting.outside_from)) PetscCall(SNESSetFunctionDomainError(snes));
  PetscCall(SNESGetJacobian(snes, nullptr, &M, nullptr, nullptr));
  PetscCall(MatMultAdd(M, x, a.q, F));
  return due(a.setting.error_from) ? a.setting.error : 0;
}
PetscErrorCode affine_jacobian(SNES, Vec, Mat, Mat, void*) { return 0; }
PetscErrorCode failing_monitor(SNES, PetscInt k, PetscReal, void* data) {
  const int due = static_cast<Affine*>(data)->setting.error_in_monitor;
  return on_last_rank() && due > 0 && k == due ? PETSC_ERR_USER : 0;
}
PetscErrorCode test_of_last_rank(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason* reason, void*) {
  *reason = on_last_rank() ? SNES_DIVERGED_MAX_IT : SNES_CONVERGED_ITERATING;
  return 0;
}

/// F = M x + q with M_ij = entry(i, j), x >= 0.
template <class Entry>
PetscErrorCode solve_affine(PetscInt n, Entry entry, PetscReal load, PetscReal lower, PetscReal upper, Solved* solved,
                            PetscReal* x0, Setting setting = {}) {
  Mat M = nullptr;
  Vec x = nullptr;
  Vec F = nullptr;
  Affine a{.setting = setting};
  Vec& q = a.q;
  Vec l = nullptr;
  Vec u = nullptr;
  SNES snes = nullptr;
  PetscInt begin = 0;
  PetscInt end = 0;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, n, n, n, nullptr, n, nullptr, &M));
  PetscCall(MatGetOwnershipRange(M, &begin, &end));
  for (PetscInt i = begin; i < end; ++i)
    for (PetscInt j = 0; j < n; ++j) PetscCall(MatSetValue(M, i, j, entry(i, j), INSERT_VALUES));
  PetscCall(MatAssemblyBegin(M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreateVecs(M, &x, &F));
  for (Vec* v : {&q, &l, &u}) PetscCall(VecDuplicate(x, v));
  PetscCall(VecSet(q, load));
  for (PetscInt i = begin; i < end && setting.uneven; ++i)
    PetscCall(VecSetValue(q, i, load + 2 * std::sin(static_cast<double>(i * i)), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(q));
  PetscCall(VecAssemblyEnd(q));
  PetscCall(VecSet(l, lower));
  PetscCall(VecSet(u, upper));
  PetscCall(VecSet(x, *x0));
  if (setting.corner && begin == 0 && end > 0) PetscCall(VecSetValue(x, 0, 1, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(x));
  PetscCall(VecAssemblyEnd(x));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetFunction(snes, F, affine_function, &a));
  PetscCall(SNESSetJacobian(snes, M, M, affine_jacobian, nullptr));
  PetscCall(SNESVISetVariableBounds(snes, l, u));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESMonitorSet(snes, failing_monitor, &a, nullptr));
  if (setting.own_test) PetscCall(SNESSetConvergenceTest(snes, test_of_last_rank, nullptr, nullptr));
  solved->code = SNESSolve(snes, nullptr, x);
  a.setting = {};
  if (solved->code == 0) PetscCall(judge(snes, x, l, u, solved));
  PetscCall(VecNorm(x, NORM_INFINITY, x0));
  PetscCall(SNESDestroy(&snes));
  for (Vec* v : {&x, &F, &q, &l, &u}) PetscCall(VecDestroy(v));
  return MatDestroy(&M);
}

PetscReal cyclic(PetscInt i, PetscInt j) { return i == j ? 1.0 : (i + 1) % 3 == j ? 2.0 : 0.0; }

}  // namespace

/// Murty's matrix of order 3, upside down: a P-matrix on which active-set steps from (1, 0, 0) go to (0, 1, 0), (0, 0,
/// 1) and back (Kanzow 1996 has such ones), so that only the semismooth steps get through. The solution is 1/3
/// everywhere.
PetscErrorCode cycling() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(3, cyclic, -1, 0, PETSC_INFINITY, &s, &x, {.corner = true}));
  EXPECT(s.code == 0 && s.reason > 0, "error %d, reason %d", static_cast<int>(s.code), static_cast<int>(s.reason));
  EXPECT(s.residual <= 1e-7, "residual %g", s.residual);
  EXPECT(s.steps > 10, "%d steps: no cycle", static_cast<int>(s.steps));
  EXPECT(std::abs(x - 1.0 / 3) <= 1e-7, "x is %g", x);
  return 0;
}

/// Fewer rows than ranks: two variables, 2 x - 1 on the diagonal, 1 beside it. x = 1/3 both.
PetscErrorCode empty_rank() {
  Solved s;
  PetscReal x = 5;
  PetscCall(solve_affine(
      2, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 1.0; }, -1, 0, 10, &s, &x));
  EXPECT(s.code == 0 && s.reason > 0, "error %d, reason %d", static_cast<int>(s.code), static_cast<int>(s.reason));
  EXPECT(std::abs(x - 1.0 / 3) <= 1e-7, "x is %g", x);
  return 0;
}

/// An error on every rank, not on the one alone that has the variable.
PetscErrorCode crossing_bounds() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(
      7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.0; }, -1, 1, 0, &s, &x));
  EXPECT(s.code == PETSC_ERR_ARG_OUTOFRANGE, "error %d", static_cast<int>(s.code));
  const PetscReal nan = std::numeric_limits<double>::quiet_NaN();
  PetscCall(solve_affine(
      7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.0; }, -1, 0, nan, &s, &x));
  EXPECT(s.code == PETSC_ERR_ARG_OUTOFRANGE, "error %d", static_cast<int>(s.code));
  // All at infinity: no point of the box has numbers.
  PetscCall(solve_affine(
      7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.0; }, -1, PETSC_INFINITY, PETSC_INFINITY, &s, &x));
  EXPECT(s.code == PETSC_ERR_ARG_OUTOFRANGE, "error %d", static_cast<int>(s.code));
  return 0;
}

/// In the search of a semismooth step: the first twelve evaluations are the start and the active-set steps.
PetscErrorCode error_in_semismooth_step() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(3, cyclic, -1, 0, PETSC_INFINITY, &s, &x, {.corner = true, .error_from = 13}));
  EXPECT(s.code == PETSC_ERR_USER, "error %d", static_cast<int>(s.code));
  return 0;
}

PetscErrorCode no_variables() {
  Solved s;
  PetscReal x = 0;
  PetscCall(solve_affine(
      0, [](PetscInt, PetscInt) { return 0.0; }, -1, 0, 1, &s, &x));
  EXPECT(s.code == 0 && s.reason > 0, "error %d, reason %d", static_cast<int>(s.code), static_cast<int>(s.reason));
  return 0;
}

/// Also on a rank that has no row to show it.
PetscErrorCode domain_error_without_rows() {
  for (int from : {1, 2}) {
    Solved s;
    PetscReal x = 5;
    PetscCall(solve_affine(2, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 1.0; }, -1, 0, 10, &s, &x,
                           {.outside_from = from}));
    EXPECT(s.code == 0, "error %d", static_cast<int>(s.code));
    EXPECT(s.reason == SNES_DIVERGED_FUNCTION_DOMAIN, "reason %d", static_cast<int>(s.reason));
  }
  return 0;
}

/// petsc4py's code for an exception is -1, which the largest of all ranks' codes once hid: the others waited.
PetscErrorCode error_of_python() {
  Solved s;
  PetscReal x = 5;
  PetscCall(solve_affine(7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.1; }, -1, 0, 10, &s, &x,
                         {.error_from = 2, .error = static_cast<PetscErrorCode>(-1)}));
  EXPECT(s.code != 0 && (s.code == -1) == on_last_rank(), "error %d", static_cast<int>(s.code));
  return 0;
}

/// A membrane that nothing holds at its edge, pulled up: it rises without end. Where x is so large that rounding hides
/// the load, the residual once counted as one of rounding alone.
PetscErrorCode unsolvable() {
  constexpr PetscInt n = 20;
  Solved s;
  PetscReal x = 0;
  const auto membrane = [](PetscInt i, PetscInt j) {
    const auto neighbours = [](PetscInt a, PetscInt b) {
      return std::abs(a / n - b / n) + std::abs(a % n - b % n) == 1;
    };
    PetscReal own = 0;
    for (PetscInt k : {i - n, i - 1, i + 1, i + n}) own += k >= 0 && k < n * n && neighbours(i, k) ? 1 : 0;
    return i == j ? own : neighbours(i, j) ? -1.0 : 0.0;
  };
  PetscCall(solve_affine(n * n, membrane, -0.5, 0, PETSC_INFINITY, &s, &x, {.uneven = true}));
  EXPECT(s.code == 0 && s.reason < 0, "error %d, reason %d, residual %g", static_cast<int>(s.code),
         static_cast<int>(s.reason), s.residual);
  return 0;
}

/// Pairs of rows with nothing on the diagonal, in the last rank's rows only: its ILU has no pivots, and the others once
/// waited for it in the KSP (PETSc keeps such a failure to the rank).
PetscErrorCode zero_pivot_on_one_rank() {
  Solved s;
  PetscReal x = 5;
  const auto pairs = [](PetscInt i, PetscInt j) {
    if (i < 40) return i == j ? 2.0 : 0.0;
    return j == (i ^ 1) ? (i < j ? 1.0 : -1.0) : 0.0;
  };
  PetscCall(solve_affine(60, pairs, -0.5, PETSC_NINFINITY, PETSC_INFINITY, &s, &x));
  EXPECT(s.code == 0, "error %d", static_cast<int>(s.code));
  EXPECT(s.reason < 0 || s.residual <= 1e-7, "reason %d, residual %g", static_cast<int>(s.reason), s.residual);
  return 0;
}

PetscErrorCode error_in_monitor() {
  Solved s;
  PetscReal x = 5;
  PetscCall(solve_affine(7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.1; }, -1, 0, 10, &s, &x,
                         {.error_in_monitor = 1}));
  EXPECT(s.code == PETSC_ERR_USER, "error %d", static_cast<int>(s.code));
  return 0;
}

/// A time limit, for example, that one rank alone has met.
PetscErrorCode test_on_one_rank() {
  Solved s;
  PetscReal x = 5;
  PetscCall(solve_affine(7, [](PetscInt i, PetscInt j) { return i == j ? 2.0 : 0.1; }, -1, 0, 10, &s, &x,
                         {.own_test = true}));
  EXPECT(s.code == 0 && s.reason == SNES_DIVERGED_MAX_IT, "error %d, reason %d", static_cast<int>(s.code),
         static_cast<int>(s.reason));
  return 0;
}

}  // namespace perp::petsc_tests
