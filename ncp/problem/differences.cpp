// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/differences.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ncp/problem/colouring.hpp"

namespace perp::ncp {

using lcp::Index;
using lcp::Vec;

ColouredDifferences::ColouredDifferences(const lcp::SpMat& pattern, const DifferenceFormula& formula)
    : pattern_(pattern), formula_(formula), groups_(column_groups(pattern)) {
  if (!(formula.noise > 0 && formula.noise < 1))
    throw std::invalid_argument("differences: the noise of F is " + std::to_string(formula.noise) +
                                "; it must be between 0 and 1");
}

void ColouredDifferences::keep(lcp::In x, lcp::In F) {
  x_ = x;
  F_ = F;
  known_ = true;
}

bool ColouredDifferences::evaluate(const Function& function, lcp::In x, Vec& F) {
  ++F_evals_;
  F.setZero(x.size());
  return function(x, F);
}

bool ColouredDifferences::jacobian(const Function& function, const lcp::Box& box, lcp::In x, double* value) {
  if (!known_ || x != x_) {
    known_ = false;
    x_ = x;
    if (!evaluate(function, x_, F_)) return false;
    known_ = true;
  }
  if (!F_.allFinite()) return false;
  return std::ranges::all_of(groups_, [&](const auto& columns) { return group(function, box, columns, value); });
}

/// Those of the first attempt, or of another one, to other points; nothing if there are none in the box.
std::optional<ColouredDifferences::Steps> ColouredDifferences::steps(const lcp::Box& box, Index j, int attempt) const {
  constexpr double shortest = 1.0 / 64;  // of a step, where the box is narrow
  const double size = formula_.central ? std::cbrt(formula_.noise) : std::sqrt(formula_.noise);
  double h = size * std::max(1.0, std::abs(x_[j]));
  const double reach = formula_.central ? 2 : 1;  // of one-sided steps, in h
  const double up = box.upper[j] - x_[j];
  const double down = x_[j] - box.lower[j];
  const double room = std::max(up, down);
  const bool nowhere = room < shortest * reach * h;  // to stay in the box
  if (!nowhere) h = std::min(h, room / reach);
  const bool symmetric = nowhere || (up >= h && down >= h);
  const double side = nowhere || up >= reach * h ? 1 : -1;
  if (formula_.central && symmetric && attempt == 0) return Steps{h, -h};
  // One-sided: the preferred side comes first, then the other one.
  const bool other = attempt == (formula_.central && symmetric ? 2 : 1);
  if (attempt > (formula_.central && symmetric ? 2 : 1)) return std::nullopt;
  const double way = other ? -side : side;
  if (!nowhere && (way > 0 ? up : down) < reach * h) return std::nullopt;
  return Steps{way * h, 2 * way * h};
}

bool ColouredDifferences::group(const Function& function, const lcp::Box& box, const std::vector<int>& columns,
                                double* value) {
  std::vector<int> left = columns;
  for (int attempt = 0; attempt < attempts() && !left.empty(); ++attempt)
    left = quotients(function, box, left, attempt, value);
  if (left.empty() || columns.size() == 1) return left.empty();
  return std::ranges::all_of(left, [&](int j) {
    for (int attempt = 0; attempt < attempts(); ++attempt)
      if (quotients(function, box, {j}, attempt, value).empty()) return true;
    return false;
  });
}

/// Steps of these columns together; returns those of which F tells nothing.
std::vector<int> ColouredDifferences::quotients(const Function& function, const lcp::Box& box,
                                                const std::vector<int>& columns, int attempt, double* value) {
  moved_[0] = moved_[1] = x_;
  std::vector<int> left;
  std::vector<int> moving;
  for (const int j : columns) {
    const auto step = steps(box, j, attempt);
    (step ? moving : left).push_back(j);
    if (!step) continue;
    // A step to a bound must not end beyond it by a rounding.
    const auto inside = [&](double z) {
      const bool in =
          x_[j] >= box.lower[j] && x_[j] <= box.upper[j] && box.upper[j] - box.lower[j] >= std::abs(z - x_[j]);
      return in ? std::clamp(z, box.lower[j], box.upper[j]) : z;
    };
    moved_[0][j] = inside(x_[j] + step->first);
    moved_[1][j] = inside(x_[j] + step->second);
  }
  if (moving.empty()) return left;
  bool defined = evaluate(function, moved_[0], F_moved_[0]);
  if (defined && formula_.central) defined = evaluate(function, moved_[1], F_moved_[1]);
  for (const int j : moving)
    if (!defined || !column(j, F_moved_[0], F_moved_[1], value)) left.push_back(j);
  return left;
}

/// The derivative at 0 of the polynomial through the two or three points; false if it is not finite.
bool ColouredDifferences::column(int j, const Vec& first, const Vec& second, double* value) const {
  const double a = moved_[0][j] - x_[j];  // the steps as the machine has them
  const double b = moved_[1][j] - x_[j];
  bool finite = true;
  for (int k = pattern_.outerIndexPtr()[j]; k < pattern_.outerIndexPtr()[j + 1]; ++k) {
    const int i = pattern_.innerIndexPtr()[k];
    const double slope = (first[i] - F_[i]) / a;
    value[k] = formula_.central ? (b * slope - a * ((second[i] - F_[i]) / b)) / (b - a) : slope;
    finite = finite && std::isfinite(value[k]);
  }
  return finite;
}

}  // namespace perp::ncp
