// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <initializer_list>

#include "app/program/signals.hpp"

namespace perp::app {
namespace {

std::atomic<std::atomic<bool>*> flag{nullptr};  // what a handler may touch
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_signal(int signal) {
  const bool again = flag.load()->exchange(true);
  std::signal(signal, again ? SIG_DFL : on_signal);  // C may have taken it back
  if (again) std::raise(signal);
}

}  // namespace

void wait_for_signals(std::atomic<bool>& interrupted) {
  flag = &interrupted;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_signal);
}

void block_signals() {}  // C has no such thing

}  // namespace perp::app
