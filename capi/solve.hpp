// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Shared by the functions that solve.
#include <memory>

#include "capi/handles.hpp"

namespace perp::capi {

/// The affine problem of the caller's arrays.
template <class Integer>
std::unique_ptr<perp_problem> affine_problem(std::int32_t interface, std::int64_t n, const Integer* start,
                                             const Integer* row, const double* value, const double* q,
                                             const double* lower, const double* upper);

/// Of a file its initial guess, else 0; in the box.
ncp::Vec own_start(const perp_problem& problem);

/// Takes back at its end what was asked to stop, so that the next solve runs.
class StopsHeard {
 public:
  explicit StopsHeard(std::atomic<bool>& stop) : stop_(stop) {}
  ~StopsHeard() { stop_ = false; }
  StopsHeard(const StopsHeard&) = delete;
  StopsHeard& operator=(const StopsHeard&) = delete;

 private:
  std::atomic<bool>& stop_;
};

}  // namespace perp::capi
