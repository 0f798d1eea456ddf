// SPDX-License-Identifier: Apache-2.0
#include "capi/sigint.hpp"

#include <csignal>

namespace perp::capi {

namespace {

// Signals belong to the process, and so does this.
std::atomic<std::atomic<bool>*> running{nullptr};
struct sigaction before {};

extern "C" void perp_interrupted(int signal, siginfo_t* info, void* context) {
  static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free);
  if (std::atomic<bool>* stop = running.load()) *stop = true;
  if ((before.sa_flags & SA_SIGINFO) != 0)
    before.sa_sigaction(signal, info, context);
  else
    before.sa_handler(signal);
}

}  // namespace

StopOnInterrupt::StopOnInterrupt(std::atomic<bool>* stop) {
  if (stop == nullptr) return;
  outer_ = running.exchange(stop);
  set_ = true;
  if (outer_ != nullptr) return;
  struct sigaction found {};
  if (sigaction(SIGINT, nullptr, &found) != 0) return;
  if ((found.sa_flags & SA_SIGINFO) == 0 && (found.sa_handler == SIG_DFL || found.sa_handler == SIG_IGN)) return;
  before = found;
  struct sigaction ours = found;
  ours.sa_flags |= SA_SIGINFO;
  ours.sa_sigaction = perp_interrupted;
  installed_ = sigaction(SIGINT, &ours, nullptr) == 0;
}

StopOnInterrupt::~StopOnInterrupt() {
  if (installed_) {
    struct sigaction found {};
    // A callback may have set another one meanwhile: that one stays.
    if (sigaction(SIGINT, nullptr, &found) == 0 && (found.sa_flags & SA_SIGINFO) != 0 &&
        found.sa_sigaction == perp_interrupted)
      sigaction(SIGINT, &before, nullptr);
  }
  if (set_) running = outer_;
}

}  // namespace perp::capi
