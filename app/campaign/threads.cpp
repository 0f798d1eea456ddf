// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/threads.hpp"

#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace perp::app::compare {

void in_threads(std::size_t n, int threads, Stopper& stopper, const std::function<void(std::size_t, int)>& work,
                const std::function<void()>& look) {
  std::atomic<std::size_t> next{0};
  std::atomic<int> running{threads};
  std::exception_ptr failure;
  std::mutex mutex;
  std::vector<std::thread> all;
  all.reserve(static_cast<std::size_t>(threads));
  for (int t = 0; t < threads; ++t)
    all.emplace_back([&, t] {
      try {
        for (std::size_t k = next++; k < n && !stopper.flag()->load(); k = next++) work(k, t);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!failure) failure = std::current_exception();
        stopper.stop();
      }
      --running;
    });
  constexpr std::chrono::milliseconds pause{20};
  while (running > 0) {
    stopper.look();
    look();
    std::this_thread::sleep_for(pause);
  }
  for (std::thread& thread : all) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace perp::app::compare
