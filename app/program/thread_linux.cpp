// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <utility>

#include "app/program/thread.hpp"

namespace perp::app {
namespace {

void* run_work(void* work) {
  const std::unique_ptr<std::function<void()>> own(static_cast<std::function<void()>*>(work));
  (*own)();
  return nullptr;
}

std::size_t stack_size() {
  constexpr rlim_t usual = rlim_t{8} << 20;
  constexpr rlim_t most = rlim_t{256} << 20;
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0) return usual;
  return std::clamp(limit.rlim_cur, usual, most);
}

/// While it lives threads are made that take no signals but SIGABRT, which METIS sends itself where memory ends.
class WithoutSignals {
 public:
  WithoutSignals() {
    sigset_t others;
    sigfillset(&others);
    sigdelset(&others, SIGABRT);
    pthread_sigmask(SIG_SETMASK, &others, &before_);
  }
  ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

bool start_thread(std::function<void()> work) {
  const WithoutSignals silent;
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return false;
  pthread_attr_setstacksize(&attributes, stack_size());
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  auto own = std::make_unique<std::function<void()>>(std::move(work));
  pthread_t thread{};
  const bool made = pthread_create(&thread, &attributes, run_work, own.get()) == 0;
  if (made) static_cast<void>(own.release());
  pthread_attr_destroy(&attributes);
  return made;
}

/// Uses write(2) alone: other threads may hold the streams.
void leave(std::string_view why, int code) {
  while (!why.empty()) {
    const ssize_t done = write(STDERR_FILENO, why.data(), why.size());
    if (done <= 0) break;
    why.remove_prefix(static_cast<std::size_t>(done));
  }
  _exit(code);
}

}  // namespace perp::app
