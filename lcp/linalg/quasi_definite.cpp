// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/quasi_definite.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace perp::lcp {
namespace {

/// Operations from which on what works column by column loses to dense blocks: some tenths of a second.
constexpr double most_flops = 3e8;
/// Steps of refinement; each costs a solve.
constexpr int refinements = 4;

/// Eigen's, which knows the columns of L after the analysis, and tells derived classes.
class Ldlt : public ::Eigen::SimplicialLDLT<SpMat> {
 public:
  KernelCost cost() const {
    KernelCost sum;
    for (Index j = 0; j < m_nonZerosPerCol.size(); ++j) {
      const double entries = m_nonZerosPerCol[j];
      sum.flops += entries * (entries + 1);
      sum.bytes += entries * (sizeof(double) + sizeof(int));
    }
    return sum;
  }
};

}  // namespace

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

struct QuasiDefinite::Impl {
  Vec sigma;
  SpMat signed_K;
  Ldlt ldlt;
  KernelClock clock;
};

QuasiDefinite::QuasiDefinite(KernelClock clock) : impl_(std::make_unique<Impl>()) { impl_->clock = clock; }
QuasiDefinite::~QuasiDefinite() = default;

bool QuasiDefinite::analyze(const SpMat& M) {
  const auto sigma = signs_of(M);
  if (!sigma) return false;
  impl_->sigma = *sigma;
  impl_->signed_K = M;
  impl_->ldlt.analyzePattern(impl_->signed_K);
  return impl_->ldlt.cost().flops <= most_flops;
}

bool QuasiDefinite::factor(const SpMat& K) {
  impl_->signed_K = impl_->sigma.asDiagonal() * K;
  const KernelCost cost = impl_->ldlt.cost();
  impl_->clock.before(K.rows(), cost);
  impl_->ldlt.factorize(impl_->signed_K);
  impl_->clock.after(cost);
  return impl_->ldlt.info() == ::Eigen::Success && impl_->ldlt.vectorD().allFinite();
}

bool QuasiDefinite::solve(const SpMat& K, In b, Out x, double accuracy) const {
  const double enough = accuracy * b.lpNorm<::Eigen::Infinity>();
  x.setZero();
  Vec r = b;
  double norm = infinity;
  for (int k = 0; k <= refinements; ++k) {
    const Vec better = x + impl_->ldlt.solve(impl_->sigma.cwiseProduct(r));
    const Vec left = b - K * better;
    const double now = left.lpNorm<::Eigen::Infinity>();
    if (!(now < norm)) break;
    x = better, r = left, norm = now;
    if (norm <= 1e-3 * enough) break;
  }
  return norm <= enough;
}

}  // namespace perp::lcp
