// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/refactored_lu.hpp"

#include "lcp/lu/lu_klu.hpp"

namespace perp::lcp {

struct RefactoredLu::Impl {
  Klu klu{};
  Index n = 0;
};

RefactoredLu::RefactoredLu() : impl_(std::make_unique<Impl>()) {}
RefactoredLu::~RefactoredLu() = default;
RefactoredLu::RefactoredLu(RefactoredLu&&) noexcept = default;
RefactoredLu& RefactoredLu::operator=(RefactoredLu&&) noexcept = default;

LuStatus RefactoredLu::factor(const SpMat& A) {
  impl_->n = A.rows();
  if (impl_->n == 0) return LuStatus::Ok;
  if (A.nonZeros() < A.rows()) return LuStatus::Singular;
  const LuStatus status = impl_->klu.analyze(A);
  return status == LuStatus::Ok ? impl_->klu.factor(A) : status;
}

bool RefactoredLu::refactor(const SpMat& A) { return impl_->n == 0 || impl_->klu.refactor(A); }

void RefactoredLu::solve(Out b) {
  if (impl_->n > 0) impl_->klu.solve_in_place(b);
}

}  // namespace perp::lcp
