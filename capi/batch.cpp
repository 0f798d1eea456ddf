// SPDX-License-Identifier: Apache-2.0
/// Many affine problems of one size.
#include "lcp/vi/batch.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "capi/guard.hpp"
#include "capi/matrix.hpp"

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
                                   .M = varying_of(M, n * n, "M"),
                                   .q = varying_of(q, n, "q"),
                                   .A = varying_of(A, m * n, "A"),
                                   .b = varying_of(row_lower, m, "row_lower", &zeros),
                                   .c = varying_of(row_upper, m, "row_upper", &infinities),
                                   .l = varying_of(lower, n, "lower", &zeros),
                                   .u = varying_of(upper, n, "upper", &infinities)};
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
