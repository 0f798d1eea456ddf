// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/shifted_system.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace perp::lcp {
namespace {

/// Each costs a solve.
constexpr int most_steps = 10;
/// Residual beside the right-hand side from which on Newton's direction gains nothing by another step; with ten times
/// that QPILOTNO is lost.
constexpr double solved_enough = 1e-5;

}  // namespace

ShiftedSystem::ShiftedSystem(const SpMat& M, LuBackend lu) : M_(M), lu_(lu), symmetric_(ldlt_.analyze(M)) {}

void ShiftedSystem::update() { symmetric_ = ldlt_.analyze(M_); }

double ShiftedSystem::dearness() const {
  // An entry of L takes two operations in a solve, and another two on the way back.
  return symmetric_ ? ldlt_.flops() / (4 * std::max(1.0, ldlt_.nonzeros())) : 10;
}

LuStatus ShiftedSystem::factor(const Vec& d) {
  d_ = d;
  weight_ = d.cwiseMax(1.0).cwiseInverse();
  if (symmetric_)
    for (const double more : {0.0, 1e-8, 1e-6})
      if (ldlt_.factor(d.array() + more)) {
        by_lu_ = false;
        ++factorizations_;
        return LuStatus::Ok;
      }
  return factor_by_lu();
}

LuStatus ShiftedSystem::factor_by_lu() {
  ++factorizations_;
  K_ = M_;
  for (Index i = 0; i < d_.size(); ++i) K_.coeffRef(i, i) += d_[i];
  const LuStatus status = lu_.factor(K_);
  by_lu_ = status == LuStatus::Ok;
  return status;
}

Vec ShiftedSystem::solved(const Vec& b) const {
  Vec x(b.size());
  if (by_lu_)
    lu_.solve(b, x);
  else
    ldlt_.solve(b, x);
  return x;
}

/// Generalised conjugate residuals, with the factors as preconditioner (Eisenstat, Elman & Schultz, SIAM J. Numer.
/// Anal. 20 (1983) 345): the first step is the solve, the others are refinement where that converges, and go on where
/// not.
void ShiftedSystem::solve(const Vec& b, Vec& x) const {
  std::vector<Vec> steps, images;  // p and W (M + diag(d)) p, these orthonormal
  Vec r = b.cwiseProduct(weight_), p, image(b.size());
  const double size = r.norm(), enough = solved_enough * size;
  double left = size;
  x.setZero(b.size());
  for (int k = 0; k < most_steps && left > enough; ++k) {
    if (k > 0) {
      const double length = image.norm();
      steps.push_back(p / length);
      images.push_back(image / length);
    }
    p = solved(k == 0 ? b : r.cwiseQuotient(weight_));
    image = d_.cwiseProduct(p);
    image.noalias() += M_ * p;
    image.array() *= weight_.array();
    for (std::size_t j = 0; j < steps.size(); ++j) {
      const double part = images[j].dot(image);
      image -= part * images[j];
      p -= part * steps[j];
    }
    const double square = image.squaredNorm();
    if (!(square > 0) || !std::isfinite(square)) break;
    const double step = image.dot(r) / square;
    x += step * p;
    r -= step * image;
    left = r.norm();
  }
}

}  // namespace perp::lcp
