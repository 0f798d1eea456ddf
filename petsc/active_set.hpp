// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One active-set step on the linearised problem, the same on the finest grid and on coarse ones:
///   1. rows with nothing but a diagonal entry are solved, and stay closed;
///   2. A symmetric: a projected Gauss-Seidel sweep, forth and back, finds most of what comes to a bound or leaves it;
///   3. the face: held is i at a bound that the sign of g_i = (A z + q)_i presses it to, or, where A is not symmetric,
///      i that z_i - g_i / a_ii lies beyond a bound of (the primal-dual active set; it is moved to that bound);
///   4. A_FF d_F = -g_F, inexactly, by the solver of the level;
///   5. the step P(z + d) - z: where A is symmetric phi decides how long it is, and never rises; else in full.
/// Reference: Hintermueller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865; Graeser & Kornhuber, J. Comput. Math. 27
/// (2009) 1.
#include "petsc/rows.hpp"

namespace perp::petsc {

/// Solves the equations on a face.
class FaceSolver {
 public:
  virtual ~FaceSolver() = default;
  /// d = A_FF^-1 b where mask is 1, 0 where it is 0, as b is. `changed`: of A or of the face since the last call.
  /// *failed: nothing came of it, and d does not count.
  virtual PetscErrorCode solve(Vec mask, bool changed, Vec b, Vec d, bool* failed) = 0;
  /// Nothing holds the face: phi falls along the last d as far as the box allows.
  bool unheld = false;

 protected:
  FaceSolver() = default;
  FaceSolver(const FaceSolver&) = default;
  FaceSolver& operator=(const FaceSolver&) = default;
};

/// What the steps on a level keep between each other.
struct Face {
  OwnVec open;    ///< 0 at lonely rows
  OwnVec lonely;  ///< 1 - open
  OwnVec mask;    ///< 1 in the face
  OwnVec b, d, step, image;
  PetscInt64 size = 0;     ///< of the face, on all ranks
  PetscInt64 changes = 0;  ///< variables that came to the face or left it in the last step
  bool fresh = true;       ///< A is new, or there was no face before

  PetscErrorCode create(Vec like);
};

/// Step 1 alone.
PetscErrorCode solve_lonely_rows(const BoxProblem& problem, Face& face);

/// Changes problem.z and problem.g. *failed: the face's equations were not solved; the rest of the step was made.
PetscErrorCode active_set_step(const BoxProblem& problem, Face& face, FaceSolver& solver, bool* failed);

}  // namespace perp::petsc
