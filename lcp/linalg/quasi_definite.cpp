// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/quasi_definite.hpp"

#include <algorithm>
#include <new>
#include <utility>
#include <vector>

namespace perp::lcp {
namespace {

bool same_pattern(const SpMat& A, const SpMat& B) {
  return A.isCompressed() && B.isCompressed() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols(), B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

/// take(i, M_ij, M_ji) for the entries of column j, i != j, until one answers false.
template <class Take>
bool both_ways(const SpMat& M, const SpMat& Mt, bool same, Index j, Take take) {
  if (same) {
    for (Index p = M.outerIndexPtr()[j]; p < M.outerIndexPtr()[j + 1]; ++p)
      if (const Index i = M.innerIndexPtr()[p]; i != j && !take(i, M.valuePtr()[p], Mt.valuePtr()[p])) return false;
    return true;
  }
  SpMat::InnerIterator it(M, j), back(Mt, j);
  while (it || back) {
    const Index i = !back || (it && it.row() < back.row()) ? it.row() : back.row();
    const double a = it && it.row() == i ? it.value() : 0;
    const double b = back && back.row() == i ? back.value() : 0;
    if (it && it.row() == i) ++it;
    if (back && back.row() == i) ++back;
    if (i != j && !take(i, a, b)) return false;
  }
  return true;
}

}  // namespace

std::optional<Vec> signs_of(const SpMat& M) {
  const SpMat Mt = M.transpose();
  const bool same = same_pattern(M, Mt);
  const Index n = M.rows();
  Vec sigma = Vec::Zero(n);
  std::vector<Index> stack;
  for (Index first = 0; first < n; ++first) {
    if (sigma[first] != 0) continue;
    sigma[first] = 1;
    stack.push_back(first);
    while (!stack.empty()) {
      const Index j = stack.back();
      stack.pop_back();
      const bool fits = both_ways(M, Mt, same, j, [&](Index i, double a, double b) {
        if (a == 0 && b == 0) return true;
        if (a != b && a != -b) return false;
        const double sign = a == b ? sigma[j] : -sigma[j];
        if (sigma[i] == 0) stack.push_back(i), sigma[i] = sign;
        return sigma[i] == sign;
      });
      if (!fits) return std::nullopt;
    }
  }
  return sigma;
}

QuasiDefinite::QuasiDefinite(Deadline deadline) : cholesky_(deadline, CholeskyOrdering::Thorough) {}

bool QuasiDefinite::analyze(const SpMat& M) {
  const auto sigma = signs_of(M);
  if (!sigma) return false;
  sigma_ = *sigma;
  lower_ = SpMat(sigma_.asDiagonal() * M).triangularView<Eigen::Lower>();
  lower_.makeCompressed();
  diagonal_ = lower_.diagonal();
  std::vector<signed char> signs(at(M.rows()));
  for (Index i = 0; i < M.rows(); ++i) signs[at(i)] = sigma_[i] > 0 ? 1 : -1;
  cholesky_.set_signs(std::move(signs));
  const CholeskyStatus status = cholesky_.analyze(lower_);
  if (status == CholeskyStatus::OutOfMemory) throw std::bad_alloc();
  return status == CholeskyStatus::Ok;
}

bool QuasiDefinite::factor(In d) {
  for (Index j = 0; j < lower_.cols(); ++j)
    lower_.valuePtr()[lower_.outerIndexPtr()[j]] = diagonal_[j] + sigma_[j] * d[j];
  return cholesky_.try_factor(lower_);
}

void QuasiDefinite::solve(In b, Out x) const { cholesky_.solve(sigma_.cwiseProduct(b), x); }

}  // namespace perp::lcp
