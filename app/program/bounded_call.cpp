// SPDX-License-Identifier: Apache-2.0
#include "app/program/bounded_call.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "app/program/program.hpp"
#include "lcp/deadline.hpp"

namespace perp::app {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds look{20};  // at the flag, so often
/// From when the program was asked to end, in all.
constexpr milliseconds last_grace{900};

// Of the process, as its signals are: whoever waits for it to end knows nothing of commands.
std::atomic<int> left_behind{0};
std::atomic<Clock::rep> end_time{Clock::time_point::max().time_since_epoch().count()};
std::atomic<Clock::rep> written_by{Clock::time_point::min().time_since_epoch().count()};

struct BoundedCall {
  std::function<void()> work;
  std::exception_ptr thrown;
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;

  void run() {
    try {
      work();
    } catch (...) {
      thrown = std::current_exception();
    }
    work = nullptr;  // what it owns dies on the thread that used it
    const std::lock_guard lock(mutex);
    done = true;
    ended.notify_all();
  }
};

void* run_call(void* call) {
  const std::unique_ptr<std::shared_ptr<BoundedCall>> own(static_cast<std::shared_ptr<BoundedCall>*>(call));
  (*own)->run();
  return nullptr;
}

/// As deep as the first thread's: AMPL's expressions are evaluated by recursion.
std::size_t stack_size() {
  constexpr rlim_t usual = rlim_t{8} << 20;
  constexpr rlim_t most = rlim_t{256} << 20;
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0) return usual;
  return std::clamp(limit.rlim_cur, usual, most);
}

/// While it lives threads are made that take no signals: those are for the first thread, and for whoever waits for
/// them. But SIGABRT, which METIS sends itself where memory ends.
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

bool started(const std::shared_ptr<BoundedCall>& call) {
  const WithoutSignals silent;
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return false;
  pthread_attr_setstacksize(&attributes, stack_size());
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  auto own = std::make_unique<std::shared_ptr<BoundedCall>>(call);
  pthread_t thread{};
  const bool made = pthread_create(&thread, &attributes, run_call, own.get()) == 0;
  if (made) static_cast<void>(own.release());
  pthread_attr_destroy(&attributes);
  return made;
}

/// The first of: ended (nothing), too late, interrupted and then too late.
std::optional<GivenUp> wait(BoundedCall& call, const Patience& patience) {
  const auto add = [](Clock::time_point time, milliseconds more) {
    return time > Clock::time_point::max() - more ? Clock::time_point::max() : time + more;
  };
  Clock::time_point interrupted = Clock::time_point::max();
  std::unique_lock lock(call.mutex);
  for (;;) {
    const Clock::time_point now = Clock::now();
    if (patience.interrupt != nullptr && *patience.interrupt) interrupted = std::min(interrupted, now);
    if (call.done) return {};
    if (now >= add(interrupted, grace)) return GivenUp::Interrupted;
    if (now >= add(patience.deadline, grace)) return GivenUp::TimeLimit;
    call.ended.wait_for(lock, look);
  }
}

/// With write(2) alone: other threads may hold the streams.
[[noreturn]] void leave(std::string_view why) {
  while (!why.empty()) {
    const ssize_t done = write(STDERR_FILENO, why.data(), why.size());
    if (done <= 0) break;
    why.remove_prefix(static_cast<std::size_t>(done));
  }
  _exit(exit_unsolved);
}

void watch(const std::atomic<bool>& interrupt) {
  const auto time = [](const std::atomic<Clock::rep>& count) {
    return Clock::time_point(Clock::duration(count.load()));
  };
  Clock::time_point asked = Clock::time_point::max();
  for (;; std::this_thread::sleep_for(look)) {
    const Clock::time_point now = Clock::now();
    if (interrupt) asked = std::min(asked, now);
    if (now < time(written_by)) continue;
    if (asked < now && now - asked > last_grace) leave("perp: interrupted\n");
    if (time(end_time) < now && now - time(end_time) > last_grace) leave("perp: the time limit was reached\n");
  }
}

}  // namespace

Patience patience(std::chrono::duration<double> limit, const std::atomic<bool>* interrupt) {
  return {.deadline = lcp::deadline_after(limit), .interrupt = interrupt};
}

std::optional<GivenUp> bounded_call(std::function<void()> work, const Patience& patience) {
  const auto call = std::make_shared<BoundedCall>();
  call->work = std::move(work);
  if (!started(call)) call->run();
  if (const auto given_up = wait(*call, patience)) {
    ++left_behind;
    return given_up;
  }
  if (call->thrown) std::rethrow_exception(call->thrown);
  return {};
}

bool calls_left_behind() { return left_behind > 0; }

Guard::Guard(const std::atomic<bool>& interrupt) {
  const WithoutSignals silent;
  try {
    std::thread([&interrupt] { watch(interrupt); }).detach();
  } catch (const std::system_error&) {
    // No thread to be had: the commands look at the flag themselves.
  }
}

void end_by(Clock::time_point time) { end_time = time.time_since_epoch().count(); }

void writing_takes(std::chrono::duration<double> time) {
  written_by = (Clock::now() + std::chrono::duration_cast<Clock::duration>(time)).time_since_epoch().count();
}

}  // namespace perp::app
