// SPDX-License-Identifier: Apache-2.0
#include "lcp/threads.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace perp::lcp {

void in_threads(Index count, int threads, const std::function<std::function<void(Index)>()>& make) {
  const Index wanted = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  // Up to 8 instances at a time, and no more than an eighth of a thread's, so that threads end together.
  const Index portion = std::clamp(count / (8 * wanted), Index{1}, Index{8});
  std::atomic<Index> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  std::mutex lock;
  const auto work = [&] {
    try {
      const std::function<void(Index)> one = make();
      for (Index k = next.fetch_add(portion); k < count && !failed; k = next.fetch_add(portion))
        for (Index i = k; i < std::min(k + portion, count); ++i) one(i);
    } catch (...) {
      const std::lock_guard hold(lock);
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  const Index most = std::min(wanted, (count + portion - 1) / portion);
  std::vector<std::thread> others;
  others.reserve(at(std::max(most, Index{1})));
  try {
    for (Index t = 1; t < most; ++t) others.emplace_back(work);
  } catch (const std::exception&) {  // the system has no more threads: those that run do the work
  }
  work();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace perp::lcp
