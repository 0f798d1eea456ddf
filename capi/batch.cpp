// SPDX-License-Identifier: Apache-2.0
/// Many affine problems of one size.
#include "lcp/vi/batch.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "capi/guard.hpp"
#include "capi/matrix.hpp"

namespace perp::capi {

namespace {

/// The caller's numbers, or `otherwise` for all.
lcp::Varying varying(const perp_varying* given, int64_t size, const char* name, const std::vector<double>* otherwise) {
  if (size == 0) return {};
  if (given == nullptr || given->values == nullptr) {
    if (otherwise == nullptr) require(nullptr, name);
    return {otherwise->data(), 0};
  }
  if (given->step < 0) refuse(name, "its step is " + std::to_string(given->step) + ", negative");
  return {given->values, static_cast<Index>(given->step)};  // as wide as an address
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_batch_vi(int32_t interface_, int64_t count, int64_t n, int64_t m, const perp_varying* M,
                      const perp_varying* q, const perp_varying* A, const perp_varying* row_lower,
                      const perp_varying* row_upper, const perp_varying* lower, const perp_varying* upper, double tol,
                      int32_t threads, double* x, double* multipliers, int32_t* status, double* residual,
                      perp_error* error) {
  return guarded(error, [&] {
    require_interface(interface_);
    check_size(n, "n");
    check_size(m, "m");
    if (count < 0) refuse("count", "is " + std::to_string(count) + ", negative");
    if (!(tol > 0) || tol == perp::lcp::infinity)
      refuse("tol", "is " + std::to_string(tol) + ", not a positive number");
    if (count == 0) return;
    if (n > 0) require(x, "x");
    const auto all = static_cast<std::size_t>(std::max(n, m));
    const std::vector<double> zeros(all, 0), infinities(all, perp::lcp::infinity);
    const perp::lcp::ViBatch batch{.count = static_cast<Index>(count),
                                   .n = static_cast<Index>(n),
                                   .m = static_cast<Index>(m),
                                   .M = varying(M, n * n, "M", nullptr),
                                   .q = varying(q, n, "q", nullptr),
                                   .A = varying(A, m * n, "A", nullptr),
                                   .b = varying(row_lower, m, "row_lower", &zeros),
                                   .c = varying(row_upper, m, "row_upper", &infinities),
                                   .l = varying(lower, n, "lower", &zeros),
                                   .u = varying(upper, n, "upper", &infinities)};
    const auto k = static_cast<std::size_t>(count);
    std::vector<perp::Status> statuses(status != nullptr ? k : 0);
    const auto span = [&](double* values, int64_t each) {
      return values != nullptr ? std::span<double>(values, k * static_cast<std::size_t>(each)) : std::span<double>{};
    };
    perp::lcp::solve_batch(batch, {span(x, n), span(multipliers, m), statuses, span(residual, 1)}, threads,
                           {.tol = tol});
    for (std::size_t i = 0; i < statuses.size(); ++i) status[i] = static_cast<int32_t>(statuses[i]);
  });
}
