// SPDX-License-Identifier: Apache-2.0
#include <klu.h>

#include <algorithm>

#include "lcp/lu/lu_backend.hpp"

namespace perp::lcp {
namespace {

class Klu final : public LuLibrary {
 public:
  Klu() {
    klu_defaults(&common_);
    common_.tol = 0.1;  // KLU's own 0.001 loses six digits on random matrices
  }
  Klu(const Klu&) = delete;
  Klu& operator=(const Klu&) = delete;
  ~Klu() override {
    klu_free_numeric(&numeric_, &common_);
    klu_free_symbolic(&symbolic_, &common_);
  }

  LuStatus analyze(const SpMat& A) override {
    klu_free_numeric(&numeric_, &common_);  // belongs to the old analysis
    klu_free_symbolic(&symbolic_, &common_);
    pattern_ = A;  // KLU takes pointers to non-const
    symbolic_ = klu_analyze(static_cast<int>(A.rows()), pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), &common_);
    return symbolic_ ? LuStatus::Ok : status();
  }

  KernelCost cost() const override {
    constexpr double bytes_of_entry = sizeof(double) + sizeof(int);
    return {.flops = std::max(0.0, symbolic_->est_flops),
            .bytes = bytes_of_entry * std::max(0.0, symbolic_->lnz + symbolic_->unz)};
  }

  LuStatus factor(const SpMat& A) override {
    klu_free_numeric(&numeric_, &common_);
    std::copy_n(A.valuePtr(), A.nonZeros(), pattern_.valuePtr());
    numeric_ = klu_factor(pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), pattern_.valuePtr(), symbolic_, &common_);
    if (!numeric_) return status();
    if (common_.status == KLU_SINGULAR) return LuStatus::Singular;
    // a pivot that underflowed or overflowed: min |U_ii| / max |U_ii|
    return klu_rcond(symbolic_, numeric_, &common_) && common_.rcond > 0 ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
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

 private:
  LuStatus status() const { return common_.status == KLU_SINGULAR ? LuStatus::Singular : LuStatus::OutOfMemory; }

  klu_common common_{};
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_ = nullptr;
  SpMat pattern_;
};

}  // namespace

std::unique_ptr<LuLibrary> make_klu() { return std::make_unique<Klu>(); }

}  // namespace perp::lcp
