// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The cells of a comparison, in several threads.
#include <atomic>
#include <functional>

namespace perp::app::compare {

/// A signal, or a failure in one of the threads, ends all of them.
class Stopper {
 public:
  explicit Stopper(const std::atomic<bool>* interrupt) : interrupt_(interrupt) {}
  bool look() {
    if (interrupt_ != nullptr && interrupt_->load()) stop_ = true;
    return stop_;
  }
  void stop() { stop_ = true; }
  const std::atomic<bool>* flag() const { return &stop_; }

 private:
  const std::atomic<bool>* interrupt_;
  std::atomic<bool> stop_{false};
};

/// Calls work(k, thread) for k = 0, ..., n - 1 on so many threads, in that order, and meanwhile look() in this one.
/// Rethrows the first exception, after all threads have ended.
void in_threads(
    std::size_t n, int threads, Stopper& stopper, const std::function<void(std::size_t, int)>& work,
    const std::function<void()>& look = [] {});

}  // namespace perp::app::compare
