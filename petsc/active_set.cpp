// SPDX-License-Identifier: Apache-2.0
#include "petsc/active_set.hpp"

#include <algorithm>

namespace perp::petsc {
namespace {

/// z += t step, g += t A step; t = 1, or where phi is least along the step but at most 1. False: phi does not fall.
PetscErrorCode advance(const BoxProblem& p, Vec step, Vec image, bool* fell = nullptr) {
  PetscScalar slope = 0;
  PetscScalar curvature = 0;
  PetscScalar t = 1;
  PetscCall(MatMult(p.A, step, image));
  if (p.symmetric) {
    PetscCall(VecDotBegin(p.g, step, &slope));
    PetscCall(VecDotBegin(step, image, &curvature));
    PetscCall(VecDotEnd(p.g, step, &slope));
    PetscCall(VecDotEnd(step, image, &curvature));
    if (curvature > 0)
      t = std::min<PetscScalar>(1, std::max<PetscScalar>(0, -slope / curvature));
    else if (slope >= 0)
      t = 0;
  }
  if (fell != nullptr) *fell = t > 0;
  if (t == 0) return ok;
  PetscCall(VecAXPY(p.z, t, step));
  PetscCall(VecAXPY(p.g, t, image));
  return project(p.box, p.z);  // rounding of z + t step
}

/// The face at z, and the step of what is held to its bounds.
PetscErrorCode find_face(const BoxProblem& p, Face& face) {
  PetscInt64 count[2] = {0, 0};
  {
    const Reading z(p.z);
    const Reading g(p.g);
    const Reading l(p.box.lower);
    const Reading u(p.box.upper);
    const Reading d(p.diagonal);
    const Reading open(face.open);
    Values mask(face.mask);
    Values step(face.step);
    for (PetscInt i = 0; i < z.size(); ++i) {
      const PetscScalar reach = p.symmetric ? 0 : g[i] / (d[i] > 0 ? d[i] : 1);
      const bool below = p.symmetric ? z[i] <= l[i] && g[i] >= 0 : z[i] - reach <= l[i];
      const bool above = p.symmetric ? z[i] >= u[i] && g[i] <= 0 : z[i] - reach >= u[i];
      const bool free = open[i] != 0 && !below && !above && l[i] < u[i];
      step[i] = open[i] == 0 ? 0 : below ? l[i] - z[i] : above ? u[i] - z[i] : 0;
      count[0] += free ? 1 : 0;
      count[1] += free != (mask[i] != 0) ? 1 : 0;
      mask[i] = free ? 1 : 0;
    }
  }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT64, MPI_SUM, PetscObjectComm(reinterpret_cast<PetscObject>(p.z))));
  face.size = count[0];
  face.changes = count[1];
  return ok;
}

/// step = P(z + d) - z.
PetscErrorCode projected(const BoxProblem& p, Vec d, Vec step) {
  const Reading z(p.z);
  const Reading l(p.box.lower);
  const Reading u(p.box.upper);
  const Reading direction(d);
  Values s(step);
  for (PetscInt i = 0; i < z.size(); ++i) s[i] = std::min(std::max(z[i] + direction[i], l[i]), u[i]) - z[i];
  return ok;
}

/// step = t d with the largest t <= 1 that stays in the box.
PetscErrorCode shortened(const BoxProblem& p, Vec d, Vec step) {
  PetscReal t = 1;
  {
    const Reading z(p.z);
    const Reading l(p.box.lower);
    const Reading u(p.box.upper);
    const Reading direction(d);
    for (PetscInt i = 0; i < z.size(); ++i) {
      if (direction[i] < 0) t = std::min(t, (l[i] - z[i]) / direction[i]);
      if (direction[i] > 0) t = std::min(t, (u[i] - z[i]) / direction[i]);
    }
  }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &t, 1, MPIU_REAL, MPIU_MIN, PetscObjectComm(reinterpret_cast<PetscObject>(d))));
  PetscCall(VecCopy(d, step));
  return VecScale(step, t);
}

}  // namespace

PetscErrorCode Face::create(Vec like) {
  for (OwnVec* v : {&open, &lonely, &mask, &b, &d, &step, &image}) PetscCall(VecDuplicate(like, v->out()));
  PetscCall(VecSet(open, 1));
  PetscCall(VecSet(lonely, 0));
  return VecSet(mask, 1);
}

PetscErrorCode solve_lonely_rows(const BoxProblem& p, Face& face) {
  PetscCall(lonely_step(p, face.lonely, face.step));
  PetscCall(MatMult(p.A, face.step, face.image));
  PetscCall(VecAXPY(p.z, 1, face.step));
  return VecAXPY(p.g, 1, face.image);
}

PetscErrorCode active_set_step(const BoxProblem& p, Face& face, FaceSolver& solver, bool* failed) {
  *failed = false;
  PetscCall(solve_lonely_rows(p, face));
  if (p.symmetric) {
    PetscCall(sweep_step(p, face.open, face.step));
    PetscCall(advance(p, face.step, face.image));
  }
  PetscCall(find_face(p, face));
  if (!p.symmetric) PetscCall(advance(p, face.step, face.image));
  if (face.size == 0) return ok;
  PetscCall(VecPointwiseMult(face.b, face.mask, p.g));
  PetscCall(VecScale(face.b, -1));
  PetscCall(solver.solve(face.mask, face.fresh || face.changes > 0, face.b, face.d, failed));
  face.fresh = false;
  if (*failed) return ok;
  PetscCall(VecPointwiseMult(face.d, face.mask, face.d));  // a preconditioner may mix in rounding where b is 0
  if (!solver.unheld) {
    bool fell = true;
    PetscCall(projected(p, face.d, face.step));
    PetscCall(advance(p, face.step, face.image, &fell));
    if (fell) return ok;
  }
  PetscCall(shortened(p, face.d, face.step));
  return advance(p, face.step, face.image);
}

}  // namespace perp::petsc
