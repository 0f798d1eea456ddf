// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/cone_homotopy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace perp::contact {
namespace {

constexpr int most_cone_steps = 40;  // of one path
/// The associated path: its end; the coupled one begins at its first point below `early_tau`.
constexpr double cone_end = 1e-9;
constexpr double early_tau = 1;
/// Below `settled_tau` slip does not depend on tau any more where it is real: so many steps in a row that leave more
/// than `settled_share` of the gap |y_T| - s end a path.
constexpr double settled_tau = 1e-3;
constexpr double settled_share = 0.7;
constexpr int settled_steps = 3;
/// Where more than this part of the contacts slips the pile collapses, and Glocker's homotopy needs fewer steps.
constexpr double most_moving = 0.1;
constexpr double least_slip = 1e-3;

/// The coupled path: two steps below this length in a row say that it turns back.
constexpr double turning_step = 0.15;
constexpr int turning_steps = 2;
constexpr int most_coupled_steps = 25;
/// Cadoux' fixed point: at most so many openings, and so many in a row that leave more than `opening_share` of the
/// least gap. A path begins at the last point with tau above `restart_share` times their change, and ends at this share
/// of the gap.
constexpr int most_openings = 8;
constexpr int opening_patience = 2;
constexpr double opening_share = 0.8;
constexpr double restart_share = 0.1;
constexpr double end_share = 1e-2;
constexpr double largest_end = 1e-5;
constexpr double least_end = 1e-7;

/// Newton steps on Alart & Curnier's equation. Full ones on the way: of the associated path first at `newton_tau` and
/// again when tau has fallen by `newton_tau_again`, of the coupled one, where tau says less, by the natural map.
/// Shortened ones at the end of a path. So many in a row that leave more than `newton_decrease` of the natural map end
/// them.
constexpr double newton_tau = 1e-4;
constexpr double newton_tau_again = 1e-2;
constexpr int quick_newton = 2;
constexpr double newton_map = 0.03;
constexpr double newton_map_again = 0.3;
constexpr int coupled_newton = 6;
constexpr int last_newton = 12;
constexpr double newton_alpha = 1e-10;
constexpr int newton_halvings = 7;
constexpr int newton_patience = 2;
constexpr double newton_decrease = 0.7;

}  // namespace

ConeHomotopy::ConeHomotopy(Referee& referee, const Scaled& problem, AlartCurnier& newton,
                           std::shared_ptr<lcp::SparseLu> lu)
    : referee_(referee), problem_(problem), newton_(newton), path_(problem, std::move(lu)), early_(path_.point()) {}

ConeHomotopy::~ConeHomotopy() { referee_.stats().factorizations += path_.factorizations(); }

bool ConeHomotopy::run() {
  if (associated()) return true;
  if (moves()) return false;
  return coupled() || fixed_point();
}

/// One step of the path; true if it went on, and the run is not over.
bool ConeHomotopy::step() {
  if (!path_.step()) return false;
  ++referee_.stats().iterations;
  return !referee_.judge(path_.r(), {.by = Origin::Cones, .tau = path_.tau(), .step = path_.last_step()});
}

/// The path of the openings, to `until`; whether the run is over.
bool ConeHomotopy::follow(double until) {
  double before = std::numeric_limits<double>::infinity();
  int settled = 0;
  for (int k = 0; k < most_cone_steps && path_.tau() > until && settled < settled_steps; ++k) {
    if (!step()) return referee_.over();
    points_.emplace_back(path_.tau(), path_.point());
    const double now = gap();
    settled = path_.tau() < settled_tau && now > settled_share * before ? settled + 1 : 0;
    before = now;
  }
  return false;
}

bool ConeHomotopy::associated() {
  double before = std::numeric_limits<double>::infinity();
  double at = newton_tau;
  int settled = 0;
  bool early = false;
  for (int k = 0; k < most_cone_steps && path_.tau() > cone_end && settled < settled_steps; ++k) {
    if (!step()) break;
    points_.emplace_back(path_.tau(), path_.point());
    if (!early && path_.tau() < early_tau) {
      early = true;
      early_ = path_.point();
    }
    const double now = gap();
    settled = path_.tau() < settled_tau && now > settled_share * before ? settled + 1 : 0;
    before = now;
    if (path_.tau() > at) continue;
    at = newton_tau_again * path_.tau();
    if (try_newton(path_.r(), quick_newton, 0)) return true;
  }
  return referee_.over() || try_newton(path_.r(), last_newton, newton_halvings);
}

/// Whether many contacts slip at the end of the associated path.
bool ConeHomotopy::moves() const {
  const auto slipping = (path_.slip().array() > least_slip).count();
  return static_cast<double>(slipping) > most_moving * static_cast<double>(problem_.blocks.size());
}

bool ConeHomotopy::coupled() {
  const ConePath::Point associated = path_.point();
  path_.couple(early_);
  double at = newton_map;
  int turning = 0;
  for (int k = 0; k < most_coupled_steps && path_.tau() > cone_end && turning < turning_steps; ++k) {
    if (!step()) break;
    turning = path_.last_step() < turning_step ? turning + 1 : 0;
    const double map = natural_map(problem_, path_.r());
    if (map > at) continue;
    at = newton_map_again * map;
    if (try_newton(path_.r(), coupled_newton, 0)) return true;
  }
  if (referee_.over() || try_newton(path_.r(), last_newton, newton_halvings)) return true;
  path_.open(associated, Vec::Zero(path_.openings().size()));
  return false;
}

/// s = |u_T(s)|.
bool ConeHomotopy::fixed_point() {
  Vec last_image;  // |u_T| of the openings before
  Vec last_gap;
  double least = gap();
  for (int k = 0, since = 0; k < most_openings && since < opening_patience; ++k) {
    const Vec s = path_.openings();
    const Vec image = path_.slip();
    const Vec g = image - s;
    Vec next = image;
    if (last_gap.size() > 0) {
      const Vec change = g - last_gap;
      const double square = change.squaredNorm();
      if (square > 0) next -= g.dot(change) / square * (image - last_image);
      next = next.cwiseMax(0.0);
    }
    last_image = image;
    last_gap = g;
    while (points_.size() > 1 && points_.back().first < restart_share * (next - s).lpNorm<Eigen::Infinity>())
      points_.pop_back();
    if (points_.empty()) return false;
    path_.open(points_.back().second, next);
    if (follow(std::clamp(end_share * g.lpNorm<Eigen::Infinity>(), least_end, largest_end)) ||
        try_newton(path_.r(), last_newton, newton_halvings))
      return true;
    const double now = gap();
    since = now <= opening_share * least ? 0 : since + 1;
    least = std::min(least, now);
  }
  return referee_.over();
}

/// Newton steps from r; whether the run is over.
bool ConeHomotopy::try_newton(Vec r, int most, int halvings) {
  double last = natural_map(problem_, r);
  double lowest = last;
  for (int k = 0, since = 0; k < most && since < newton_patience; ++k) {
    Vec to;
    if (!newton_.step(r, r, newton_alpha, to)) return false;
    ++referee_.stats().newton_steps;
    Vec d = to - r;
    double least = lcp::infinity;
    bool full = true;
    for (int i = 0; i <= halvings && !(least <= newton_decrease * last); ++i, d *= 0.5) {
      const double now = natural_map(problem_, r + d);
      if (!(now < least)) continue;
      least = now;
      full = i == 0;
      to = r + d;
    }
    if (!std::isfinite(least)) return false;
    r = std::move(to);
    last = least;
    if (referee_.judge(r, {.by = full ? Origin::Newton : Origin::DampedNewton, .alpha = newton_alpha})) return true;
    since = last <= newton_decrease * lowest ? 0 : since + 1;
    lowest = std::min(lowest, last);
  }
  return false;
}

}  // namespace perp::contact
