// SPDX-License-Identifier: Apache-2.0
#include "petsc/blocks.hpp"

#include <petsc/private/petscimpl.h>

namespace perp::petsc {

PetscErrorCode Blocks::take(Mat block, Entries& entries) const {
  if (block == nullptr) return ok;
  PetscBool done = PETSC_FALSE;
  PetscCall(MatGetRowIJ(block, 0, PETSC_FALSE, PETSC_FALSE, &entries.rows, &entries.start, &entries.column, &done));
  PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "perp: the rows of this type of matrix cannot be read");
  if (writing_) return MatSeqAIJGetArray(block, &entries.value);
  const PetscScalar* value = nullptr;
  PetscCall(MatSeqAIJGetArrayRead(block, &value));
  entries.value = const_cast<PetscScalar*>(value);  // NOLINT: nobody writes there
  return ok;
}

PetscErrorCode Blocks::give_back(Mat block, Entries& entries) const {
  if (block == nullptr || entries.start == nullptr) return ok;
  PetscBool done = PETSC_FALSE;
  const PetscScalar* value = entries.value;
  PetscCall(writing_ ? MatSeqAIJRestoreArray(block, &entries.value) : MatSeqAIJRestoreArrayRead(block, &value));
  PetscCall(MatRestoreRowIJ(block, 0, PETSC_FALSE, PETSC_FALSE, &entries.rows, &entries.start, &entries.column, &done));
  entries = {};
  return ok;
}

PetscErrorCode Blocks::open(Mat A, For use) {
  PetscBool parallel = PETSC_FALSE;
  PetscCall(close());
  PetscCall(PetscObjectBaseTypeCompare(reinterpret_cast<PetscObject>(A), MATMPIAIJ, &parallel));
  A_ = A;
  writing_ = use == For::Writing;
  blocks_[0] = A;
  blocks_[1] = nullptr;
  if (parallel) {
    PetscCall(MatMPIAIJGetSeqAIJ(A, &blocks_[0], &blocks_[1], &ghosts));
    PetscCall(MatGetSize(blocks_[1], nullptr, &ghost_count));
  }
  PetscCall(take(blocks_[0], own));
  return take(blocks_[1], far);
}

PetscErrorCode Blocks::close() {
  if (A_ == nullptr) return ok;
  PetscCall(give_back(blocks_[0], own));
  PetscCall(give_back(blocks_[1], far));
  if (writing_) PetscCall(PetscObjectStateIncrease(reinterpret_cast<PetscObject>(A_)));
  A_ = nullptr;
  ghosts = nullptr;
  ghost_count = 0;
  return ok;
}

}  // namespace perp::petsc
