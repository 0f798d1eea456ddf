// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Galerkin's products of truncated matrices, S = P' T P with T = m A m, on the rows of each rank, made again only
/// where the mask m has changed: a few rows, once the face has nearly settled.
///
/// A rank computes its own coarse rows, S_c = sum over i of P_ic T_i P, for which it has copies of the rows i of T that
/// other ranks own, and of the rows of P that all these rows need. Those of P are constant; those of T and the mask are
/// exchanged once a product. PETSc's MatPtAP makes the whole product each time, and in parallel costs more than half of
/// what it does on one rank.
#include <vector>

#include "petsc/rows.hpp"

namespace perp::petsc {

inline PetscErrorCode destroy_copies(Mat** matrix) { return MatDestroySubMatrices(1, matrix); }

class Galerkin {
 public:
  /// Once, for matrices with the pattern of T. Makes the coarse matrix, of zeros; `like` is a coarse vector.
  /// Collective, as are all functions here.
  PetscErrorCode set_up(Mat T, Mat P, Vec like, OwnMat& coarse);
  Mat restriction() const { return restriction_; }

  /// Nothing is truncated in T, and no row of a product is known.
  PetscErrorCode forget();
  /// Nothing is truncated in T; the product with that is known.
  PetscErrorCode untruncate();
  /// The mask (1 inside, 0 cut off) for T := m A m + (1 - m) d, where it has changed. A null: T has its coarse rows
  /// from the product before, of which `changed` says which are new.
  PetscErrorCode truncate(Mat A, Vec mask, Vec diagonal, Mat T, std::vector<char>& changed);
  /// The rows of the coarse matrix that `changed` rows of T bear on. Says which in `coarse_changed`.
  PetscErrorCode multiply(Mat T, const std::vector<char>& changed, Mat coarse, std::vector<char>& coarse_changed);

 private:
  struct Factors;
  PetscErrorCode find_halo(Mat T, Mat P, Vec fine);
  PetscErrorCode exchange_with(Vec fine);
  PetscErrorCode find_pattern(Mat T, Vec like, OwnMat& coarse);
  PetscErrorCode take_mask(Vec mask);
  PetscErrorCode take_far_rows(Mat T);
  bool moved_near(const Blocks& T, PetscInt i) const;
  bool concerns(const Blocks& R, PetscInt c, const std::vector<char>& changed) const;
  template <class Use>
  void each_term(const Factors& f, PetscInt c, bool zeros, Use use) const;

  /// Rows of a matrix that other ranks own, with global columns as PETSc gives them, and as the numbers used here.
  struct Copies {
    Handle<IS, ISDestroy> rows, columns;
    Handle<Mat*, destroy_copies> matrix;
    std::vector<PetscInt> column;

    Mat get() const { return matrix == nullptr ? nullptr : *matrix; }
    PetscErrorCode fetch(Mat A, const std::vector<PetscInt>& of);
    PetscErrorCode fetch_again(Mat A);
  };

  Mat P_ = nullptr;
  OwnMat restriction_;                      ///< P'
  PetscInt fine_ = 0;                       ///< rows of this rank; fine numbers from here on are places in halo_
  PetscInt coarse_ = 0;                     ///< likewise, and coarse numbers from here on places in far_coarse_
  std::vector<PetscInt> halo_;              ///< fine rows of other ranks that matter here, increasing
  std::vector<PetscInt> far_coarse_;        ///< coarse columns, likewise
  std::vector<PetscInt> far_column_;        ///< fine numbers of T's far columns
  std::vector<PetscInt> far_row_;           ///< fine numbers of P's far rows, in the order of the restriction's columns
  std::vector<PetscInt> far_interpolated_;  ///< coarse numbers of P's far columns
  std::vector<PetscInt> far_of_coarse_;     ///< coarse numbers of the coarse matrix's far columns
  Copies rows_of_T_, rows_of_P_;
  std::vector<PetscScalar> known_;  ///< what rows_of_T_ were in the product before
  std::vector<char> far_changed_;
  std::vector<char> mask_, moved_;  ///< by fine numbers
  bool anything_moved_ = false;
  bool all_ = true;  ///< the next product is to make all rows
  Handle<VecScatter, VecScatterDestroy> exchange_;
  OwnVec halo_mask_;
  std::vector<PetscScalar> sum_;  ///< by coarse numbers, 0 between rows
};

}  // namespace perp::petsc
