// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/refactored_lu.hpp"

#include <klu.h>

namespace perp::lcp {

struct RefactoredLu::Impl {
  Impl() {
    klu_defaults(&common);
    common.tol = 0.1;  // as Klu's
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { forget(); }
  void forget() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  /// KLU takes pointers to what it does not change.
  static int* ints(const int* p) { return const_cast<int*>(p); }
  static double* doubles(const double* p) { return const_cast<double*>(p); }
  bool regular() { return klu_rcond(symbolic, numeric, &common) != 0 && common.rcond > 0; }

  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  int n = 0;
};

RefactoredLu::RefactoredLu() : impl_(std::make_unique<Impl>()) {}
RefactoredLu::~RefactoredLu() = default;
RefactoredLu::RefactoredLu(RefactoredLu&&) noexcept = default;
RefactoredLu& RefactoredLu::operator=(RefactoredLu&&) noexcept = default;

LuStatus RefactoredLu::factor(const SpMat& A) {
  Impl& s = *impl_;
  s.forget();
  s.n = static_cast<int>(A.rows());
  if (s.n == 0) return LuStatus::Ok;
  if (A.nonZeros() < A.rows()) return LuStatus::Singular;
  const auto failed = [&s] { return s.common.status == KLU_SINGULAR ? LuStatus::Singular : LuStatus::OutOfMemory; };
  s.symbolic = klu_analyze(s.n, Impl::ints(A.outerIndexPtr()), Impl::ints(A.innerIndexPtr()), &s.common);
  if (s.symbolic == nullptr) return failed();
  s.numeric = klu_factor(Impl::ints(A.outerIndexPtr()), Impl::ints(A.innerIndexPtr()), Impl::doubles(A.valuePtr()),
                         s.symbolic, &s.common);
  if (s.numeric == nullptr) return failed();
  return s.common.status == KLU_OK && s.regular() ? LuStatus::Ok : LuStatus::Singular;
}

bool RefactoredLu::refactor(const SpMat& A) {
  Impl& s = *impl_;
  if (s.n == 0) return true;
  return klu_refactor(Impl::ints(A.outerIndexPtr()), Impl::ints(A.innerIndexPtr()), Impl::doubles(A.valuePtr()),
                      s.symbolic, s.numeric, &s.common) != 0 &&
         s.common.status == KLU_OK && s.regular();
}

void RefactoredLu::solve(Out b) {
  Impl& s = *impl_;
  if (s.n > 0) klu_solve(s.symbolic, s.numeric, s.n, 1, b.data(), &s.common);
}

}  // namespace perp::lcp
