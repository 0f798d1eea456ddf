// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Owners of PETSc's objects: destroyed with their scope, also where PetscCall leaves a function early.
#include <petscdm.h>
#include <petscksp.h>

#include <utility>

#if defined(PETSC_USE_COMPLEX) || !defined(PETSC_USE_REAL_DOUBLE)
#error "Complementarity is of real numbers, here doubles: build with a PETSc of those (Debian: petsc-real)"
#endif

namespace perp::petsc {

constexpr PetscErrorCode ok{};  ///< what a function returns that did not fail

template <class T, PetscErrorCode (*destroy)(T*)>
class Handle {
 public:
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() { reset(); }

  operator T() const { return object_; }  // NOLINT: PETSc's functions take it as it is
  /// Where a function that creates an object puts it; what was there before is destroyed.
  T* out() {
    reset();
    return &object_;
  }
  /// For functions that reuse what is there, MAT_REUSE_MATRIX.
  T* reuse() { return &object_; }
  void reset() {
    if (object_ != nullptr) destroy(&object_);
    object_ = nullptr;
  }

 private:
  T object_ = nullptr;
};

using OwnVec = Handle<Vec, VecDestroy>;
using OwnMat = Handle<Mat, MatDestroy>;
using OwnKsp = Handle<KSP, KSPDestroy>;
using OwnDm = Handle<DM, DMDestroy>;

/// The values of a vector that are on this rank.
class Values {
 public:
  explicit Values(Vec v) : v_(v) { VecGetArray(v_, &p_); }
  ~Values() { VecRestoreArray(v_, &p_); }
  Values(const Values&) = delete;
  Values& operator=(const Values&) = delete;
  PetscScalar& operator[](PetscInt i) { return p_[i]; }

 private:
  Vec v_;
  PetscScalar* p_ = nullptr;
};
class Reading {
 public:
  explicit Reading(Vec v) : v_(v) {
    VecGetLocalSize(v_, &n_);
    VecGetArrayRead(v_, &p_);
  }
  ~Reading() { VecRestoreArrayRead(v_, &p_); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  PetscScalar operator[](PetscInt i) const { return p_[i]; }
  PetscInt size() const { return n_; }

 private:
  Vec v_;
  PetscInt n_ = 0;
  const PetscScalar* p_ = nullptr;
};

}  // namespace perp::petsc
