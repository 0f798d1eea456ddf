// SPDX-License-Identifier: Apache-2.0
#include "petsc/solver.hpp"

#include <petsc/private/snesimpl.h>

#include <algorithm>
#include <cmath>

#include "petsc/nested_start.hpp"
#include "petsc/users_functions.hpp"

namespace perp::petsc {
namespace {

constexpr int halvings = 30;       ///< of a step to a point where F is not defined
constexpr double accurate = 1e-2;  ///< the model of F counts as right up to this share of the residual
constexpr double wrong = 0.5;      ///< ... and as wrong from this share on
constexpr int shortenings = 8;
constexpr PetscInt patience_of_steps = 10;  ///< without a new best point
constexpr double growth = 1e6;              ///< a residual so many times the best one is the end of patience
constexpr double hidden = 1e-4;  ///< rounding of more than this share of the load hides the problem: x is far too large
constexpr double eps = PETSC_MACHINE_EPSILON;

}  // namespace

PetscErrorCode Solver::solve(SNES snes) {
  snes_ = snes;
  PetscCall(start());
  for (PetscInt it = 0; snes->reason == SNES_CONVERGED_ITERATING; ++it) {
    bool stop = false;
    PetscCall(report(it));
    if (snes->reason != SNES_CONVERGED_ITERATING) break;
    if (it >= snes->max_its) {
      snes->reason = SNES_DIVERGED_MAX_IT;
      PetscCall(go_back());
      break;
    }
    PetscCall(linearise());
    if (snes->reason != SNES_CONVERGED_ITERATING) break;
    PetscCall(semismooth_ > 0 ? semismooth_step(&stop) : step(&stop));
    if (!stop) PetscCall(accept());
  }
  counts_.worst = residual_.worst;
  counts_.row = residual_.row;
  counts_.cycles = grids_.cycles;
  return ok;
}

/// The projected start, its F and residual.
PetscErrorCode Solver::start() {
  counts_ = {};
  grids_.cycles = 0;
  idle_ = semismooth_ = rounds_ = 0;
  moved_ = 0;
  stale_ = affine_ = true;
  indefinite_ = plain_ = unheld = false;
  x_ = snes_->vec_sol;
  F_ = snes_->vec_func;
  box_ = {snes_->xl, snes_->xu};
  snes_->reason = SNES_CONVERGED_ITERATING;
  snes_->numFailures = snes_->numLinearSolveFailures = 0;
  PetscCall(check_box(box_));
  PetscCall(project(box_, x_));
  if (best_x_ == nullptr)
    for (OwnVec* v : {&best_x_, &best_F_, &z_, &g_, &diagonal_}) PetscCall(VecDuplicate(x_, v->out()));
  if (face_.mask == nullptr) PetscCall(face_.create(x_));
  PetscCall(evaluate(x_, F_, &residual_));
  best_ = residual_;
  PetscCall(VecCopy(x_, best_x_));
  return VecCopy(F_, best_F_);
}

PetscErrorCode Solver::evaluate(Vec x, Vec F, Residual* residual) {
  PetscCall(compute_function(snes_, x, F));
  return natural_residual(box_, x, F, residual);
}

/// SNES's own bookkeeping of an iteration, and its test.
PetscErrorCode Solver::report(PetscInt it) {
  PetscReal length = 0;
  PetscCall(VecNorm(x_, NORM_2, &length));
  PetscCall(PetscObjectSAWsTakeAccess(reinterpret_cast<PetscObject>(snes_)));
  snes_->iter = it;
  snes_->norm = residual_.norm;
  snes_->xnorm = length;
  snes_->ynorm = moved_;
  PetscCall(PetscObjectSAWsGrantAccess(reinterpret_cast<PetscObject>(snes_)));
  counts_.worst = residual_.worst;
  counts_.row = residual_.row;
  counts_.cycles = grids_.cycles;
  if (!std::isfinite(residual_.norm)) {
    snes_->reason = snes_->domainerror == PETSC_TRUE ? SNES_DIVERGED_FUNCTION_DOMAIN : SNES_DIVERGED_FNORM_NAN;
    return ok;
  }
  PetscCall(SNESLogConvergenceHistory(snes_, residual_.norm, snes_->linear_its));
  PetscCall(monitor_and_test(snes_, it, length, moved_, residual_.norm, &snes_->reason));
  bool rounded = false;
  if (it > 0) PetscCall(stop_at_rounding(&rounded));
  // A short step proves nothing.
  if (snes_->reason == SNES_CONVERGED_SNORM_RELATIVE && snes_->ops->converged == SNESConvergedDefault && !rounded)
    snes_->reason = SNES_CONVERGED_ITERATING;
  if (snes_->reason == SNES_CONVERGED_ITERATING && rounded) snes_->reason = SNES_CONVERGED_SNORM_RELATIVE;
  if (snes_->reason < 0) PetscCall(go_back());
  return ok;
}

/// Whether the residual is what rounding leaves, and has stopped falling.
PetscErrorCode Solver::stop_at_rounding(bool* rounded) {
  *rounded = !stale_ && idle_ >= 1 && is_rounding(best_);
  if (*rounded) PetscCall(go_back());
  return ok;
}

bool Solver::is_rounding(const Residual& residual) const { return residual.norm <= noise_ && noise_ <= hidden * load_; }

PetscErrorCode Solver::go_back() {
  if (!(best_.norm < residual_.norm)) return ok;
  PetscCall(VecCopy(best_x_, x_));
  PetscCall(VecCopy(best_F_, F_));
  residual_ = best_;
  snes_->norm = best_.norm;
  return ok;
}

/// An active-set step from x, on the model g = F + J (z - x).
PetscErrorCode Solver::step(bool* stop) {
  const bool first = counts_.steps == 0;
  bool failed = false;
  ++counts_.steps;
  PetscCall(VecCopy(x_, z_));
  PetscCall(VecCopy(F_, g_));
  if (multigrid_ && face_.fresh) {
    bool taken = false;
    PetscCall(solve_lonely_rows(model(), face_));  // what coarse grids take as given: displacements of a boundary
    PetscCall(first ? nested_start(model(), face_, grids_, &taken) : nested_correction(model(), face_, grids_, &taken));
    PetscCall(PetscInfo(snes_, "point from the coarse grids %s\n", taken ? "taken" : "no better"));
  }
  const PetscInt before = snes_->numLinearSolveFailures;
  PetscCall(active_set_step(model(), face_, *this, &failed));
  counts_.face = face_.size;
  if (unheld) face_.fresh = true;  // now that something may hold it, the coarse grids know more
  PetscCall(PetscInfo(snes_, "%lld variables in the face, %lld came or went\n", static_cast<long long>(face_.size),
                      static_cast<long long>(face_.changes)));
  *stop = snes_->reason != SNES_CONVERGED_ITERATING;
  if (failed && !*stop && snes_->numLinearSolveFailures > before) semismooth_ = std::max<PetscInt>(semismooth_, 1);
  return ok;
}

/// F at the point z of the step; a shorter step where F is not defined there. Then what the model was worth.
PetscErrorCode Solver::accept() {
  Residual there;
  OwnVec& F = face_.b;  // the step is done with it
  PetscCall(evaluate(z_, F, &there));
  for (int k = 0; k < halvings && !std::isfinite(there.norm); ++k) {
    PetscCall(VecAXPBY(z_, 0.5, 0.5, x_));
    PetscCall(evaluate(z_, F, &there));
    stale_ = true;
  }
  PetscReal missed = 0;
  PetscCall(VecAXPY(g_, -1, F));
  PetscCall(VecNorm(g_, NORM_2, &missed));
  if (there.norm > residual_.norm && missed > wrong * there.norm) PetscCall(shorten(F, &there));
  if (!(missed <= accurate * there.norm || missed <= noise_)) {
    stale_ = true;
    affine_ = false;
  }
  PetscCall(VecAXPY(x_, -1, z_));
  PetscCall(VecNorm(x_, NORM_2, &moved_));
  PetscCall(VecCopy(z_, x_));
  PetscCall(VecCopy(F, F_));
  residual_ = there;
  if (residual_.norm < best_.norm) {
    idle_ = 0;
    best_ = residual_;
    PetscCall(VecCopy(x_, best_x_));
    return VecCopy(F_, best_F_);
  }
  // Every step on a symmetric affine problem lowers phi, whatever the residual does on the way.
  const PetscInt patience = affine_ && symmetric_ ? 10 * patience_of_steps : patience_of_steps;
  const bool stuck = moved_ == 0 && face_.changes == 0;  // rows of zeros, for example: every further step is the same
  if (++idle_ < patience && !stuck && residual_.norm <= growth * best_.norm) return ok;
  PetscCall(go_back());
  PetscCall(PetscInfo(snes_, "no better point in %" PetscInt_FMT " steps: semismooth steps\n", idle_));
  semismooth_ = 5 << std::min<PetscInt>(rounds_++, 6);
  idle_ = 0;
  stale_ = true;
  return ok;
}

/// The residual grew because the model is wrong at z: half of the step, a quarter, ..., if one of them lowers it. Steps
/// of a right model are not shortened: on the way of the active set to its place residuals may grow.
PetscErrorCode Solver::shorten(Vec F, Residual* there) {
  OwnVec& z = face_.step;
  OwnVec& value = face_.d;
  Residual now;
  PetscCall(VecCopy(z_, z));
  for (int k = 0; k < shortenings; ++k) {
    PetscCall(VecAXPBY(z, 0.5, 0.5, x_));
    PetscCall(evaluate(z, value, &now));
    if (!(now.norm < residual_.norm)) continue;
    *there = now;
    PetscCall(VecCopy(z, z_));
    return VecCopy(value, F);
  }
  return ok;
}

PetscErrorCode Solver::semismooth_step(bool* stop) {
  bool moved = false;
  *stop = true;
  ++counts_.semismooth;
  --semismooth_;
  PetscCall(VecCopy(x_, z_));
  PetscCall(semismooth_method_.step(snes_, box_, J_, x_, F_, &moved));
  stale_ = true;
  if (!moved) {
    snes_->reason = is_rounding(best_) ? SNES_CONVERGED_SNORM_RELATIVE : SNES_DIVERGED_LINE_SEARCH;
    return go_back();
  }
  PetscCall(VecAXPY(z_, -1, x_));
  PetscCall(VecNorm(z_, NORM_2, &moved_));
  PetscCall(natural_residual(box_, x_, F_, &residual_));
  face_.fresh = true;
  if (!(residual_.norm < best_.norm)) return ok;
  best_ = residual_;
  PetscCall(VecCopy(x_, best_x_));
  return VecCopy(F_, best_F_);
}

/// J at x, where the model has been wrong; its size tells what rounding leaves of the residual.
PetscErrorCode Solver::linearise() {
  if (!stale_) return ok;
  bool defined = false;
  PetscReal size_of_J = 0;
  PetscCall(compute_jacobian(snes_, x_, &defined));
  PetscCall(check_is_aij(snes_->jacobian_pre));
  PetscCall(MatNorm(snes_->jacobian_pre, NORM_FROBENIUS, &size_of_J));
  if (!defined || !std::isfinite(size_of_J)) {
    snes_->reason = SNES_DIVERGED_JACOBIAN_DOMAIN;
    return go_back();
  }
  ++counts_.jacobians;
  PetscCall(take_matrix(snes_->jacobian_pre));
  stale_ = false;
  OwnVec& size = face_.b;
  PetscReal terms = 0;
  PetscCall(VecPointwiseMult(size, diagonal_, x_));
  PetscCall(VecNorm(size, NORM_2, &terms));
  noise_ = 32 * eps * terms;
  if (counts_.jacobians > 1) return ok;
  PetscCall(MatMult(J_, x_, size));
  PetscCall(VecAYPX(size, -1, F_));
  PetscCall(VecNorm(size, NORM_2, &load_));
  load_ = std::max(load_, residual_.norm);
  return ok;
}

}  // namespace perp::petsc
