// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The entries of a matrix of type aij that are on this rank, in place.
#include "petsc/handle.hpp"

namespace perp::petsc {

/// Compressed rows; none of them, of any row, where there is no matrix.
struct Entries {
  PetscInt rows = 0;
  const PetscInt* start = nullptr;
  const PetscInt* column = nullptr;
  PetscScalar* value = nullptr;  ///< to be changed only if opened for that

  PetscInt begin(PetscInt i) const { return start == nullptr ? 0 : start[i]; }
  PetscInt end(PetscInt i) const { return start == nullptr ? 0 : start[i + 1]; }
  PetscInt count() const { return start == nullptr ? 0 : start[rows]; }
};

/// The rows of this rank: `own` in this rank's columns, numbered from 0, `far` in those of other ranks, numbered as in
/// `ghosts`, which are increasing. PETSc's rows are increasing, too.
class Blocks {
 public:
  enum class For { Reading, Writing };

  Blocks() = default;
  ~Blocks() { close(); }
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  PetscErrorCode open(Mat A, For use);
  PetscErrorCode close();

  Entries own, far;
  const PetscInt* ghosts = nullptr;
  PetscInt ghost_count = 0;

 private:
  PetscErrorCode take(Mat block, Entries& entries) const;
  PetscErrorCode give_back(Mat block, Entries& entries) const;

  Mat A_ = nullptr;
  Mat blocks_[2] = {nullptr, nullptr};
  bool writing_ = false;
};

}  // namespace perp::petsc
