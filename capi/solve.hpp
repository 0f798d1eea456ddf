// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Shared by the functions that work.
#include <memory>
#include <optional>

#include "capi/handles.hpp"
#include "capi/sigint.hpp"

namespace perp::capi {

/// The affine problem of the caller's arrays.
std::unique_ptr<perp_problem> affine_problem(std::int32_t interface, const perp_matrix* M, const double* q,
                                             const double* lower, const double* upper);

/// The problem's start k, in the box.
ncp::Vec own_start(const perp_problem& problem, std::size_t k = 0);
/// x0, checked, or the problem's own start where it is null.
ncp::Vec start_of(const perp_problem& problem, const double* x0, const char* argument);

/// Work with a solver: while it lives, Ctrl-C stops it if the solver heeds it, and the callbacks of the problem, if it
/// has some, are watched. At its end it takes back what was asked to stop, so that the next solve runs.
class Work {
 public:
  /// `solver` null: as usual.
  explicit Work(perp_solver* solver, const CallbackMcp* callbacks = nullptr)
      : solver_(solver != nullptr ? *solver : usual_.emplace()),
        on_interrupt_(solver_.heeds_sigint ? &solver_.stop : nullptr),
        watch_(callbacks, &solver_.stop) {}
  ~Work() { solver_.stop = false; }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  perp_solver& solver() { return solver_; }
  std::atomic<bool>* stop() { return &solver_.stop; }
  const Watch& watch() const { return watch_; }

 private:
  std::optional<perp_solver> usual_{};
  perp_solver& solver_;
  StopOnInterrupt on_interrupt_;
  Watch watch_;
};

}  // namespace perp::capi
