// SPDX-License-Identifier: Apache-2.0
#include "petsc/interrupt.hpp"

namespace perp::petsc {
namespace {

// A handler can reach nothing but globals.
volatile std::sig_atomic_t noted = 0;
struct sigaction before_int;
struct sigaction before_term;

void note(int signal) {
  noted = signal;
  sigaction(SIGINT, &before_int, nullptr);
  sigaction(SIGTERM, &before_term, nullptr);
}

}  // namespace

InterruptWatch::InterruptWatch(bool watch) : watch_(watch) {
  if (!watch_) return;
  noted = 0;
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, nullptr, &old_int_);
  sigaction(SIGTERM, nullptr, &old_term_);
  before_int = old_int_;
  before_term = old_term_;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

InterruptWatch::~InterruptWatch() {
  if (!watch_) return;
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
}

PetscErrorCode InterruptWatch::signal(MPI_Comm comm, int* signal) const {
  *signal = watch_ ? static_cast<int>(noted) : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, signal, 1, MPI_INT, MPI_MAX, comm));
  return ok;
}

}  // namespace perp::petsc
