// SPDX-License-Identifier: Apache-2.0
/// What users give by mistake, or that is hardly a problem: each ends with a reason, or with an error, on every rank.
#include <petscsnes.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "petsc/cases.hpp"

namespace perp::petsc_tests {
namespace {

constexpr PetscReal inf = std::numeric_limits<double>::infinity();
constexpr PetscReal nan = std::numeric_limits<double>::quiet_NaN();

/// F = d x + e (neighbours' sum) + q, between lower and upper, of n rows.
struct Chain {
  const char* name;
  PetscInt n;
  PetscReal diagonal, beside;
  std::function<PetscReal(PetscInt)> q, lower, upper;
  PetscReal start = 0;
};

struct Made {
  Mat M = nullptr;
  Vec q = nullptr, lower = nullptr, upper = nullptr, x = nullptr, F = nullptr;
  SNES snes = nullptr;
};

PetscErrorCode function(SNES, Vec x, Vec F, void* data) {
  const auto& made = *static_cast<Made*>(data);
  return MatMultAdd(made.M, x, made.q, F);
}
PetscErrorCode jacobian(SNES, Vec, Mat, Mat, void*) { return 0; }

PetscErrorCode fill(Vec v, const std::function<PetscReal(PetscInt)>& value) {
  PetscInt begin = 0;
  PetscInt end = 0;
  PetscCall(VecGetOwnershipRange(v, &begin, &end));
  for (PetscInt i = begin; i < end; ++i) PetscCall(VecSetValue(v, i, value(i), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(v));
  return VecAssemblyEnd(v);
}

PetscErrorCode make(const Chain& c, Made* made) {
  PetscInt begin = 0;
  PetscInt end = 0;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, c.n, c.n, 3, nullptr, 3, nullptr, &made->M));
  PetscCall(MatGetOwnershipRange(made->M, &begin, &end));
  for (PetscInt i = begin; i < end; ++i)
    for (PetscInt j = std::max<PetscInt>(0, i - 1); j <= std::min(i + 1, c.n - 1); ++j)
      PetscCall(MatSetValue(made->M, i, j, i == j ? c.diagonal : c.beside, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(made->M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(made->M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreateVecs(made->M, &made->x, &made->F));
  for (Vec* v : {&made->q, &made->lower, &made->upper}) PetscCall(VecDuplicate(made->x, v));
  PetscCall(fill(made->q, c.q));
  PetscCall(fill(made->lower, c.lower));
  PetscCall(fill(made->upper, c.upper));
  PetscCall(VecSet(made->x, c.start));
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &made->snes));
  PetscCall(SNESSetFunction(made->snes, made->F, function, made));
  PetscCall(SNESSetJacobian(made->snes, made->M, made->M, jacobian, nullptr));
  return SNESVISetVariableBounds(made->snes, made->lower, made->upper);
}

PetscErrorCode destroy(Made* made) {
  PetscCall(SNESDestroy(&made->snes));
  for (Vec* v : {&made->x, &made->F, &made->q, &made->lower, &made->upper}) PetscCall(VecDestroy(v));
  return MatDestroy(&made->M);
}

std::function<PetscReal(PetscInt)> all(PetscReal value) {
  return [value](PetscInt) { return value; };
}

PetscErrorCode solve(const Chain& c, Solved* s) {
  Made made;
  *s = {};
  PetscCall(make(c, &made));
  PetscCall(SNESSetTolerances(made.snes, 1e-10, 0, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(SNESSetFromOptions(made.snes));
  s->code = SNESSolve(made.snes, nullptr, made.x);
  if (s->code == 0) PetscCall(judge(made.snes, made.x, made.lower, made.upper, s));
  return destroy(&made);
}

PetscErrorCode expect_solved(const Chain& c) {
  Solved s;
  PetscCall(solve(c, &s));
  EXPECT(s.code == 0 && s.reason > 0 && s.residual <= 1e-9, "%s: error %d, reason %d, residual %g", c.name,
         static_cast<int>(s.code), static_cast<int>(s.reason), s.residual);
  return 0;
}

}  // namespace

/// One row, nothing to choose, no bounds, half of the variables fixed; no Jacobian to speak of.
PetscErrorCode hardly_a_problem() {
  const auto odd = [](PetscReal value, PetscReal other) {
    return [=](PetscInt i) { return i % 2 == 1 ? value : other; };
  };
  for (const Chain& c :
       {Chain{.name = "one row", .n = 1, .diagonal = 2, .beside = -1, .q = all(-1), .lower = all(0), .upper = all(9)},
        Chain{.name = "one row at its bound",
        .n = 1,
        .diagonal = 2,
        .beside = -1,
        .q = all(1),
        .lower = all(0),
        .upper = all(9)},
        Chain{.name = "one fixed row",
        .n = 1,
        .diagonal = 2,
        .beside = -1,
        .q = all(-1),
        .lower = all(3),
        .upper = all(3)},
        Chain{.name = "one free row",
        .n = 1,
        .diagonal = 2,
        .beside = -1,
        .q = all(-1),
        .lower = all(-inf),
        .upper = all(inf)},
        Chain{
            .name = "all fixed", .n = 50, .diagonal = 2, .beside = -1, .q = all(-1), .lower = all(3), .upper = all(3)},
        Chain{.name = "half fixed",
        .n = 50,
        .diagonal = 2,
        .beside = -1,
        .q = all(-1),
        .lower = odd(3, 0),
        .upper = odd(3, 9)},
        Chain{.name = "no bounds",
        .n = 50,
        .diagonal = 2,
        .beside = -1,
        .q = all(-1),
        .lower = all(-1e20),
        .upper = all(1e20)},
        Chain{
            .name = "indefinite", .n = 50, .diagonal = 1, .beside = -1, .q = all(-1), .lower = all(0), .upper = all(9)},
        Chain{.name = "no matrix",
        .n = 50,
        .diagonal = 0,
        .beside = 0,
        .q = odd(-1, 1),
        .lower = all(0),
        .upper = all(9)}})
    PetscCall(expect_solved(c));
  return 0;
}

/// Numbers that are none, on every row or on the last alone: F has no value at the start; or the bounds are refused.
PetscErrorCode no_numbers() {
  constexpr PetscInt n = 7;
  const auto last = [](PetscReal value, PetscReal other) {
    return [=](PetscInt i) { return i == n - 1 ? value : other; };
  };
  for (PetscReal bad : {nan, inf, -inf}) {
    Solved s;
    PetscCall(solve(
        {.name = "q", .n = n, .diagonal = 2, .beside = -1, .q = last(bad, -1), .lower = all(0), .upper = all(9)}, &s));
    EXPECT(s.code == 0 && s.reason == SNES_DIVERGED_FNORM_NAN, "q %g: error %d, reason %d", bad,
           static_cast<int>(s.code), static_cast<int>(s.reason));
  }
  for (auto [lower, upper] : {std::pair{nan, 1.0}, {0.0, nan}, {inf, inf}, {-inf, -inf}, {1.0, 0.0}}) {
    Solved s;
    PetscCall(solve({.name = "bounds",
                     .n = n,
                     .diagonal = 2,
                     .beside = -1,
                     .q = all(-1),
                     .lower = last(lower, 0),
                     .upper = last(upper, 9)},
                    &s));
    EXPECT(s.code == PETSC_ERR_ARG_OUTOFRANGE, "bounds %g, %g: error %d", lower, upper, static_cast<int>(s.code));
  }
  Solved s;
  PetscCall(solve({.name = "start",
                   .n = n,
                   .diagonal = 2,
                   .beside = -1,
                   .q = all(-1),
                   .lower = all(0),
                   .upper = all(9),
                   .start = nan},
                  &s));
  EXPECT(s.code == 0 && s.reason == SNES_DIVERGED_FNORM_NAN, "start: error %d, reason %d", static_cast<int>(s.code),
         static_cast<int>(s.reason));
  return 0;
}

/// An error, on every rank.
PetscErrorCode refused_options() {
  const Chain chain{
      .name = "options", .n = 50, .diagonal = 2, .beside = -1, .q = all(-1), .lower = all(0), .upper = all(9)};
  for (auto [key, value] :
       {std::pair{"-snes_perp_multigrid", "perhaps"}, {"-pc_type", "nonsense"}, {"-ksp_type", "nonsense"}}) {
    Made made;
    PetscCall(make(chain, &made));
    PetscCall(PetscOptionsSetValue(nullptr, key, value));
    PetscErrorCode code = SNESSetFromOptions(made.snes);
    if (code == 0) code = SNESSolve(made.snes, nullptr, made.x);
    PetscCall(PetscOptionsClearValue(nullptr, key));
    EXPECT(code != 0, "%s %s is taken", key, value);
    PetscCall(destroy(&made));
  }
  return 0;
}

}  // namespace perp::petsc_tests
