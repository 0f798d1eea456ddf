// SPDX-License-Identifier: Apache-2.0
/// Cholesky where the matrix is symmetric and proves positive definite, the general library elsewhere: a third of the
/// arithmetic, no search for pivots, and the time does not depend on BLAS.
#include <limits>
#include <memory>
#include <utility>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/cholesky/symmetric.hpp"
#include "lcp/lu/lu_backend.hpp"
#include "lcp/memory.hpp"

namespace perp::lcp {
namespace {

/// Of A and its mirror image, relative to sqrt(A_ii A_jj): what factors are off by anyway.
constexpr double same_to_rounding = 1e-15;
/// Of Cholesky::rcond(): below, the general library's answer counts.
constexpr double surely_regular = 1e-8;
/// Patterns in turn that looked definite and were not; then no more are tried.
constexpr int most_failures = 2;

bool looks_definite(const SpMat& A) { return A.diagonal().minCoeff() > 0 && symmetric(A, same_to_rounding); }

class DefiniteLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat& A) override {
    definite_ = failures_ < most_failures && looks_definite(A) && cholesky_.analyze(A) == CholeskyStatus::Ok;
    return definite_ ? LuStatus::Ok : analyze_general(A);
  }

  FactorCost cost() const override {
    if (!definite_) return general_->cost();
    return {.flops = cholesky_.flops(), .bytes = (sizeof(double) + sizeof(int)) * cholesky_.nonzeros()};
  }

  LuStatus factor(const SpMat& A) override {
    if (definite_ && looks_definite(A)) {
      if (cholesky_.factor(A) == CholeskyStatus::Ok && cholesky_.rcond() >= surely_regular) {
        failures_ = 0;
        return LuStatus::Ok;
      }
      ++failures_;
    }
    if (!definite_) return general_->factor(A);
    const LuStatus answer = analyze_general(A);
    if (answer != LuStatus::Ok) return answer;
    definite_ = false;
    require_factors(A.rows(), general_->cost().bytes);
    return general_->factor(A);
  }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
    definite_ ? cholesky_.solve(b, x) : general_->solve(A, b, x, transposed);
  }
  double pivot_ratio() const override { return definite_ ? cholesky_.rcond() : general_->pivot_ratio(); }
  bool factors(LuFactors& out) const override { return definite_ ? extract(out) : general_->factors(out); }

 private:
  LuStatus analyze_general(const SpMat& A) {
    if (!general_) general_ = make_general();
    return general_->analyze(A);
  }
  bool extract(LuFactors& out) const;

  Cholesky cholesky_;
  std::unique_ptr<LuLibrary> general_;
  bool definite_ = false;
  int failures_ = 0;
};

/// With C the factor and D its diagonal: P A P' = C C' = (C D^-1) (D C').
bool DefiniteLu::extract(LuFactors& out) const {
  if (cholesky_.rcond() == 0 || cholesky_.nonzeros() > std::numeric_limits<int>::max()) return false;
  CholeskyColumns C = cholesky_.columns();
  const auto n = static_cast<Index>(C.order.size());
  out.L = Triangle{};
  out.U_transposed = Triangle{};
  out.diagonal.resize(n);
  for (Index j = 0; j < n; ++j) {
    const auto first = at(C.start[at(j)]);
    const double pivot = C.value[first];
    out.diagonal[j] = pivot * pivot;
    for (auto e = first + 1; e < at(C.start[at(j) + 1]); ++e) {
      out.L.push(C.row[e], C.value[e] / pivot);
      out.U_transposed.push(C.row[e], C.value[e] * pivot);
    }
    out.L.end_column();
    out.U_transposed.end_column();
  }
  out.L_transposed = out.L.transpose();
  out.U = out.U_transposed.transpose();
  out.P = C.order;
  out.Q = std::move(C.order);
  out.R = Vec::Ones(n);
  out.finish();
  return true;
}

}  // namespace

std::unique_ptr<LuLibrary> make_definite() { return std::make_unique<DefiniteLu>(); }

}  // namespace perp::lcp
