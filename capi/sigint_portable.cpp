// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include "capi/sigint.hpp"

namespace perp::capi {

namespace {

// Signals belong to the process, and so does this.
std::atomic<std::atomic<bool>*> running{nullptr};
void (*before)(int) = SIG_DFL;

extern "C" void perp_interrupted(int signal) {
  static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free);
  if (std::atomic<bool>* stop = running.load()) *stop = true;
  std::signal(signal, perp_interrupted);  // C may have taken it back
  before(signal);
}

}  // namespace

StopOnInterrupt::StopOnInterrupt(std::atomic<bool>* stop) {
  if (stop == nullptr) return;
  outer_ = running.exchange(stop);
  set_ = true;
  if (outer_ != nullptr) return;
  const auto found = std::signal(SIGINT, SIG_IGN);
  installed_ = found != SIG_DFL && found != SIG_IGN && found != SIG_ERR;
  if (installed_) before = found;
  if (found != SIG_ERR) std::signal(SIGINT, installed_ ? perp_interrupted : found);
}

StopOnInterrupt::~StopOnInterrupt() {
  if (installed_) {
    // A callback may have set another one meanwhile: that one stays.
    const auto found = std::signal(SIGINT, before);
    if (found != perp_interrupted && found != SIG_ERR) std::signal(SIGINT, found);
  }
  if (set_) running = outer_;
}

}  // namespace perp::capi
