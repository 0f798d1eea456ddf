// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Truncated monotone multigrid (Kornhuber 1994) on the hierarchy of a DM: a V-cycle for the equations on a face of the
/// box, A_FF d_F = b_F. Coarse functions are truncated to the face: with m the face's indicator and P the
/// interpolation,
///     S_0 = m A m,    S_(k+1) = m_(k+1) P_k' S_k P_k m_(k+1),    T_k = S_k + (1 - m_k) diag(A_k),
/// so that no coarse correction moves a variable that is held. A Gauss-Seidel sweep of each rank's own rows with T_k
/// smooths, forth on the way down and back on the way up; the coarsest equations are solved.
/// Symmetric positive definite for such an A: a preconditioner of conjugate gradients.
///
/// Galerkin's products alone make the coarse matrices: nothing of the user's is called on coarse grids. No rank has
/// more than its part of any but a small coarsest level.
#include <vector>

#include "petsc/rows.hpp"

namespace perp::petsc {

/// BoomerAMG, or GAMG where PETSc has no hypre.
PetscErrorCode set_algebraic_multigrid(PC pc);

class Multigrid {
 public:
  struct Level {
    OwnDm dm;
    OwnMat A;              ///< Galerkin's product of the untruncated ones; level 0: the matrix given
    OwnMat T;              ///< truncated to the face
    OwnMat P;              ///< from the next coarser level to this one; none on the coarsest
    OwnMat inject;         ///< values at the points of the next coarser level
    bool product = false;  ///< T is a product of the finer T
    OwnVec mask;
    OwnVec diagonal;  ///< of A
    OwnVec open;      ///< 0 at the variables that are never part of a face: lonely rows
    OwnVec b, x, r;
  };

  /// The levels of the DM; false where it cannot be coarsened.
  PetscErrorCode take_hierarchy(DM dm, bool* usable);
  /// The matrices of all levels. `open` has 0 where the variable is never free.
  PetscErrorCode take_matrix(Mat A, Vec open);
  /// The solver of the coarsest grid, after it failed: PETSc's does not recover with another matrix.
  void renew_coarsest() { coarsest_.reset(); }
  /// Truncates the levels from `first` on to the face mask (1 inside, 0 held) of `first`.
  PetscErrorCode take_face(std::size_t first, Vec mask);
  /// x = the V-cycle's answer to b, both on the level of the last take_face.
  PetscErrorCode apply(Vec b, Vec x);

  /// Makes the PC this V-cycle; it must not outlive this object.
  PetscErrorCode become(PC pc);

  std::vector<Level>& levels() { return levels_; }
  const std::vector<Level>& levels() const { return levels_; }
  PetscInt cycles = 0;  ///< V-cycles that began on level 0

 private:
  PetscErrorCode cycle(std::size_t k, Vec b, Vec x);
  PetscErrorCode take_coarsest();
  PetscErrorCode make_coarsest();

  std::vector<Level> levels_;
  OwnKsp coarsest_;
  std::size_t first_ = 0;
};

}  // namespace perp::petsc
