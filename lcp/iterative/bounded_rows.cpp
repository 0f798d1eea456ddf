// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/bounded_rows.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {
namespace {

constexpr double zero_pivot = 1e-10;  ///< relative to the largest entry of the row, or to 1

}  // namespace

BoundedRows::BoundedRows(const Eigen::MatrixXd& M, const Vec& q, const Box& box, double tol)
    : T_(M),
      value_(2 * q.size()),
      lower_(Vec::Constant(2 * q.size(), -infinity)),
      upper_(Vec::Constant(2 * q.size(), infinity)),
      basic_(at(q.size())),
      nonbasic_(at(q.size())),
      place_(at(2 * q.size())),
      tol_(tol) {
  const Index n = q.size();
  lower_.head(n) = box.lower;
  upper_.head(n) = box.upper;
  value_.head(n) = project(box, Vec::Zero(n));
  value_.tail(n) = M * value_.head(n) + q;
  for (Index i = 0; i < n; ++i) {
    basic_[at(i)] = n + i;
    nonbasic_[at(i)] = i;
    place_[at(n + i)] = i;
    place_[at(i)] = -1 - i;
  }
}

void BoundedRows::set_bounds(Index x, double lower, double upper) {
  lower_[x] = lower;
  upper_[x] = upper;
  const Index column = -1 - place_[at(x)];
  if (column >= 0) move(column, std::clamp(value_[x], lower, upper) - value_[x]);
}

BoundedRows::Feasibility BoundedRows::repair() {
  const Index n = size();
  const Index greedy = 4 * n + 10;  // steps before Bland's rule, which needs more of them
  for (Index step = 0; step < 100 * greedy; ++step) {
    const bool bland = step > greedy;
    const Index row = violated_row(bland);
    if (row < 0) return Feasibility::Feasible;
    const Index x = basic_[at(row)];
    const bool up = below(x);
    const Index column = entering(row, up ? 1 : -1, bland);
    if (column < 0) {
      empty_row_ = row;
      return Feasibility::Empty;
    }
    const double target = up ? lower_[x] : upper_[x];
    move(column, (target - value_[x]) / T_(row, column));
    value_[x] = target;
    if (!value_.allFinite()) return Feasibility::Undecided;
    pivot(row, column);
  }
  return Feasibility::Undecided;
}

/// The row says x_B - T x_N = const, a combination of w - M z = q with the factors that w has in it. x_B is below its
/// bound although T x_N is as large as it can be, or above.
Vec BoundedRows::multipliers() const {
  const Index n = size();
  Vec y = Vec::Zero(n);
  const Index x = basic_[at(empty_row_)];
  if (x >= n) y[x - n] = 1;
  for (Index column = 0; column < n; ++column)
    if (const Index k = nonbasic_[at(column)]; k >= n) y[k - n] = -T_(empty_row_, column);
  return value_[x] < lower_[x] ? y : Vec(-y);
}

Index BoundedRows::violated_row(bool bland) const {
  Index found = -1;
  double worst = 0;
  for (Index row = 0; row < size(); ++row) {
    const Index x = basic_[at(row)];
    if (!below(x) && !above(x)) continue;
    const double violation = std::max(lower_[x] - value_[x], value_[x] - upper_[x]);
    const bool better = bland ? found < 0 || x < basic_[at(found)] : violation > worst;
    if (!better) continue;
    found = row;
    worst = violation;
  }
  return found;
}

/// A column whose variable can move so that the row's grows in `direction`; -1 if none.
Index BoundedRows::entering(Index row, double direction, bool bland) const {
  const double zero = zero_pivot * std::max(1.0, T_.row(row).lpNorm<Eigen::Infinity>());
  Index found = -1;
  for (Index column = 0; column < size(); ++column) {
    const double a = direction * T_(row, column);
    const Index x = nonbasic_[at(column)];
    if (std::abs(a) <= zero || (a > 0 ? value_[x] >= upper_[x] : value_[x] <= lower_[x])) continue;
    const bool better = found < 0 || (bland ? x < nonbasic_[at(found)] : std::abs(a) > std::abs(T_(row, found)));
    if (better) found = column;
  }
  return found;
}

bool BoundedRows::push(Index x, double direction, double target) {
  const auto beyond = [&] { return direction * (value_[x] - target) > 0; };
  for (Index step = 0; step < 100 * (size() + 1); ++step) {
    if (beyond()) return true;
    const Index row = place_[at(x)];
    const Index column = row < 0 ? -1 - row : entering(row, direction, true);
    if (column < 0) return false;
    const Index y = nonbasic_[at(column)];
    const double way = row < 0 || T_(row, column) > 0 ? direction : -direction;
    if (way > 0 ? value_[y] >= upper_[y] : value_[y] <= lower_[y]) return false;
    Index blocking = -1;
    const double length = ratio_test(column, way, blocking);
    if (std::isinf(length)) {
      move(column, way);  // any point of the ray
      continue;
    }
    move(column, way * length);
    if (blocking >= 0) pivot(blocking, column);
  }
  return beyond();
}

/// How far the column's variable can move, and the row of the basic variable that stops it, or -1 if it meets its own
/// bound.
double BoundedRows::ratio_test(Index column, double direction, Index& blocking) const {
  const Index y = nonbasic_[at(column)];
  double length = direction > 0 ? upper_[y] - value_[y] : value_[y] - lower_[y];
  const double zero = zero_pivot * std::max(1.0, T_.col(column).lpNorm<Eigen::Infinity>());
  for (Index row = 0; row < size(); ++row) {
    const double rate = direction * T_(row, column);
    if (std::abs(rate) <= zero) continue;
    const Index x = basic_[at(row)];
    const double room = rate > 0 ? upper_[x] - value_[x] : value_[x] - lower_[x];
    const double ratio = std::max(0.0, room) / std::abs(rate);
    const bool less = ratio < length || (ratio == length && blocking >= 0 && x < basic_[at(blocking)]);
    if (!less) continue;
    length = ratio;
    blocking = row;
  }
  return length;
}

void BoundedRows::move(Index column, double step) {
  if (step == 0) return;
  value_[nonbasic_[at(column)]] += step;
  for (Index row = 0; row < size(); ++row) value_[basic_[at(row)]] += T_(row, column) * step;
}

/// The row's variable leaves the basis for the column's.
void BoundedRows::pivot(Index row, Index column) {
  const double a = T_(row, column);
  const Vec other = T_.col(column);
  Eigen::RowVectorXd r = T_.row(row) / -a;
  r[column] = 1 / a;
  for (Index j = 0; j < size(); ++j)
    if (j != column && r[j] != 0) T_.col(j) += other * r[j];
  T_.col(column) = other / a;
  T_.row(row) = r;
  std::swap(basic_[at(row)], nonbasic_[at(column)]);
  place_[at(basic_[at(row)])] = row;
  place_[at(nonbasic_[at(column)])] = -1 - column;
}

}  // namespace perp::lcp
