// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/shifted_system.hpp"

#include <algorithm>

namespace perp::lcp {
namespace {

/// Steps of refinement at most; each costs a solve.
constexpr int refinements = 4;
/// Residual beside the right-hand side from which on Newton's direction gains nothing by another step.
constexpr double refined_enough = 1e-9;

}  // namespace

ShiftedSystem::ShiftedSystem(const SpMat& M, LuBackend lu, Deadline deadline)
    : M_(M), ldlt_(deadline), lu_(lu, deadline), symmetric_(ldlt_.analyze(M)) {}

double ShiftedSystem::dearness() const {
  // An entry of L takes two operations in a solve, and another two on the way back.
  return symmetric_ ? ldlt_.flops() / (4 * std::max(1.0, ldlt_.nonzeros())) : 10;
}

LuStatus ShiftedSystem::factor(const Vec& d) {
  d_ = d;
  ++factorizations_;
  by_lu_ = !symmetric_ || !ldlt_.factor(d);
  if (!by_lu_) return LuStatus::Ok;
  K_ = M_;
  for (Index i = 0; i < d.size(); ++i) K_.coeffRef(i, i) += d[i];
  return lu_.factor(K_);
}

Vec ShiftedSystem::solved(const Vec& b) const {
  Vec x(b.size());
  if (by_lu_)
    lu_.solve(b, x);
  else
    ldlt_.solve(b, x);
  return x;
}

double ShiftedSystem::solve(const Vec& b, Vec& x) const {
  const auto size = [&](const Vec& r) { return r.cwiseQuotient(d_.cwiseMax(1.0)).lpNorm<Eigen::Infinity>(); };
  const double enough = refined_enough * size(b);
  x = Vec::Zero(b.size());
  Vec r = b;
  double norm = infinity;
  for (int k = 0; k <= refinements; ++k) {
    const Vec better = x + solved(r);
    const Vec left = b - M_ * better - d_.cwiseProduct(better);
    const double now = size(left);
    if (!(now < norm)) break;
    x = better, r = left, norm = now;
    if (norm <= enough) break;
  }
  return norm / std::max(size(b), 1e-300);
}

}  // namespace perp::lcp
