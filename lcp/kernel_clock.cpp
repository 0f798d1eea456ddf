// SPDX-License-Identifier: Apache-2.0
#include "lcp/kernel_clock.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "lcp/memory.hpp"

namespace perp::lcp {
namespace {

using Clock = std::chrono::steady_clock;

/// Calls that take no longer are always begun.
constexpr double short_call = 0.01;
/// No processor does more.
constexpr double fastest = 1e11;

std::string sentence(Index rows, double seconds, double left) {
  std::ostringstream text;
  text.precision(2);
  text << "a factorization of " << rows << " rows takes about " << seconds << " s, " << left << " s are left";
  return text.str();
}

/// Of a dense factorization: what a sparse one may come to with a good BLAS.
double rate_of_machine() {
  constexpr Index n = 160;
  ::Eigen::MatrixXd A = ::Eigen::MatrixXd::Ones(n, n);
  A.diagonal().array() += static_cast<double>(n);
  const auto begin = Clock::now();
  const ::Eigen::PartialPivLU<::Eigen::MatrixXd> lu(A);
  const std::chrono::duration<double> time = Clock::now() - begin;
  const double flops = 2.0 / 3 * static_cast<double>(n * n * n) * std::abs(lu.matrixLU()(0, 0)) / (n + 1.0);
  return flops / std::max(time.count(), flops / fastest);
}

}  // namespace

Deadline deadline_after(std::chrono::duration<double> time, Deadline begin) {
  const std::chrono::duration<double> longest = no_deadline - begin;
  if (!(time < longest)) return no_deadline;
  return begin + std::chrono::duration_cast<Clock::duration>(time);
}

KernelTooLong::KernelTooLong(Index rows, double seconds, double left)
    : std::runtime_error(sentence(rows, seconds, left)) {}

void KernelClock::before(Index rows, const KernelCost& cost) {
  constexpr double little = 1 << 20;  // far less than require_memory() looks at
  if (cost.bytes > little) require_memory(cost.bytes, "the factors of " + std::to_string(rows) + " rows");
  begin_ = Clock::now();
  if (deadline_ == no_deadline || cost.flops / fastest < short_call / 100) return;
  if (!(rate_ > 0)) rate_ = rate_of_machine();
  const double seconds = cost.flops / rate_;
  const double left = std::max(0.0, std::chrono::duration<double>(deadline_ - begin_).count());
  if (seconds > short_call && seconds > left) throw KernelTooLong(rows, seconds, left);
}

void KernelClock::after(const KernelCost& cost) {
  const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  longest_ = std::max(longest_, seconds);
  if (cost.flops > 0 && seconds > short_call / 10) rate_ = cost.flops / seconds;
}

}  // namespace perp::lcp
