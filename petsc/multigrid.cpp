// SPDX-License-Identifier: Apache-2.0
#include "petsc/multigrid.hpp"

#include <petscdmda.h>

#include <algorithm>
#include <string>

namespace perp::petsc {
namespace {

constexpr PetscInt small = 1500;   ///< rows that need no coarser grid: every rank has them all, for LU
constexpr PetscInt direct = 5000;  ///< ... and the most for LU, where the grid cannot be made coarser and has one
                                   ///< unknown a point: algebraic multigrid is poor at several

constexpr PetscReal fill = 1;  ///< of PETSc's products: their patterns are kept, so that it matters once

/// Whether a grid of every other point would be one, and every rank would keep some.
PetscErrorCode can_be_coarsened(DM dm, bool* can) {
  PetscBool is_da = PETSC_FALSE;
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(dm), DMDA, &is_da));
  *can = false;
  if (!is_da) return ok;
  PetscInt dim = 0;
  PetscInt points[3];
  PetscInt ranks[3];
  PetscInt width = 0;
  DMBoundaryType boundary[3];
  DMDAInterpolationType interpolation = DMDA_Q1;
  PetscCall(DMDAGetInterpolationType(dm, &interpolation));
  PetscCall(DMDAGetInfo(dm, &dim, &points[0], &points[1], &points[2], &ranks[0], &ranks[1], &ranks[2], nullptr, &width,
                        &boundary[0], &boundary[1], &boundary[2], nullptr));
  *can = interpolation == DMDA_Q1;  // cells, with constants on them, have no injection
  for (PetscInt i = 0; i < dim; ++i) {
    const bool periodic = boundary[i] == DM_BOUNDARY_PERIODIC;
    const PetscInt coarse = periodic ? points[i] / 2 : (points[i] - 1) / 2 + 1;
    *can = *can && (points[i] - (periodic ? 0 : 1)) % 2 == 0 && coarse >= 3 &&
           coarse >= 2 * ranks[i] * std::max<PetscInt>(width, 1);
  }
  return ok;
}

/// Whether the coarse grid is that one: -da_refine_x and its like change what DMCoarsen does.
PetscErrorCode has_every_other_point(DM fine, DM coarse, bool* has) {
  PetscInt dim = 0;
  PetscInt points[2][3];
  DMBoundaryType boundary[3];
  for (int k = 0; k < 2; ++k) {
    auto& n = points[k];
    PetscCall(DMDAGetInfo(k == 0 ? fine : coarse, &dim, &n[0], &n[1], &n[2], nullptr, nullptr, nullptr, nullptr,
                          nullptr, &boundary[0], &boundary[1], &boundary[2], nullptr));
  }
  *has = true;
  for (PetscInt i = 0; i < dim; ++i) {
    const PetscInt ends = boundary[i] == DM_BOUNDARY_PERIODIC ? 0 : 1;
    *has = *has && points[0][i] - ends == 2 * (points[1][i] - ends);
  }
  return ok;
}

/// Interpolation of several unknowns a point is of a type that products do not truncate.
PetscErrorCode as_rows(OwnMat& P) {
  PetscBool rows = PETSC_FALSE;
  PetscCall(
      PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(static_cast<Mat>(P)), &rows, MATSEQAIJ, MATMPIAIJ, ""));
  if (rows) return ok;
  OwnMat converted;
  PetscCall(MatConvert(P, MATAIJ, MAT_INITIAL_MATRIX, converted.out()));
  P = std::move(converted);
  return ok;
}

/// 1 where a coarse function is not closed and the face has left something of it; r is overwritten.
PetscErrorCode take_mask(const Multigrid::Level& coarse) {
  PetscCall(MatGetDiagonal(coarse.T, coarse.r));
  const Reading d(coarse.diagonal);
  const Reading left(coarse.r);
  const Reading open(coarse.open);
  Values m(coarse.mask);
  for (PetscInt i = 0; i < d.size(); ++i)
    m[i] = open[i] != 0 && PetscAbsScalar(left[i]) > 1e-10 * PetscAbsScalar(d[i]) ? 1 : 0;
  return ok;
}

PetscErrorCode apply_grids(PC pc, Vec b, Vec x) {
  Multigrid* grids = nullptr;
  PetscCall(PCShellGetContext(pc, static_cast<void*>(&grids)));
  return grids->apply(b, x);
}

}  // namespace

PetscErrorCode set_algebraic_multigrid(PC pc) {
#if defined(PETSC_HAVE_HYPRE)
  PetscCall(PCSetType(pc, PCHYPRE));
  return PCHYPRESetType(pc, "boomeramg");
#else
  return PCSetType(pc, PCGAMG);
#endif
}

PetscErrorCode Multigrid::become(PC pc) {
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, this));
  PetscCall(PCShellSetApply(pc, apply_grids));
  return PCShellSetName(pc, "perp: truncated multigrid");
}

PetscErrorCode Multigrid::take_hierarchy(DM dm, bool* usable) {
  levels_.clear();
  coarsest_.reset();
  levels_.emplace_back();
  PetscCall(PetscObjectReference(reinterpret_cast<PetscObject>(dm)));
  *levels_[0].dm.out() = dm;
  PetscCall(DMCreateGlobalVector(dm, levels_[0].b.out()));
  for (;;) {
    bool can = false;
    PetscInt rows = 0;
    PetscCall(VecGetSize(levels_.back().b, &rows));
    PetscCall(can_be_coarsened(levels_.back().dm, &can));
    if (!can || (rows <= small && levels_.size() > 1)) break;
    Level coarse;
    Level& fine = levels_.back();
    PetscCall(DMCoarsen(fine.dm, PetscObjectComm(reinterpret_cast<PetscObject>(dm)), coarse.dm.out()));
    PetscCall(has_every_other_point(fine.dm, coarse.dm, &can));
    if (!can) break;
    PetscCall(DMCreateGlobalVector(coarse.dm, coarse.b.out()));
    PetscCall(DMCreateInterpolation(coarse.dm, fine.dm, fine.P.out(), nullptr));
    PetscCall(as_rows(fine.P));
    PetscCall(DMCreateInjection(coarse.dm, fine.dm, fine.inject.out()));
    levels_.push_back(std::move(coarse));
  }
  for (Level& level : levels_)
    for (OwnVec* v : {&level.mask, &level.diagonal, &level.open, &level.x, &level.r})
      PetscCall(VecDuplicate(level.b, v->out()));
  *usable = levels_.size() > 1;
  return ok;
}

PetscErrorCode Multigrid::take_matrix(Mat A, Vec open) {
  PetscCall(PetscObjectReference(reinterpret_cast<PetscObject>(A)));
  *levels_[0].A.out() = A;
  PetscCall(VecCopy(open, levels_[0].open));
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    Level& level = levels_[k];
    const bool again = level.T != nullptr;
    if (!again) PetscCall(MatDuplicate(level.A, MAT_COPY_VALUES, level.T.out()));
    PetscCall(MatGetDiagonal(level.A, level.diagonal));
    if (k + 1 == levels_.size()) break;
    PetscCall(MatPtAP(level.A, level.P, again ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX, fill, levels_[k + 1].A.reuse()));
    PetscCall(MatRestrict(level.inject, level.open, levels_[k + 1].open));
  }
  return ok;
}

PetscErrorCode Multigrid::take_face(std::size_t first, Vec mask) {
  first_ = first;
  Level& top = levels_[first];
  if (static_cast<Vec>(top.mask) != mask) PetscCall(VecCopy(mask, top.mask));
  PetscCall(MatCopy(top.A, top.T, SAME_NONZERO_PATTERN));
  for (std::size_t k = first; k < levels_.size(); ++k) {
    Level& fine = levels_[k];
    PetscCall(MatDiagonalScale(fine.T, fine.mask, fine.mask));
    if (k + 1 < levels_.size()) {
      Level& coarse = levels_[k + 1];
      PetscCall(MatPtAP(fine.T, fine.P, coarse.product ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX, fill,
                        coarse.product ? coarse.T.reuse() : coarse.T.out()));
      coarse.product = true;
      PetscCall(take_mask(coarse));
    }
    PetscCall(set_cut_off_diagonal(fine.T, fine.mask, fine.diagonal));
  }
  return take_coarsest();
}

PetscErrorCode Multigrid::take_coarsest() {
  const Mat T = levels_.back().T;
  if (coarsest_ == nullptr) PetscCall(make_coarsest());
  PetscCall(KSPSetOperators(coarsest_, T, T));
  return KSPSetUp(coarsest_);
}

/// A fixed linear map: LU, on every rank alike, or one V-cycle of algebraic multigrid.
PetscErrorCode Multigrid::make_coarsest() {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(static_cast<Mat>(levels_.back().T)));
  const char* prefix = nullptr;
  int ranks = 0;
  PetscInt rows = 0;
  PetscInt width = 0;
  PC pc = nullptr;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(VecGetSize(levels_.back().b, &rows));
  PetscCall(VecGetBlockSize(levels_.back().b, &width));
  PetscCall(DMGetOptionsPrefix(levels_[0].dm, &prefix));
  PetscCall(KSPCreate(comm, coarsest_.out()));
  PetscCall(KSPSetOptionsPrefix(coarsest_, (std::string(prefix == nullptr ? "" : prefix) + "perp_coarse_").c_str()));
  PetscCall(KSPSetType(coarsest_, KSPPREONLY));
  PetscCall(KSPGetPC(coarsest_, &pc));
  PetscCall(rows > direct && width == 1 ? set_algebraic_multigrid(pc) : PCSetType(pc, ranks == 1 ? PCLU : PCREDUNDANT));
  PetscCall(KSPSetErrorIfNotConverged(coarsest_, PETSC_FALSE));
  return KSPSetFromOptions(coarsest_);
}

PetscErrorCode Multigrid::apply(Vec b, Vec x) {
  if (first_ == 0) ++cycles;
  return cycle(first_, b, x);
}

PetscErrorCode Multigrid::cycle(std::size_t k, Vec b, Vec x) {
  if (k + 1 == levels_.size()) return KSPSolve(coarsest_, b, x);
  const Level& fine = levels_[k];
  Level& coarse = levels_[k + 1];
  constexpr auto down = static_cast<MatSORType>(SOR_LOCAL_FORWARD_SWEEP | SOR_ZERO_INITIAL_GUESS);
  PetscCall(MatSOR(fine.T, b, 1, down, 0, 1, 1, x));
  PetscCall(MatMult(fine.T, x, fine.r));
  PetscCall(VecAYPX(fine.r, -1, b));
  PetscCall(MatMultTranspose(fine.P, fine.r, coarse.b));
  PetscCall(VecPointwiseMult(coarse.b, coarse.b, coarse.mask));
  PetscCall(cycle(k + 1, coarse.b, coarse.x));
  PetscCall(MatMultAdd(fine.P, coarse.x, x, x));  // what this moves of what is held the sweep sets back
  return MatSOR(fine.T, b, 1, SOR_LOCAL_BACKWARD_SWEEP, 0, 1, 1, x);
}

}  // namespace perp::petsc
