// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/lu_klu.hpp"

#include <algorithm>
#include <functional>
#include <new>
#include <utility>

namespace perp::lcp {
namespace {

constexpr double entry_bytes = sizeof(double) + sizeof(int);

}  // namespace

Klu::Klu() {
  klu_defaults(&common_);
  common_.tol = 0.1;  // KLU's own 0.001 loses six digits on random matrices
}
Klu::~Klu() {
  klu_free_numeric(&numeric_, &common_);
  klu_free_symbolic(&symbolic_, &common_);
}

LuStatus Klu::analyze(const SpMat& A) {
  klu_free_numeric(&numeric_, &common_);  // belongs to the old analysis
  klu_free_symbolic(&symbolic_, &common_);
  pattern_ = A;  // KLU takes pointers to non-const
  symbolic_ = klu_analyze(static_cast<int>(A.rows()), pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), &common_);
  return symbolic_ ? LuStatus::Ok : status();
}

KernelCost Klu::cost() const {
  return {.flops = std::max(0.0, symbolic_->est_flops),
          .bytes = entry_bytes * std::max(0.0, symbolic_->lnz + symbolic_->unz)};
}

KernelCost Klu::spent() const {
  klu_common common = common_;
  klu_flops(symbolic_, numeric_, &common);
  return {.flops = common.flops, .bytes = entry_bytes * static_cast<double>(numeric_->lnz + numeric_->unz)};
}

LuStatus Klu::factor(const SpMat& A) {
  klu_free_numeric(&numeric_, &common_);
  std::copy_n(A.valuePtr(), A.nonZeros(), pattern_.valuePtr());
  numeric_ = klu_factor(pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), pattern_.valuePtr(), symbolic_, &common_);
  if (!numeric_) return status();
  if (common_.status == KLU_SINGULAR) return LuStatus::Singular;
  // a pivot that underflowed or overflowed: min |U_ii| / max |U_ii|
  return klu_rcond(symbolic_, numeric_, &common_) && common_.rcond > 0 ? LuStatus::Ok : LuStatus::Singular;
}

void Klu::solve(const SpMat& A, In b, Out x, bool transposed) const {
  x = b;
  const int n = static_cast<int>(A.rows());
  // Solves may run in two threads: each has its own status, and its own copy of the head of the factors with a
  // workspace of its own - KLU's is one per factorization.
  klu_common common = common_;
  klu_numeric numeric = *numeric_;
  Vec workspace(4 * A.rows());
  numeric.Xwork = workspace.data();
  if (transposed)
    klu_tsolve(symbolic_, &numeric, n, 1, x.data(), &common);
  else
    klu_solve(symbolic_, &numeric, n, 1, x.data(), &common);
}

/// With L, U of the diagonal blocks and F above them, (R A)(P, Q) = L U + F = L (U + L^-1 F): what a factorization
/// without blocks and with the same pivots would have come to.
void Klu::extract(LuFactors& out) const {
  const int n = numeric_->n;
  const auto length = [](int size) { return static_cast<std::size_t>(size); };
  Triangle l{.start = std::vector<int>(length(n) + 1),
             .row = std::vector<int>(length(numeric_->lnz)),
             .value = std::vector<double>(length(numeric_->lnz))};
  Triangle u{.start = std::vector<int>(length(n) + 1),
             .row = std::vector<int>(length(numeric_->unz)),
             .value = std::vector<double>(length(numeric_->unz))};
  Triangle f{.start = std::vector<int>(length(n) + 1),
             .row = std::vector<int>(length(numeric_->nzoff)),
             .value = std::vector<double>(length(numeric_->nzoff))};
  out.P.resize(length(n));
  out.Q.resize(length(n));
  Vec scale(n);
  std::vector<int> blocks(length(symbolic_->nblocks) + 1);
  klu_common common = common_;
  if (!klu_extract(numeric_, symbolic_, l.start.data(), l.row.data(), l.value.data(), u.start.data(), u.row.data(),
                   u.value.data(), f.start.data(), f.row.data(), f.value.data(), out.P.data(), out.Q.data(),
                   scale.data(), blocks.data(), &common))
    throw std::bad_alloc();
  out.R.resize(n);
  for (int k = 0; k < n; ++k) out.R[out.P[length(k)]] = 1 / scale[k];  // scale is by pivots

  out.L = Triangle{};
  for (int j = 0; j < n; ++j) {
    for (int k = l.start[length(j)]; k < l.start[length(j) + 1]; ++k)
      if (l.row[length(k)] != j) out.L.push(l.row[length(k)], l.value[length(k)]);
    out.L.end_column();
  }
  out.U = Triangle{};
  out.diagonal.resize(n);
  Vec x = Vec::Zero(n);  // zero wherever no row is waiting
  std::vector<char> seen(length(n), 0);
  std::vector<int> waiting;  // a heap: L leads downwards only
  const auto wait = [&](int i) {
    if (std::exchange(seen[length(i)], 1)) return;
    waiting.push_back(i);
    std::ranges::push_heap(waiting, std::greater<>{});
  };
  for (int j = 0; j < n; ++j) {
    for (int k = u.start[length(j)]; k < u.start[length(j) + 1]; ++k) {
      if (u.row[length(k)] == j)
        out.diagonal[j] = u.value[length(k)];
      else
        out.U.push(u.row[length(k)], u.value[length(k)]);
    }
    for (int k = f.start[length(j)]; k < f.start[length(j) + 1]; ++k) {
      x[f.row[length(k)]] = f.value[length(k)];
      wait(f.row[length(k)]);
    }
    while (!waiting.empty()) {
      std::ranges::pop_heap(waiting, std::greater<>{});
      const int i = waiting.back();
      waiting.pop_back();
      seen[length(i)] = 0;
      const double value = std::exchange(x[i], 0.0);
      if (value == 0) continue;
      out.U.push(i, value);
      for (int k = out.L.start[length(i)]; k < out.L.start[length(i) + 1]; ++k) {
        x[out.L.row[length(k)]] -= out.L.value[length(k)] * value;
        wait(out.L.row[length(k)]);
      }
    }
    out.U.end_column();
  }
  out.L_transposed = out.L.transpose();
  out.U_transposed = Triangle{};
  out.finish();
}

std::unique_ptr<LuLibrary> make_klu() { return std::make_unique<Klu>(); }

}  // namespace perp::lcp
