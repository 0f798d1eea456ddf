// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ctrl-C while the library works: perp_solver_heed_sigint.
#include <atomic>

namespace perp::capi {

/// While it lives, SIGINT sets *stop, and then does what it did before: an interpreter's own handler only leaves a
/// note, which nobody reads while linear algebra runs. Nothing where `stop` is null, or where SIGINT is ignored or ends
/// the process. Solves within solves: the inner one is stopped.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(std::atomic<bool>* stop);
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  bool set_ = false;        // something that the destructor takes back
  bool installed_ = false;  // the handler, too
  std::atomic<bool>* outer_ = nullptr;
};

}  // namespace perp::capi
