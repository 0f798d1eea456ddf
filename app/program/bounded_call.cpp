// SPDX-License-Identifier: Apache-2.0
#include "app/program/bounded_call.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "app/program/program.hpp"
#include "app/program/thread.hpp"
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

void watch(const std::atomic<bool>& interrupt) {
  const auto time = [](const std::atomic<Clock::rep>& count) {
    return Clock::time_point(Clock::duration(count.load()));
  };
  Clock::time_point asked = Clock::time_point::max();
  for (;; std::this_thread::sleep_for(look)) {
    const Clock::time_point now = Clock::now();
    if (interrupt) asked = std::min(asked, now);
    if (now < time(written_by)) continue;
    if (asked < now && now - asked > last_grace) leave("perp: interrupted\n", exit_unsolved);
    if (time(end_time) < now && now - time(end_time) > last_grace)
      leave("perp: the time limit was reached\n", exit_unsolved);
  }
}

}  // namespace

Patience patience(std::chrono::duration<double> limit, const std::atomic<bool>* interrupt) {
  return {.deadline = lcp::deadline_after(limit), .interrupt = interrupt};
}

std::optional<GivenUp> bounded_call(std::function<void()> work, const Patience& patience) {
  const auto call = std::make_shared<BoundedCall>();
  call->work = std::move(work);
  if (!start_thread([call] { call->run(); })) call->run();
  if (const auto given_up = wait(*call, patience)) {
    ++left_behind;
    return given_up;
  }
  if (call->thrown) std::rethrow_exception(call->thrown);
  return {};
}

bool calls_left_behind() { return left_behind > 0; }

Guard::Guard(const std::atomic<bool>& interrupt) {
  start_thread([&interrupt] { watch(interrupt); });  // no thread to be had: the commands look at the flag themselves
}

void end_by(Clock::time_point time) { end_time = time.time_since_epoch().count(); }

void writing_takes(std::chrono::duration<double> time) {
  written_by = (Clock::now() + std::chrono::duration_cast<Clock::duration>(time)).time_since_epoch().count();
}

}  // namespace perp::app
