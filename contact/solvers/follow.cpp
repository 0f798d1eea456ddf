// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/follow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "contact/classics/alart_curnier.hpp"
#include "contact/classics/gauss_seidel.hpp"
#include "contact/cones/cone_path.hpp"
#include "contact/solvers/follow_system.hpp"

namespace perp::contact {
namespace {

using Block = Eigen::Matrix3d;
using Eigen::Vector3d;

/// Speeds and parts of the largest impulse below this are none. A contact that stuck in the last step, with its impulse
/// so near the border of its cone, is taken to stick in the first Newton step: the equation does not tell there. So
/// small an impulse begins with 0: otherwise the contact is open in one Newton step and closed in the next.
constexpr double negligible = 1e-6;
/// Points above this natural map, in units of the largest impulse where that is above 1, are not judged.
constexpr double worth_judging = 1e-5;
/// Below this map the states of contacts near others decide, and settle by themselves: Newton steps are full, sweeps go
/// on, and Newton steps are tried from a path.
constexpr double settled_map = 1e-4;
/// Newton steps from sweeps and paths, tried again when the map has fallen by `newton_again`.
constexpr int newton_on_the_way = 3;
constexpr double newton_again = 0.01;

struct Following {
  int steps = 10;
  int patience = 3;       ///< steps in a row that do not bring the natural map below `decrease` times the least
  double decrease = 0.9;  ///< of the lengths 1, 1/2, .. the first that brings the map so far counts, else the best
  int halvings = 5;
  int last_steps = 6;  ///< steps from sweeps and paths go on to so many while each counts as a held one would
};
constexpr Following following{};

/// Steps with the factors of the last one and with states that are held.
struct HeldSteps {
  double decrease = 0.1;   ///< of the natural map, if the step is to count
  double after = 1.0 / 3;  ///< they follow steps that brought the map so far: elsewhere states still change
};
constexpr HeldSteps held_steps{};

struct FollowSweeps {
  int most = 400;
  int lot = 4;                       ///< sweeps between two looks
  double contraction = 0.5;          ///< of the change of r from lot to lot; slower sweeps end
  double settled_contraction = 0.9;  ///< the same below `settled_map`: the rest costs less than to begin again
  double few_lots = 3;               ///< to the solution; if more are left Newton steps are tried
};
constexpr FollowSweeps follow_sweeps{};

struct FollowPaths {
  int steps = 25;           ///< of one path
  int factorizations = 60;  ///< of all, those of two cold starts
  double end = 1e-16;       ///< tau: at a degenerate solution the natural map is its root
  double turning = 0.1;     ///< two steps in a row below this length say that a path turns back
  Index rows = 6000;        ///< in more LU takes too long
};
constexpr FollowPaths follow_paths{};
/// First products of the paths, in units of the natural map times the largest impulse.
constexpr std::array path_starts{10.0, 1e3, 1e5, 0.1};

NewtonRows sticking_rows(int size, const Vector3d& u) {
  NewtonRows rows;
  rows.B.topLeftCorner(size, size).setIdentity();
  rows.c = -u;
  return rows;
}

/// Those of Alart & Curnier's equation as if it said this state; of a slipping contact only where it does not say
/// stick.
NewtonRows rows_in(State state, int size, const Vector3d& r, const Vector3d& u, double rho_N, double rho_T) {
  if (state == State::Stick) return sticking_rows(size, u);
  Vector3d r_held = r;
  Vector3d u_held = u;
  if (state == State::Open) {
    r_held[0] = -1;
    u_held[0] = 0;
  } else {
    u_held[0] = std::min(u[0], r[0] / (2 * rho_N));
  }
  NewtonRows rows = alart_curnier_rows(size, r_held, u_held, rho_N, rho_T);
  rows.c[0] = state == State::Open ? -r[0] / rho_N : -u[0];
  return rows;
}

bool may_be_solved(double map, In r) { return map <= worth_judging * std::max(1.0, r.lpNorm<Eigen::Infinity>()); }

/// Lots of sweeps that bring the map down to what is mostly judged a solution, each of them by this factor; from
/// a point that has been refused there, to a tenth.
double lots_left(double map, In r, double contraction) {
  const double wanted = std::min(1e-8 * std::max(1.0, r.lpNorm<Eigen::Infinity>()), map / 10);
  return contraction < 1 ? std::log(map / wanted) / -std::log(contraction) : lcp::infinity;
}

void open_what_carries_nothing(const Scaled& problem, Vec& r) {
  const double largest = r.lpNorm<Eigen::Infinity>();
  for (const Scaled::Block& block : problem.blocks)
    if (block.of(r).norm() <= negligible * largest) r.segment(block.first, block.size).setZero();
}

}  // namespace

Follower::Follower(Stats& stats) : stats_(stats) {}
Follower::~Follower() = default;

const Scaled& Follower::take(const Problem& problem) {
  if (kept_ && kept_->is_of(problem))
    kept_->take(problem);
  else
    kept_ = std::make_unique<FollowSystem>(problem, kept_.get());
  return kept_->problem();
}

/// The full Newton step from r. Contacts that carry at most `margin` are open.
bool Follower::direction(In r, FollowStep& step, bool first, double margin) {
  FollowSystem& kept = *kept_;
  const double largest = r.lpNorm<Eigen::Infinity>();
  const auto rows_of = [&](std::size_t a, const Vector3d& r_a, const Vector3d& u_a) {
    const auto i = static_cast<Index>(a);
    const bool border = r_a[0] - r_a.tail<2>().norm() <= negligible * largest;
    const bool stuck = a < stuck_.size() && stuck_[a] != 0 && r_a[0] > 0;
    if (first && border && stuck) return sticking_rows(kept.problem().blocks[a].size, u_a);
    if (r_a[0] - kept.rho().N[i] * u_a[0] <= margin)
      return rows_in(State::Open, kept.problem().blocks[a].size, r_a, u_a, kept.rho().N[i], kept.rho().T[i]);
    return alart_curnier_rows(kept.problem().blocks[a].size, r_a, u_a, kept.rho().N[i], kept.rho().T[i]);
  };
  NewtonSystem system = newton_system(kept.problem(), rows_of, r, kept.problem().W * r + kept.problem().q);
  step.rows = std::move(system.rows);
  step.c = std::move(system.c);
  if (!kept.factor(r, step, stats_.factorizations)) return false;
  kept.solve(r, step, first);
  ++stats_.newton_steps;
  return step.d.allFinite();
}

/// Goes from x by a full step with the factors that are there, each contact held in the state that it has in them: the
/// equation closes contacts that touch without impulses, and opens others, for what the last step has left. Whether the
/// natural map, `last` at x, falls far.
bool Follower::held_step(Vec& x, double& last, bool first) {
  FollowSystem& kept = *kept_;
  if (kept.factored().empty()) return false;
  bool same = true;
  const auto rows_of = [&](std::size_t a, const Vector3d& r_a, const Vector3d& u_a) {
    const auto i = static_cast<Index>(a);
    const int size = kept.problem().blocks[a].size;
    const State state = state_of(kept.factored()[a], size);
    NewtonRows rows = rows_in(state, size, r_a, u_a, kept.rho().N[i], kept.rho().T[i]);
    same = same && state_of(rows, size) == state;
    return rows;
  };
  NewtonSystem system = newton_system(kept.problem(), rows_of, x, kept.problem().W * x + kept.problem().q);
  if (!same) return false;
  FollowStep step{.rows = std::move(system.rows), .c = std::move(system.c)};
  ++stats_.newton_steps;
  if (!kept.solve(x, step, first)) return false;
  const Vec to = x + step.d;
  const double map = natural_map(kept.problem(), to);
  if (!(map <= held_steps.decrease * last)) return false;
  x = to;
  last = map;
  return true;
}

/// Sweeps of Gauss-Seidel while they contract, and Newton steps where contacts have their states; whether r is accepted
/// then.
bool Follower::sweep(Vec& r, const Accept& accept, const Stop& stop) {
  const Scaled& problem = kept_->problem();
  const GaussSeidel method(problem);
  Vec u = problem.W * r + problem.q;
  double before = lcp::infinity;  // change of r in the last lot
  double newton_below = worth_judging;
  for (int k = 0; k < follow_sweeps.most; k += follow_sweeps.lot) {
    if (stop()) return false;
    const Vec last = r;
    for (int i = 0; i < follow_sweeps.lot; ++i) method.sweep(r, u);
    stats_.sweeps += follow_sweeps.lot;
    const double map = natural_map(problem, r);
    if (may_be_solved(map, r) && accept(r, Origin::Sweeps)) return true;
    const double change = (r - last).norm();
    if (k > 0 && map <= newton_below && lots_left(map, r, change / before) > follow_sweeps.few_lots) {
      newton_below = newton_again * map;
      Vec to = r;
      if (newton(to, {.most = newton_on_the_way}, accept, stop)) {
        r = std::move(to);
        return true;
      }
    }
    if (!(change <= (map <= settled_map ? follow_sweeps.settled_contraction : follow_sweeps.contraction) * before))
      return false;
    before = change;
  }
  return false;
}

/// Goes from x by a Newton step, as long as the natural map asks for, which is `last` at x. Where a full step has made
/// it larger, the equation has closed contacts that hardly carry anything. Then another counts if it is better, where
/// these are open.
bool Follower::newton_step(Vec& x, double& last, bool first, const Stop& stop) {
  FollowStep step;
  if (!direction(x, step, first, 0)) return false;
  const double enough = last <= settled_map ? lcp::infinity : following.decrease * last;
  double least = lcp::infinity;
  Vec to = x;
  const auto try_step = [&] {
    const Vec trial = x + step.d;
    const double now = natural_map(kept_->problem(), trial);
    if (!(now < least)) return;
    least = now;
    to = trial;
  };
  for (int i = 0; i <= following.halvings && !(least < enough); ++i, step.d *= 0.5) try_step();
  if (!std::isfinite(least)) return false;
  if (last <= settled_map && least > last) {
    if (stop() || !direction(x, step, first, std::max(last, negligible * x.lpNorm<Eigen::Infinity>()))) return false;
    try_step();
  }
  x = std::move(to);
  last = least;
  return true;
}

/// Newton steps from r, which becomes the best point met; whether it is accepted. Others than the first of a problem
/// may be some more.
bool Follower::newton(Vec& r, NewtonSteps steps, const Accept& accept, const Stop& stop) {
  Vec x = r;
  double last = natural_map(kept_->problem(), x);
  double lowest = last;
  bool settled = true;
  for (int k = 0, since = 0; k < steps.most && since < following.patience; ++k) {
    if (stop()) return false;
    const bool first = steps.first && k == 0;
    const double before = last;
    const bool held = settled && held_step(x, last, first);
    if (!held && (steps.held || !newton_step(x, last, first, stop))) return false;
    settled = last <= held_steps.after * before;
    if (may_be_solved(last, x) && accept(x, Origin::Newton)) {
      r = x;
      return true;
    }
    if (!steps.first && k + 1 == steps.most && k + 1 < following.last_steps && last <= held_steps.decrease * before)
      ++steps.most;
    ++since;
    if (last > following.decrease * lowest) continue;
    lowest = last;
    r = x;
    since = 0;
  }
  return false;
}

/// The path of Coulomb's law over the cones from near r, with this product; whether r, a point of it, is accepted.
bool Follower::path(Vec& r, double tau, int last_factorization, const Accept& accept, const Stop& stop) {
  FollowSystem& kept = *kept_;
  ConePath path(kept.problem(), kept.give());
  path.couple(path.near(r, Vec::Zero(static_cast<Index>(kept.problem().blocks.size())), tau));
  double newton_below = settled_map;
  for (int k = 0, turning = 0; k < follow_paths.steps && turning < 2 && path.tau() > follow_paths.end; ++k) {
    if (stop() || stats_.factorizations >= last_factorization) return false;
    kept.give();  // Newton steps have made factors of their own
    ++stats_.factorizations;
    ++stats_.iterations;
    if (!path.step()) return false;
    turning = path.last_step() < follow_paths.turning ? turning + 1 : 0;
    const double map = natural_map(kept.problem(), path.r());
    r = path.r();
    if (may_be_solved(map, r) && accept(r, Origin::Cones)) return true;
    if (map > newton_below) continue;
    newton_below = newton_again * map;
    if (newton(r, {.most = newton_on_the_way}, accept, stop)) return true;
  }
  return false;
}

/// From each of the starts; where none led to a solution in the last step that needed them, from the first alone.
bool Follower::paths(Vec& r, const Accept& accept, const Stop& stop) {
  const Scaled& problem = kept_->problem();
  if (problem.size() > follow_paths.rows) return false;
  const double unit = natural_map(problem, r) * std::max(1.0, r.lpNorm<Eigen::Infinity>());
  const std::size_t starts = paths_fail_ ? 1 : path_starts.size();
  const int last_factorization = stats_.factorizations + follow_paths.factorizations;
  for (std::size_t k = 0; k < starts; ++k) {
    Vec to = r;
    const bool found = path(to, path_starts[k] * unit, last_factorization, accept, stop);
    if (!found && stop()) return false;  // which says nothing of the paths
    paths_fail_ = !found;
    if (!found) continue;
    r = std::move(to);
    return true;
  }
  return false;
}

/// Sweeps before new factors where they solved the last step, and the paths last.
bool Follower::attempt(Vec& r, const Accept& accept, const Stop& stop) {
  const Vec start = r;
  const auto by_sweeps = [&] {
    Vec to = r;
    const bool found = sweep(to, accept, stop);
    if (!found && stop()) return false;
    sweeps_first_ = found;
    if (found) r = std::move(to);
    return found;
  };
  const bool swept = sweeps_first_;
  if (swept && newton(r, {.most = following.steps, .first = true, .held = true}, accept, stop)) return true;
  const Vec swept_from = r;
  if (swept && by_sweeps()) return true;
  if (newton(r, {.most = following.steps, .first = true}, accept, stop)) return true;
  if (!(swept && r == swept_from) && by_sweeps()) return true;
  r = start;
  return paths(r, accept, stop);
}

/// Which contacts stick at r, wherever in their cones.
void Follower::remember(In r) {
  const Scaled& problem = kept_->problem();
  const Vec u = problem.W * r + problem.q;
  const double largest = r.lpNorm<Eigen::Infinity>();
  stuck_.assign(problem.blocks.size(), 0);
  for (std::size_t a = 0; a < stuck_.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    stuck_[a] = block.of(u).norm() <= negligible && r[block.first] > negligible * largest ? 1 : 0;
  }
}

std::optional<Vec> Follower::from(In start, const Accept& accept, const Stop& stop) {
  Vec r = start;
  if (natural_map(kept_->problem(), r) <= worth_judging && accept(r, Origin::WarmStart)) return r;
  open_what_carries_nothing(kept_->problem(), r);
  if (!attempt(r, accept, stop)) return std::nullopt;
  remember(r);
  return r;
}

}  // namespace perp::contact
