// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/cone_homotopy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/solvers/solve.hpp"

namespace perp::contact {
namespace {

constexpr AssociatedPath associated_path{};
constexpr OpeningPaths opening_paths{};
/// Steps of the splitting that are looked at together.
constexpr int splitting_lot = 25;

/// Slips below tau = 1e-3 do not depend on tau if they are real. Three steps in a row that leave more than 0.7 of the
/// gap |y_T| - s end the path.
class Settling {
 public:
  void see(double tau, double gap) {
    steps_ = tau < 1e-3 && gap > 0.7 * before_ ? steps_ + 1 : 0;
    before_ = gap;
  }
  bool done() const { return steps_ >= 3; }

 private:
  double before_ = std::numeric_limits<double>::infinity();
  int steps_ = 0;
};

}  // namespace

ConeHomotopy::ConeHomotopy(Referee& referee, const Scaled& problem, AlartCurnier& newton, ContactSystem& system)
    : referee_(referee), problem_(problem), newton_(newton), system_(system), path_(problem, system) {}

bool ConeHomotopy::run() { return associated() || (!moves() && openings()) || try_newton({}); }

/// Takes one step of the path. Returns whether it went on and the run is not over.
bool ConeHomotopy::step() {
  if (!path_.step()) return false;
  ++referee_.stats.iterations;
  return !referee_.judge(path_.r(), {.by = Origin::Cones, .tau = path_.tau(), .step = path_.last_step()});
}

bool ConeHomotopy::associated() {
  Settling settling;
  double newton_below = associated_path.newton_tau;
  for (int k = 0; k < associated_path.steps && path_.tau() > associated_path.end && !settling.done(); ++k) {
    if (!step()) break;
    settling.see(path_.tau(), gap());
    if (path_.tau() > newton_below || gap() > associated_path.real_slip * path_.tau()) continue;
    newton_below = path_.tau() / 100;
    if (try_newton({.most = 2, .halvings = 0})) return true;
  }
  return referee_.over();
}

/// Follows paths with openings from nearer and nearer to a solution. Goes back to the associated path's end if the run
/// is not over.
bool ConeHomotopy::openings() {
  const ConePath::Point back = path_.point();
  Splitting splitting(problem_, system_, back.r, back.y);
  double change = opening_paths.change;
  double map = opening_paths.map;
  bool over = false;
  for (int paths = 0; !over && paths < opening_paths.paths && splitting.factor(); ++paths) {
    if (!settle(splitting, change, map)) break;
    const double now = natural_map(problem_, splitting.r());
    change /= 100;
    map = std::min(map, now) / 100;
    over = referee_.over() || with_openings(splitting, now);
  }
  path_.open(back, Vec::Zero(path_.slip().size()));
  return over || referee_.over();
}

/// Takes steps until the run is over, the natural map is at most `map`, or two lots in a row change the openings by at
/// most `change` of the largest. The map says nothing in the first five lots: openings grow from zero. Returns false if
/// the steps are used up or not finite.
bool ConeHomotopy::settle(Splitting& splitting, double change, double map) {
  int& steps = referee_.stats.splitting_steps;
  Vec last = splitting.openings();
  for (int settled = 0; settled < 2;) {
    if (steps >= opening_paths.steps) return false;
    for (int i = 0; i < splitting_lot; ++i, ++steps) {
      if (referee_.over()) return true;
      splitting.step();
    }
    const double now_map = natural_map(problem_, splitting.r());
    if (!std::isfinite(now_map)) return false;
    if (now_map <= 10 * referee_.tol() ? referee_.judge(splitting.r(), {.by = Origin::Cones}) : referee_.over())
      return true;
    if (now_map <= map && steps >= 5 * splitting_lot) return true;
    const Vec now = splitting.openings();
    settled = (now - last).lpNorm<Eigen::Infinity>() <= change * now.lpNorm<Eigen::Infinity>() ? settled + 1 : 0;
    last = now;
    splitting.accelerate();
  }
  return true;
}

/// Follows the path with these openings from near the splitting's point, whose natural map is `map`, to a thousandth of
/// its first tau. Returns whether the run is over.
bool ConeHomotopy::with_openings(const Splitting& splitting, double map) {
  const double tau = std::clamp(opening_paths.start_share * map, 1e-5, 1e-2);
  path_.open(path_.near(splitting.r(), splitting.openings(), tau), splitting.openings());
  for (int k = 0; k < associated_path.steps && path_.tau() > tau / 1000; ++k)
    if (!step()) break;
  return referee_.over() || try_newton({.halvings = 0});
}

/// Tells whether many contacts slip at the end of the associated path.
bool ConeHomotopy::moves() const {
  const auto slipping = (path_.slip().array() > 1e-3).count();
  return static_cast<double>(slipping) > associated_path.most_moving * static_cast<double>(problem_.blocks.size());
}

}  // namespace perp::contact
