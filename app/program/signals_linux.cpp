// SPDX-License-Identifier: Apache-2.0
#include "app/program/signals.hpp"

#include <pthread.h>

#include <csignal>
#include <system_error>
#include <thread>

namespace perp::app {
namespace {

std::atomic<std::atomic<bool>*> flag{nullptr};  // what a handler may touch
static_assert(std::atomic<bool>::is_always_lock_free);

sigset_t both() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&set, signal);
  return set;
}

extern "C" void on_signal(int signal) {
  if (!flag.load()->exchange(true)) return;
  std::signal(signal, SIG_DFL);
  const sigset_t set = both();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  std::raise(signal);
}

}  // namespace

void wait_for_signals(std::atomic<bool>& interrupted) {
  flag = &interrupted;
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // the thread's: other signals are not for it
  const sigset_t set = both();
  int how = SIG_BLOCK;
  try {
    std::thread([set] {
      for (int signal = 0; sigwait(&set, &signal) == 0;) on_signal(signal);
    }).detach();
  } catch (const std::system_error&) {  // no thread to be had: they are handled after all
    how = SIG_UNBLOCK;
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_sigmask(how, &set, nullptr);
}

void block_signals() {
  const sigset_t set = both();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

}  // namespace perp::app
