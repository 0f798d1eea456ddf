// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/active_set_step.hpp"

#include <algorithm>
#include <utility>

#include "lcp/linalg/blocks.hpp"

namespace perp::ncp {

using lcp::Cell;

namespace {

/// Chord steps are for more free rows than this: below, a factorization is cheap and its digits are welcome.
constexpr Index dear_rows = 2000;
/// What a chord step must leave at most of the natural residual, as must the step before it.
constexpr double digit = 0.1;

}  // namespace

std::vector<Cell> active_set(const Box& box, const Point& point) {
  std::vector<Cell> active(static_cast<std::size_t>(point.x.size()), Cell::Inside);
  for (Index i = 0; i < point.x.size(); ++i) {
    const double t = point.x[i] - point.F[i];
    if (t <= box.lower[i] || box.lower[i] == box.upper[i])
      active[static_cast<std::size_t>(i)] = Cell::Below;
    else if (t >= box.upper[i])
      active[static_cast<std::size_t>(i)] = Cell::Above;
  }
  return active;
}

/// J_II; false if it is singular.
bool ActiveSetFinish::factor(const SpMat& J) {
  I_.clear();
  for (std::size_t k = 0; k < active_.size(); ++k)
    if (active_[k] == Cell::Inside) I_.push_back(static_cast<Index>(k));
  if (I_.empty()) return true;
  ++run_.stats().factorizations;
  return lu_.factor(lcp::principal_block(J, I_)) == lcp::LuStatus::Ok;
}

/// To the point that the factors lead to.
bool ActiveSetFinish::move(const Point& point, Point& to) {
  const Box& box = run_.box();
  Vec d = Vec::Zero(point.x.size());
  for (Index i = 0; i < d.size(); ++i) {
    const Cell state = active_[static_cast<std::size_t>(i)];
    if (state == Cell::Below) d[i] = box.lower[i] - point.x[i];
    if (state == Cell::Above) d[i] = box.upper[i] - point.x[i];
  }
  if (!I_.empty()) {
    const Vec moved = point.F + point.J * d;
    const Vec rhs = -moved(I_);
    Vec free(rhs.size());
    lu_.solve(rhs, free);
    if (!free.allFinite()) return false;
    d(I_) = free;
  }
  to.x = lcp::project(box, point.x + d);
  return true;
}

/// Whether the natural residual at `to` is at most this share of that at `point`, and F and J are defined there.
bool ActiveSetFinish::falls(const Point& point, double share, Point& to) {
  if (!run_.counted().eval(to.x, to.F)) return false;
  const double before = residual(run_.box(), point.x, point.F).natural;
  const double after = residual(run_.box(), to.x, to.F).natural;
  if (!(after <= share * before) || !run_.counted().jacobian(to.x, to.J)) return false;
  chords_ = after <= digit * before && static_cast<Index>(I_.size()) > dear_rows;
  return true;
}

bool ActiveSetFinish::chord(const Point& point, Point& to) {
  if (!std::exchange(chords_, false) || !move(point, to) || !falls(point, digit, to)) return false;
  ++run_.stats().chord_steps;
  return true;
}

bool ActiveSetFinish::step(const Point& point, Point& to) {
  constexpr double share = 0.5;
  std::vector<Cell> now = active_set(run_.box(), point);
  const bool settled = now == active_;
  active_ = std::move(now);
  chords_ = chords_ && settled;
  if (!chords_) lu_ = lcp::SparseLu(backend_);  // the memory is the path's
  if (!settled || pause_-- > 0) return false;
  const bool stepped = chord(point, to) || (factor(point.J) && move(point, to) && falls(point, share, to));
  pause_ = stepped ? 0 : 1 << std::min(failures_++, 5);
  return stepped;
}

}  // namespace perp::ncp
