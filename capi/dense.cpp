// SPDX-License-Identifier: Apache-2.0
/// Small dense problems.
#include "lcp/solve/dense.hpp"
#include "capi/guard.hpp"
#include "capi/matrix.hpp"

struct perp_dense {
  perp::lcp::DenseSolver solver{};
  perp::lcp::Vec lower{}, upper{};  ///< where the caller has none
};

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_dense_create(int32_t interface_, perp_dense** solver, perp_error* error) {
  return guarded_make(solver, "solver", error, [&] {
    require_interface(interface_);
    return std::make_unique<perp_dense>();
  });
}

void perp_dense_free(perp_dense* solver) { delete solver; }

int32_t perp_dense_solve(perp_dense* solver, int64_t n, const double* M, const double* q, const double* lower,
                         const double* upper, double tol, double* x, int32_t* status, double* residual,
                         perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    check_size(n, "n");
    if (n > 0)
      for (const auto& [given, name] : {std::pair{M, "M"}, {q, "q"}, {static_cast<const double*>(x), "x"}})
        require(given, name);
    if (lower == nullptr) solver->lower.setZero(n);
    if (upper == nullptr) solver->upper.setConstant(n, perp::lcp::infinity);
    using Values = Eigen::Map<const Vec>;
    using Strides = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
    const Eigen::Map<const Eigen::MatrixXd, 0, Strides> by_rows(M, n, n, Strides(1, n));
    const perp::lcp::Result& result = solver->solver.solve(
        by_rows, Values(q, n), lower == nullptr ? Values(solver->lower.data(), n) : Values(lower, n),
        upper == nullptr ? Values(solver->upper.data(), n) : Values(upper, n), {.tol = tol});
    Eigen::Map<Vec>(x, n) = result.z;
    if (status != nullptr) *status = static_cast<int32_t>(result.status);
    if (residual != nullptr) *residual = result.residual;
  });
}

void perp_dense_forget(perp_dense* solver) {
  if (solver != nullptr) solver->solver.forget();
}
