// SPDX-License-Identifier: Apache-2.0
#pragma once
/// SIGINT and SIGTERM while a solve runs, on any rank.
#include <csignal>

#include "petsc/handle.hpp"

namespace perp::petsc {

/// While it lives, the first of the two signals is noted, and the handlers from before are back for the next one.
class InterruptWatch {
 public:
  explicit InterruptWatch(bool watch);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// The signal that any rank has had since this watch began, 0 if none has. Collective.
  PetscErrorCode signal(MPI_Comm comm, int* signal) const;

 private:
  bool watch_;
  struct sigaction old_int_ {};
  struct sigaction old_term_ {};
};

}  // namespace perp::petsc
