// SPDX-License-Identifier: Apache-2.0
#include "petsc/semismooth.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "lcp/fischer_burmeister.hpp"
#include "petsc/users_functions.hpp"

namespace perp::petsc {
namespace {

constexpr double sigma = 1e-4;
constexpr int backtracks = 40;

double as_infinite(double bound) { return std::abs(bound) < infinite ? bound : std::copysign(lcp::infinity, bound); }

/// Phi and, where wanted, the diagonals of its generalised Jacobian; theta is not finite where F is not.
PetscErrorCode evaluate(const Box& box, Vec x, Vec F, Vec phi, Vec a, Vec b, PetscReal* theta) {
  {
    const Reading l(box.lower);
    const Reading u(box.upper);
    const Reading at(x);
    const Reading value(F);
    Values rows(phi);
    Values da(a);
    Values db(b);
    const auto fb = [](double p, double q, double hp, double hq) { return lcp::fischer_burmeister(p, q, hp, hq); };
    for (PetscInt i = 0; i < at.size(); ++i) {
      const lcp::CValue row = lcp::box_row(fb, as_infinite(l[i]), as_infinite(u[i]), at[i], value[i], 1, 1);
      rows[i] = std::isfinite(value[i]) ? row.phi : std::numeric_limits<double>::quiet_NaN();
      da[i] = row.da;
      db[i] = row.db;
    }
  }
  PetscCall(VecNorm(phi, NORM_2, theta));
  *theta *= *theta / 2;
  return ok;
}

}  // namespace

PetscErrorCode Semismooth::create(SNES snes, Mat J, Vec like) {
  PetscObjectState pattern = 0;
  PetscCall(MatGetNonzeroState(J, &pattern));
  if (rows_ == nullptr || pattern != pattern_) PetscCall(MatDuplicate(J, MAT_COPY_VALUES, rows_.out()));
  pattern_ = pattern;
  if (ksp_ != nullptr) return ok;
  for (OwnVec* v : {&phi_, &a_, &b_, &gradient_, &d_, &trial_, &value_, &step_})
    PetscCall(VecDuplicate(like, v->out()));
  const char* prefix = nullptr;
  PetscCall(SNESGetOptionsPrefix(snes, &prefix));
  PetscCall(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(snes)), ksp_.out()));
  PetscCall(KSPSetOptionsPrefix(ksp_, (std::string(prefix == nullptr ? "" : prefix) + "snes_perp_fb_").c_str()));
  PetscCall(KSPSetTolerances(ksp_, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, 500));
  return KSPSetFromOptions(ksp_);
}

/// d of the Newton equations; found: they were solved and d descends.
PetscErrorCode Semismooth::newton_direction(Mat J, bool* found) {
  PetscCall(MatCopy(J, rows_, SAME_NONZERO_PATTERN));
  PetscCall(MatDiagonalScale(rows_, b_, nullptr));
  PetscCall(MatDiagonalSet(rows_, a_, ADD_VALUES));
  PetscCall(MatMultTranspose(rows_, phi_, gradient_));
  bool unbuilt = false;
  *found = false;
  PetscCall(KSPSetOperators(ksp_, rows_, rows_));
  PetscCall(set_up_solver(ksp_, &unbuilt));
  if (unbuilt) return ok;
  PetscCall(KSPSolve(ksp_, phi_, d_));
  PetscCall(VecScale(d_, -1));
  PetscReal length = 0;
  PetscScalar slope = 0;
  PetscCall(VecNorm(d_, NORM_2, &length));
  PetscCall(VecDot(gradient_, d_, &slope));
  *found = std::isfinite(length) && slope < -1e-12 * length * length;
  return ok;
}

/// The first of P(x + d), P(x + d / 2), ... with enough descent.
PetscErrorCode Semismooth::search(SNES snes, const Box& box, Vec x, Vec F, bool* moved) {
  *moved = false;
  PetscReal t = 1;
  for (int k = 0; k < backtracks && !*moved; ++k, t /= 2) {
    PetscReal theta = 0;
    PetscScalar slope = 0;
    PetscCall(VecWAXPY(trial_, t, d_, x));
    PetscCall(project(box, trial_));
    PetscCall(VecWAXPY(step_, -1, x, trial_));
    PetscCall(VecDot(gradient_, step_, &slope));
    if (slope >= 0) continue;
    PetscCall(compute_function(snes, trial_, value_));
    PetscCall(evaluate(box, trial_, value_, phi_, a_, b_, &theta));
    *moved = theta <= theta_ + sigma * slope;  // false where theta is not a number
  }
  if (!*moved) return ok;
  PetscCall(VecCopy(trial_, x));
  return VecCopy(value_, F);
}

PetscErrorCode Semismooth::step(SNES snes, const Box& box, Mat J, Vec x, Vec F, bool* moved) {
  bool newton = false;
  PetscCall(create(snes, J, x));
  PetscCall(evaluate(box, x, F, phi_, a_, b_, &theta_));
  PetscCall(newton_direction(J, &newton));
  *moved = false;
  if (newton) PetscCall(search(snes, box, x, F, moved));
  if (*moved) return ok;
  PetscCall(VecCopy(gradient_, d_));
  PetscCall(VecScale(d_, -1));
  return search(snes, box, x, F, moved);
}

}  // namespace perp::petsc
