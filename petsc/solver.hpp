// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a SNES of type perp keeps between setup and reset: the loop, and its parts.
#include "petsc/active_set.hpp"
#include "petsc/multigrid.hpp"
#include "petsc/semismooth.hpp"
#include "petsc/snes_perp.hpp"

namespace perp::petsc {

class Solver : FaceSolver {
 public:
  explicit Solver(bool multigrid) : wants_multigrid_(multigrid) {}
  PetscErrorCode set_up(SNES snes);
  /// Gives the SNES its KSP back as set_up found it.
  PetscErrorCode release();
  PetscErrorCode solve(SNES snes);
  const Counts& counts() const { return counts_; }
  bool uses_multigrid() const { return multigrid_; }
  std::size_t levels() const { return grids_.levels().size(); }

 private:
  PetscErrorCode start();
  PetscErrorCode evaluate(Vec x, Vec F, Residual* residual);
  PetscErrorCode report(PetscInt it);
  PetscErrorCode stop_at_rounding(bool* rounded);
  bool is_rounding(const Residual& residual) const;
  PetscErrorCode linearise();
  PetscErrorCode take_matrix(Mat J);
  PetscErrorCode choose_linear_solver();
  PetscErrorCode take_krylov_method();
  PetscErrorCode step(bool* stop);
  PetscErrorCode accept();
  PetscErrorCode shorten(Vec F, Residual* there);
  PetscErrorCode go_back();
  PetscErrorCode semismooth_step(bool* stop);
  PetscErrorCode solve(Vec mask, bool changed, Vec b, Vec d, bool* failed) override;
  PetscErrorCode face_tolerance(Vec b, bool changed);
  PetscErrorCode take_face(Mat J, Vec mask);
  PetscErrorCode shift_face();
  PetscErrorCode unshift();
  PetscErrorCode give_up_on_linear_solver(KSPConvergedReason why, bool* retry);
  BoxProblem model() const {
    return {.A = J_, .diagonal = diagonal_, .box = box_, .z = z_, .g = g_, .symmetric = symmetric_};
  }

  const bool wants_multigrid_;
  SNES snes_ = nullptr;
  Box box_{};
  Counts counts_{};

  // The point and its judgement; F_(x) is in snes_->vec_func.
  Vec x_ = nullptr, F_ = nullptr;
  Residual residual_{};
  OwnVec best_x_, best_F_;
  Residual best_{};
  PetscInt idle_ = 0;        ///< steps since the best point
  PetscInt semismooth_ = 0;  ///< semismooth steps still to make
  PetscInt rounds_ = 0;      ///< returns to the best point
  PetscReal moved_ = 0;      ///< length of the last step
  PetscReal noise_ = 0;      ///< what rounding leaves of the natural residual, about
  PetscReal load_ = 0;       ///< F - J x at the start, or the natural residual there if that is larger

  // The linear model at the point where J was computed.
  Mat J_ = nullptr;
  OwnMat T_;  ///< J cut off, where there is no multigrid
  PetscObjectState pattern_ = -1;
  OwnVec diagonal_, z_, g_;
  Face face_;
  bool stale_ = true;
  bool symmetric_ = false;
  bool affine_ = true;       ///< J has been computed once, and its model has always been right
  bool indefinite_ = false;  ///< conjugate gradients met negative curvature: take J as unsymmetric

  Multigrid grids_;
  bool multigrid_ = false;
  int shifts_ = 0;           ///< of the faces of this J
  bool chosen_pc_ = false;   ///< the PC is this solver's own choice
  bool took_mg_ = false;     ///< the PC was "mg", whose place the truncated multigrid takes
  bool chosen_ksp_ = false;  ///< so is the type of the KSP
  bool chosen_rtol_ = false;
  bool chosen_limit_ = false;
  bool plain_ = false;  ///< AMG has failed: ILU
  Semismooth semismooth_method_;
};

}  // namespace perp::petsc
