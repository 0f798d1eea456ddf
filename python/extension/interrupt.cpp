// SPDX-License-Identifier: Apache-2.0
#include "extension/interrupt.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <stdexcept>
#include <vector>

namespace perp::python {

namespace {

// Signals belong to the process, and so does this.
unsigned long main_thread = 0;
std::atomic<std::atomic<bool>*> running{nullptr};
struct sigaction before {};

extern "C" void perp_python_interrupted(int signal, siginfo_t* info, void* context) {
  static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free);
  if (std::atomic<bool>* stop = running.load()) *stop = true;
  if ((before.sa_flags & SA_SIGINFO) != 0)
    before.sa_sigaction(signal, info, context);
  else
    before.sa_handler(signal);
}

}  // namespace

void remember_main_thread(unsigned long identifier) { main_thread = identifier; }
bool on_main_thread() { return PyThread_get_thread_ident() == main_thread; }

StopOnInterrupt::StopOnInterrupt(std::atomic<bool>* stop) {
  if (!on_main_thread()) return;
  outer_ = running.exchange(stop);
  set_ = true;
  if (outer_ != nullptr) return;
  struct sigaction found {};
  if (sigaction(SIGINT, nullptr, &found) != 0) return;
  if ((found.sa_flags & SA_SIGINFO) == 0 && (found.sa_handler == SIG_DFL || found.sa_handler == SIG_IGN)) return;
  before = found;
  struct sigaction ours = found;
  ours.sa_flags |= SA_SIGINFO;
  ours.sa_sigaction = perp_python_interrupted;
  installed_ = sigaction(SIGINT, &ours, nullptr) == 0;
}

StopOnInterrupt::~StopOnInterrupt() {
  if (installed_) {
    struct sigaction found {};
    // Somebody's F may have set another one meanwhile: that one stays.
    if (sigaction(SIGINT, nullptr, &found) == 0 && (found.sa_flags & SA_SIGINFO) != 0 &&
        found.sa_sigaction == perp_python_interrupted)
      sigaction(SIGINT, &before, nullptr);
  }
  if (set_) running = outer_;
}

namespace {

/// Of all threads.
struct Everything {
  std::mutex lock{};
  std::condition_variable ended{};
  std::vector<std::atomic<bool>*> running{};
  bool over = false;
};

Everything& everything() {
  static auto* all = new Everything;  // threads may outlive static objects
  return *all;
}

void stop_everything() {
  const pybind11::gil_scoped_release release;
  Everything& all = everything();
  std::unique_lock lock(all.lock);
  all.over = true;
  for (std::atomic<bool>* stop : all.running)
    if (stop != nullptr) *stop = true;
  all.ended.wait_for(lock, std::chrono::seconds(10), [&] { return all.running.empty(); });
}

}  // namespace

void stop_at_exit() { pybind11::module_::import("atexit").attr("register")(pybind11::cpp_function(&stop_everything)); }

Released::Running::Running(std::atomic<bool>* stop) : stop_(stop) {
  Everything& all = everything();
  const std::scoped_lock lock(all.lock);
  if (all.over) throw std::runtime_error("the interpreter is at its end");
  all.running.push_back(stop);
}

Released::Running::~Running() {
  Everything& all = everything();
  const std::scoped_lock lock(all.lock);
  all.running.erase(std::ranges::find(all.running, stop_));
  all.ended.notify_all();
}

}  // namespace perp::python
