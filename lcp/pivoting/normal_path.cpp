// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/normal_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/judge/result.hpp"

namespace perp::lcp {
void NormalPath::set_interval(Index i) {
  const Cell c = cells_[at(i)];
  low_[i] = c == Cell::Inside ? problem_.box.lower[i] : c == Cell::Above ? problem_.box.upper[i] : -infinity;
  high_[i] = c == Cell::Inside ? problem_.box.upper[i] : c == Cell::Below ? problem_.box.lower[i] : infinity;
}

/// Factors the present basis afresh and recomputes the basic unknowns from the equations, which removes drift.
bool NormalPath::refactor() {
  distrusted_ = true;  // stays so where the basis is singular: nothing may be solved with it
  if (factor_basis() != LuStatus::Ok) return false;
  distrusted_ = false;
  Vec rhs = constant() + scale_ * Vec(A_.col(n_));  // G(x) = r - tau (r / s)
  const auto take = [&](Index i) {
    if (value(i) == 0) return;
    if (const Index j = column(i); j > n_)
      rhs[j - n_ - 1] -= value(i);
    else
      rhs -= value(i) * A_.col(j);
  };
  take(driver_);
  for (const Index i : waiting_)
    if (i != none) take(i);
  Vec y(n_);
  factor_.ftran(rhs, y);
  if (!y.allFinite()) return false;
  for (Index p = 0; p < n_; ++p)
    if (const Index i = head(p); !artificial(i)) (i == n_ ? tau_ : x_[i]) = y[p];
  return true;
}

/// d for the driver. False if the basis is singular.
bool NormalPath::drive() {
  if ((distrusted_ || factor_.stale()) && !refactor()) return false;
  factor_.ftran_column(column(driver_), d_);
  d_largest_ = d_.largest();
  return std::isfinite(d_largest_);
}

void NormalPath::set_column_largest() {
  column_largest_ = Vec::Zero(n_);
  for (Index j = 0; j < n_; ++j)
    for (SpMat::InnerIterator it(A_, j); it; ++it)
      column_largest_[j] = std::max(column_largest_[j], std::abs(it.value()));
}

/// Whether the rate of t is more than the rounding of d: with dt = 0 the equation  sum a_i dx_i + r dt = 0  of the
/// segment has the residual r dt, which is compared with the terms of the sum. On the ray of an infeasible
/// copositive-plus problem dt is zero (Cottle, Pang & Stone 1992, section 4.4).
bool NormalPath::t_moves(double rate) {
  if (rate == 0) return false;
  constexpr double rounding = 1e-12;
  // Most rates are far from this: then bounds of the largest sum will do.
  if (column_largest_.size() == 0) set_column_largest();
  double least = column_largest(driver_);
  double most = least;
  d_.for_each([&](Index p, double v) {
    if (head(p) == n_) return;
    const double largest = std::abs(v) * column_largest(head(p));
    least = std::max(least, largest);
    most += largest;
  });
  if (std::abs(rate) <= rounding * least) return false;
  if (std::abs(rate) > 2 * rounding * most) return true;
  Vec terms = Vec::Zero(n_);
  const auto add = [&](Index i, double v) {
    if (const Index j = column(i); j > n_)
      terms[j - n_ - 1] += std::abs(v);
    else
      for (SpMat::InnerIterator it(A_, j); it; ++it) terms[it.row()] += std::abs(v * it.value());
  };
  add(driver_, 1);
  d_.for_each([&](Index p, double v) {
    if (head(p) != n_) add(head(p), v);
  });
  return std::abs(rate) > rounding * terms.maxCoeff();  // ||r / s|| = 1
}

/// How far unknown i may go at this rate, without tolerance.
double NormalPath::room(Index i, double rate) const {
  const double bound = rate > 0 ? high(i) : low(i);
  return std::isinf(bound) ? infinity : std::max(0.0, rate > 0 ? bound - value(i) : value(i) - bound);
}

/// Harris' two passes: the longest step with every bound relaxed by the tolerance; then, of the unknowns that block by
/// then, t if it is among them, else an artificial, else the largest pivot.
NormalPath::Block NormalPath::ratio_test() {
  candidates_.clear();
  double longest = infinity;
  const double smallest = options_.pivot_tol * std::max(1.0, d_largest_);
  d_.for_each([&](Index p, double v) {
    const double rate = -direction_ * v;
    const Index i = head(p);
    // t = 1 is the end: no basis has to be built on its pivot, however small.
    if (std::abs(rate) <= smallest && !(i == n_ && t_moves(rate))) return;
    const double bound = rate > 0 ? high(i) : low(i);
    if (std::isinf(bound)) return;
    const double distance = std::max(0.0, rate > 0 ? bound - value(i) : value(i) - bound);
    if (distance > longest * std::abs(rate)) return;  // beyond the longest step, and no shorter one with the tolerance
    const double ratio = distance / std::abs(rate);
    candidates_.push_back({p, ratio});
    longest = std::min(longest, ratio + options_.feasibility_tol * (1 + std::abs(bound)) / std::abs(rate));
  });
  const auto rank = [this](Index i) { return i == n_ ? 2 : artificial(i) ? 1 : 0; };
  Block block;
  for (const Block& candidate : candidates_) {
    if (candidate.step > longest) continue;
    const Index i = head(candidate.position);
    const Index other = block.position == none ? none : head(block.position);
    if (other == none || rank(i) > rank(other) ||
        (rank(i) == rank(other) && std::abs(d_[candidate.position]) > std::abs(d_[block.position])))
      block = candidate;
  }
  return block;
}

/// A pivot so small that the digits of d may not carry it, though a fresh factorization could tell.
bool NormalPath::doubtful(const Block& block) const {
  return block.position != none && head(block.position) != n_ && factor_.updates() > 0 &&
         std::abs(d_[block.position]) < options_.doubtful_pivot * d_largest_;
}

/// Whether the digits of d do carry this pivot: a step of refinement changes d by a small part of it. That takes a
/// solve, where a factorization and a second ratio test take ten.
bool NormalPath::accurate(const Block& block) const {
  constexpr double small_part = 1e-3;
  Vec a = Vec::Zero(n_);
  if (const Index j = column(driver_); j > n_)
    a[j - n_ - 1] = 1;
  else
    a = A_.col(j);
  Vec correction(n_);
  factor_.ftran(factor_.residual(a, d_.values()), correction);
  return correction.lpNorm<::Eigen::Infinity>() <= small_part * std::abs(d_[block.position]);
}

void NormalPath::step(double length) {
  const double by = -direction_ * length;
  d_.for_each([&](Index p, double v) { move(head(p), by * v); });
  move(driver_, direction_ * length);
}

void NormalPath::end_on_ray(PivotResult& result) {
  result.end = PivotEnd::Ray;
  result.ray = Vec::Zero(n_);
  d_.for_each([&](Index p, double v) {
    if (const Index i = head(p); i < n_) result.ray[i] = -direction_ * v;
  });
  if (driver_ < n_) result.ray[driver_] = direction_;
  Vec dz = Vec::Zero(n_);
  for (Index i = 0; i < n_; ++i) {
    result.ray[i] *= inside(i) ? scaling_.columns[i] : 1 / scaling_.rows[i];
    if (inside(i)) dz[i] = result.ray[i];
  }
  const double size = n_ > 0 ? dz.lpNorm<::Eigen::Infinity>() : 0;
  if (!(size > 0) || !options_.certify) return;
  // y = dz: copositive-plus M has (M + M') dz = 0.
  result.certificate = exact_certificate(original_, dz / size, options_.residual_tol);
}

bool NormalPath::advance(PivotResult& result) {
  if (!std::exchange(driven_, false) && !drive()) {
    result.end = PivotEnd::SingularBasis;
    return false;
  }
  Block block = ratio_test();
  if (doubtful(block) && !accurate(block)) {
    if (!refactor() || !drive()) {
      result.end = PivotEnd::SingularBasis;
      return false;
    }
    block = ratio_test();
  }
  const double own = room(driver_, direction_);
  const bool driver_blocks = own <= block.step;
  const double length = driver_blocks ? own : block.step;
  if (std::isinf(length)) {
    if (take_other_branch()) return true;
    end_on_ray(result);
    return false;
  }
  step(length);
  ++result.pivots;
  if (tau_ > best_tau_) {
    best_tau_ = tau_;
    best_x_ = x_;
    pivots_at_best_ = result.pivots;
  }

  if (driver_blocks) {  // the driver crosses its cell: no change of basis but in its own column
    if (driver_ == n_) {
      tau_ = scale_;
      return false;
    }
    cross(driver_, direction_);
    return !back_at_start(result);
  }
  const Index blocking = head(block.position);
  const double onward = -direction_ * d_[block.position] > 0 ? 1 : -1;
  enter(block.position);
  driver_ = blocking;
  direction_ = onward;
  if (blocking == n_) {
    tau_ = scale_;
    return false;
  }
  if (artificial(blocking)) {
    leave_artificial(blocking - n_ - 1);
    return true;
  }
  cross(blocking, onward);
  return !back_at_start(result);
}

/// The variable that waited for the artificial of this row drives on, so that t grows; if t stays, towards its nearer
/// bound. Another path begins here.
void NormalPath::leave_artificial(Index row) {
  driver_ = std::exchange(waiting_[at(row)], none);
  direction_ = x_[driver_] - low_[driver_] < high_[driver_] - x_[driver_] ? -1 : 1;
  start_ = cells_;
  away_ = 0;
  driven_ = drive();
  if (!driven_) return;  // the next advance() says so
  bool undecided = true;
  for (Index p = 0; p < n_; ++p)
    if (head(p) == n_ && t_moves(d_[p])) {
      direction_ = d_[p] > 0 ? -1 : 1;
      undecided = false;
    }
  fork_.reset();
  if (undecided)
    fork_ = {.x = x_,
             .low = low_,
             .high = high_,
             .tau = tau_,
             .cells = cells_,
             .head = head_,
             .waiting = waiting_,
             .driver = driver_,
             .other_direction = -direction_};
}

/// Back to the last fork, if there is one, and on along its other branch.
bool NormalPath::take_other_branch() {
  if (!fork_) return false;
  const Fork fork = *std::exchange(fork_, std::nullopt);
  x_ = fork.x;
  low_ = fork.low;
  high_ = fork.high;
  tau_ = fork.tau;
  cells_ = fork.cells;
  head_ = fork.head;
  waiting_ = fork.waiting;
  driver_ = fork.driver;
  direction_ = fork.other_direction;
  start_ = cells_;
  away_ = 0;
  driven_ = false;
  distrusted_ = true;  // the factors are those of the other branch
  return true;
}

/// A path from a rank-deficient start need not be in general position: there, t that has not grown for long always
/// counts too.
bool NormalPath::back_at_start(PivotResult& result) {
  const Index patience = result.repaired > 0 ? std::min<Index>(options_.patience, 50 + 2 * n_) : options_.patience;
  const bool wanders = result.pivots - pivots_at_best_ > patience;
  if (away_ > 0 && !wanders) return false;
  result.end = PivotEnd::Loop;
  return true;
}

/// The driver's column takes position p.
void NormalPath::enter(Index p) {
  head(p) = driver_;
  distrusted_ = factor_.replace(p, column(driver_), d_) != BasisFactor::Update::Ok;
}

/// x_i passes from its cell into the next one in its direction.
void NormalPath::cross(Index i, double direction) {
  Cell& cell = cells_[at(i)];
  const Cell home = start_[at(i)];
  if (cell == home) ++away_;
  if (cell == Cell::Inside) {
    x_[i] = direction > 0 ? problem_.box.upper[i] : problem_.box.lower[i];
    cell = direction > 0 ? Cell::Above : Cell::Below;
  } else {
    x_[i] = cell == Cell::Below ? problem_.box.lower[i] : problem_.box.upper[i];
    cell = Cell::Inside;
  }
  set_interval(i);
  if (cell == home) --away_;
}

}  // namespace perp::lcp
