// SPDX-License-Identifier: Apache-2.0
/// Where paths end: the zero of the last linear piece, as exact as doubles are.
#include <algorithm>
#include <utility>

#include "lcp/judge/judge.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/pivoting/normal_path.hpp"

namespace perp::lcp {

double NormalPath::judge(In x) const {
  return natural_residual(original_, project(original_.box, scaling_.to_original(problem_.box, x)));
}

/// x - B^-1 G with the present factors.
Vec NormalPath::corrected(const Vec& x, In G) const {
  Vec correction(n_);
  factor_.ftran(G, correction);
  Vec better = x;
  for (Index p = 0; p < n_; ++p)
    if (const Index i = head(p); i < n_) better[i] -= correction[p];
  return better;
}

/// The Newton step on the normal map.
Vec NormalPath::refined(const Vec& x) const {
  const Vec z = project(problem_.box, x);
  return corrected(x, problem_.M * z + problem_.q + x - z);
}

/// The natural residual with F summed without rounding errors, which is what the judge will say.
double NormalPath::judge_exactly(In x) const {
  return lcp::judge(original_, project(original_.box, scaling_.to_original(problem_.box, x))).natural;
}

/// z of the present linear piece, in the units of the problem: x_i inside, though it may have left its cell by
/// rounding.
Vec NormalPath::piece(In x) const {
  const Box& box = original_.box;
  return Vec::NullaryExpr(n_, [&](Index i) {
    if (inside(i)) return scaling_.columns[i] * x[i];
    return cells_[at(i)] == Cell::Above ? box.upper[i] : box.lower[i];
  });
}

/// refined(), of the present piece and of the problem's own F without rounding errors: where large terms cancel, the
/// last digits are beyond what G in doubles knows.
Vec NormalPath::refined_exactly(const Vec& x) const {
  const Vec F = lcp::judge(original_, piece(x)).F;
  if (F.size() != n_ || !F.allFinite()) return x;  // z overflows in the units of the problem
  Vec G = scaling_.rows.cwiseProduct(F);
  for (Index i = 0; i < n_; ++i)
    if (!inside(i)) G[i] += x[i] - (cells_[at(i)] == Cell::Above ? problem_.box.upper[i] : problem_.box.lower[i]);
  return corrected(x, G);
}

/// At t = 1: the zero of the last linear piece, by refinement with the factors at hand, or from a fresh factorization
/// where that is not accurate; then with exact residuals.
void NormalPath::polish() {
  if (driver_ != n_) return;
  const bool to_go_on = options_.keep_basis;  // of Newton's method: its next step takes the last digits along
  const double rounding = 1e-13 * (1 + original_.q.lpNorm<::Eigen::Infinity>());
  const double enough = to_go_on ? rounding : std::min(options_.residual_tol, rounding);
  double judged = judge(x_);
  const auto take_better = [&](const Vec& x) {
    if (!x.allFinite()) return;
    const double there = judge(x);
    if (!(there < judged)) return;
    x_ = x;
    judged = there;
  };
  if (!distrusted_) take_better(refined(x_));
  if (!distrusted_ && judged <= enough) return;
  const Vec carried = x_;
  if (!refactor()) return;
  const Vec fresh = x_;
  x_ = carried;
  take_better(fresh);
  take_better(refined(fresh));
  if (to_go_on && judged <= options_.residual_tol) return;
  constexpr int exact_steps = 3;
  double exactly = judge_exactly(x_);
  Vec x = x_;
  for (int k = 0; k < exact_steps && exactly > options_.residual_tol; ++k) {
    x = refined_exactly(x);
    if (!x.allFinite()) break;
    const double there = judge_exactly(x);
    if (!(there < exactly)) continue;
    x_ = x;
    exactly = there;
  }
}

Vec NormalPath::chord_step(In r) const {
  Vec y(n_);
  factor_.ftran(scaling_.rows.cwiseProduct(r), y);
  Vec dx = Vec::Zero(n_);
  for (Index p = 0; p < n_; ++p)
    if (const Index i = head(p); i < n_) dx[i] = -y[p] * (inside(i) ? scaling_.columns[i] : 1 / scaling_.rows[i]);
  return dx;
}

PivotResult NormalPath::finish(PivotResult result) {
  const bool at_end = tau_ >= scale_ && result.end != PivotEnd::Ray;
  if (at_end) polish();
  result.x = x();
  result.z = project(original_.box, result.x);
  result.cells = cells_;
  result.t = t();
  result.residual = natural_residual(original_, result.z);
  const double scale = 1 + (n_ > 0 ? original_.q.lpNorm<::Eigen::Infinity>() : 0);
  const bool right = result.residual <= options_.residual_tol * scale;
  if (right)
    result.end = PivotEnd::Solved;
  else if (at_end)
    result.end = PivotEnd::Inaccurate;
  const bool last = tau_ >= best_tau_ || right;
  result.best_t = last ? result.t : best_tau_ / scale_;
  result.best_x = last ? result.x : scaling_.to_original(problem_.box, best_x_);
  result.refactorizations = factor_.factorizations();
  return result;
}

}  // namespace perp::lcp
