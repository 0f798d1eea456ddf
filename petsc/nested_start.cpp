// SPDX-License-Identifier: Apache-2.0
#include "petsc/nested_start.hpp"

#include <vector>

namespace perp::petsc {
namespace {

constexpr int coarsest_steps = 60;
constexpr int steps = 8;
constexpr double loose = 0.03;  // the error on a face falls by this: the face may change yet

/// The problem on a coarse level, and what its equations are solved with.
struct Coarse : FaceSolver {
  OwnVec q, lower, upper, given, z, g;
  Face face;
  OwnKsp ksp;
  Multigrid* grids = nullptr;
  std::size_t level = 0;

  PetscErrorCode create(Multigrid& all, std::size_t k, bool symmetric);
  PetscErrorCode solve(Vec mask, bool changed, Vec b, Vec d, bool* failed) override;
  BoxProblem problem(bool symmetric) const {
    const Multigrid::Level& l = grids->levels()[level];
    return {.A = l.A, .diagonal = l.diagonal, .box = {lower, upper}, .z = z, .g = g, .symmetric = symmetric};
  }
};

PetscErrorCode Coarse::create(Multigrid& all, std::size_t k, bool symmetric) {
  grids = &all;
  level = k;
  Multigrid::Level& l = all.levels()[k];
  for (OwnVec* v : {&q, &lower, &upper, &given, &z, &g}) PetscCall(VecDuplicate(l.b, v->out()));
  PetscCall(face.create(l.b));
  PetscCall(VecCopy(l.open, face.open));
  PC pc = nullptr;
  PetscCall(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(static_cast<Vec>(l.b))), ksp.out()));
  PetscCall(KSPSetType(ksp, symmetric ? KSPCG : KSPGMRES));
  PetscCall(KSPSetTolerances(ksp, loose, PETSC_DEFAULT, PETSC_DEFAULT, 30));
  PetscCall(KSPGetPC(ksp, &pc));
  return all.become(pc);
}

PetscErrorCode Coarse::solve(Vec mask, bool changed, Vec b, Vec d, bool* failed) {
  if (changed) PetscCall(grids->take_face(level, mask));
  const Mat T = grids->levels()[level].T;
  PetscCall(KSPSetOperators(ksp, T, T));
  PetscCall(KSPSolve(ksp, b, d));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  *failed = reason < 0 && reason != KSP_DIVERGED_ITS;
  return ok;
}

/// z = P c where open, projected; what is closed keeps its values.
PetscErrorCode interpolate(const Multigrid::Level& fine, Vec c, Vec given, const Box& box, Vec z) {
  PetscCall(MatMult(fine.P, c, z));
  {
    const Reading open(fine.open);
    const Reading old(given);
    Values values(z);
    for (PetscInt i = 0; i < open.size(); ++i)
      if (open[i] == 0) values[i] = old[i];
  }
  return project(box, z);
}

PetscErrorCode solve_coarse(Coarse& c, bool symmetric, int limit) {
  const BoxProblem p = c.problem(symmetric);
  PetscCall(MatMult(p.A, p.z, p.g));
  PetscCall(VecAXPY(p.g, 1, c.q));
  for (int k = 0; k < limit; ++k) {
    bool failed = false;
    PetscCall(active_set_step(p, c.face, c, &failed));
    if (failed || (k > 0 && c.face.changes == 0)) break;
  }
  return ok;
}

/// Takes the step from p.z to z if it is worth it.
PetscErrorCode take_if_better(const BoxProblem& p, const Face& face, Vec z, bool* taken) {
  PetscCall(VecWAXPY(face.step, -1, p.z, z));
  PetscCall(MatMult(p.A, face.step, face.image));
  if (p.symmetric) {
    PetscScalar slope = 0;
    PetscScalar curvature = 0;
    PetscCall(VecDot(p.g, face.step, &slope));
    PetscCall(VecDot(face.image, face.step, &curvature));
    *taken = slope + curvature / 2 < 0;
  } else {
    Residual before;
    Residual after;
    PetscCall(natural_residual(p.box, p.z, p.g, &before));
    PetscCall(VecWAXPY(face.b, 1, p.g, face.image));
    PetscCall(natural_residual(p.box, z, face.b, &after));
    *taken = after.norm < before.norm;
  }
  if (!*taken) return ok;
  PetscCall(VecAXPY(p.g, 1, face.image));
  return VecCopy(z, p.z);
}

}  // namespace

PetscErrorCode nested_start(const BoxProblem& p, const Face& face, Multigrid& grids, bool* taken) {
  auto& levels = grids.levels();
  std::vector<Coarse> coarse(levels.size());
  OwnVec z;
  OwnVec q;
  PetscCall(VecDuplicate(p.z, z.out()));
  PetscCall(VecDuplicate(p.z, q.out()));
  PetscCall(MatMult(p.A, p.z, q));
  PetscCall(VecAYPX(q, -1, p.g));
  PetscCall(VecPointwiseMult(q, q, levels[0].open));
  for (std::size_t k = 1; k < levels.size(); ++k) {
    Coarse& c = coarse[k];
    PetscCall(c.create(grids, k, p.symmetric));
    const Mat inject = levels[k - 1].inject;
    PetscCall(MatMultTranspose(levels[k - 1].P, k == 1 ? q : coarse[k - 1].q, c.q));
    PetscCall(MatRestrict(inject, k == 1 ? p.box.lower : static_cast<Vec>(coarse[k - 1].lower), c.lower));
    PetscCall(MatRestrict(inject, k == 1 ? p.box.upper : static_cast<Vec>(coarse[k - 1].upper), c.upper));
    PetscCall(MatRestrict(inject, k == 1 ? p.z : static_cast<Vec>(coarse[k - 1].given), c.given));
  }
  PetscCall(VecCopy(coarse.back().given, coarse.back().z));
  for (std::size_t k = levels.size(); k-- > 1;) {
    Coarse& c = coarse[k];
    PetscCall(solve_coarse(c, p.symmetric, k + 1 == levels.size() ? coarsest_steps : steps));
    const bool last = k == 1;
    const Box box = last ? p.box : Box{coarse[k - 1].lower, coarse[k - 1].upper};
    PetscCall(interpolate(levels[k - 1], c.z, last ? p.z : static_cast<Vec>(coarse[k - 1].given), box,
                          last ? static_cast<Vec>(z) : static_cast<Vec>(coarse[k - 1].z)));
  }
  return take_if_better(p, face, z, taken);
}

PetscErrorCode nested_correction(const BoxProblem& p, const Face& face, Multigrid& grids, bool* taken) {
  OwnVec lower;
  OwnVec upper;
  OwnVec correction;
  for (OwnVec* v : {&lower, &upper, &correction}) PetscCall(VecDuplicate(p.z, v->out()));
  PetscCall(VecWAXPY(lower, -1, p.z, p.box.lower));
  PetscCall(VecWAXPY(upper, -1, p.z, p.box.upper));
  PetscCall(VecSet(correction, 0));
  BoxProblem shifted = p;
  shifted.box = {lower, upper};
  shifted.z = correction;
  PetscCall(nested_start(shifted, face, grids, taken));
  PetscCall(VecAXPY(p.z, 1, correction));
  return project(p.box, p.z);
}

}  // namespace perp::petsc
