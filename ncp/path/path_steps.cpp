// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/path_steps.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lcp/words.hpp"

namespace perp::ncp {
namespace {

/// lambda of the proximal terms tried in turn, relative to the size of J; one that helped shrinks from then on.
constexpr double path_prox_first = 0.1;
constexpr double path_prox_growth = 30;
constexpr double path_prox_decay = 0.1;
constexpr int path_prox_tries = 3;

/// Of a J that stays singular, relative to its size and to ||Phi||: the first after a crash that met it, the share left
/// after an iteration, and the largest left then.
constexpr double path_prox_after_crash = 0.01;
constexpr double path_prox_singular_decay = 0.3;
constexpr double path_prox_singular = 1e-3;
constexpr int often_singular = 2;  // iterations

/// A proximal term that stands in for a path from a singular basis leaves at most this share of the merit.
constexpr double doubtful_falls = 0.1;

/// A term of lambda below this share of the first one tried is dropped.
constexpr double path_prox_least = 0.01;

/// A chord step is kept if it leaves at most this share of the merit.
constexpr double chord_keeps = 0.7;

/// A leap leads to at most this multiple of the largest reference: from much further up few runs come back. It limits
/// Delta to so many times its length.
constexpr double leap_rises = 1e4;
constexpr double leap_distance = 4;

/// The shortest step a watchdog takes.
constexpr double watchdog_least = 1e-3;

/// Shorter steps than this along a way are taken only when no proximal term gives a longer one.
constexpr double least_step = 0.1;

WayTaken taken(const Way& way) { return {.kinks = way.corners(), .on_path = way.kinks().size() > 1}; }

}  // namespace

PathSteps::PathSteps(Run& run, const PathSearch& method, Point& point, CrashEnd crashed, lcp::SharedLu& lu)
    : run_(run),
      method_(method),
      point_(point),
      x_(normal_point(run.box(), point.x, point.F)),
      cells_(run.take_warm_basis()),
      newton_points_(run, method, lu),
      lambda_(method.proximal_perturbation * size_of(point.J) +
              method.proximal_to_residual * residual(run.box(), point.x, point.F).natural),
      psi_(psi(point.x, point.F, x_)),
      references_(method.nms, psi_),
      best_z_(point.x),
      best_psi_(psi_) {
  if (lambda_ > 0 || !method.proximal_adaptive) return;
  doubtful_ = crashed == CrashEnd::Doubtful;
  if (crashed == CrashEnd::Singular) lambda_ = lambda_of_singular();
}

double PathSteps::lambda_of_singular() {
  singular_ = often_singular;
  return lambda_of(path_prox_after_crash, size_of(point_.J));
}

Way PathSteps::way_to(const NewtonPoint& newton) const {
  if (newton.from_ray || method_.search == Searchtype::Line) return Way::line(run_.box(), point_.x, newton.x());
  if (method_.search == Searchtype::Arc) return Way::arc(x_, newton.x());
  std::vector<lcp::Breakpoint> kinks =
      newton_points_.leaves_out_kinks() ? newton_points_.kinks(point_, x_, newton.lambda) : newton.path.path;
  if (kinks.size() < 2) return Way::arc(x_, newton.x());
  return Way::path(x_, std::move(kinks), newton.x(), newton.t());
}

void PathSteps::moved(Point&& to, Vec x, double merit) {
  std::swap(point_, to);
  x_ = std::move(x);
  psi_ = merit;
  cells_.clear();
  if (psi_ < best_psi_) {
    best_psi_ = psi_;
    best_z_ = point_.x;
  }
}

/// Backwards from T = `from` along the way of a linearised problem solved up to t:  T = from, beta from, ...
bool PathSteps::search(const Way& way, double t, double from, double least, Iteration& it) {
  Point& trial = trial_;
  double T = from;
  const double start = psi_;
  for (int k = 0; k <= method_.max_backtracks && T >= least; ++k, T *= method_.beta) {
    Vec x = way.at(T);
    trial.x = lcp::project(run_.box(), x);
    if (trial.x == point_.x) break;
    if (!run_.counted().eval(trial.x, trial.F)) {
      ++undefined_, ++it.backtracks;
      continue;
    }
    const double merit = psi(trial.x, trial.F, x);
    if (!(merit <= references_.largest() - 2 * method_.sigma * T * t * start)) {
      ++it.backtracks;
      continue;
    }
    if (!run_.counted().jacobian(trial.x, trial.J)) {
      ++undefined_, ++it.backtracks;
      continue;
    }
    it.step = taken_.T = T;
    references_.replace_largest(merit);
    unchecked_ = 0;
    saved_.reset();
    if (method_.merit == PathMerit::Fischer) x = normal_point(run_.box(), trial.x, trial.F);
    moved(std::move(trial), std::move(x), merit);
    return true;
  }
  return false;
}

/// From the Newton point x on, with the Jacobian it was made with, as long as that pays.
void PathSteps::follow_chord(const NewtonPoint& newton, Point& trial, Vec& x, double& merit) {
  if (!newton.path.last_piece || newton.lambda > 0) return;
  Point next;
  for (int k = 0; k < method_.chord_steps && merit > 0; ++k) {
    Vec y = x + lcp::chord_step(newton.path, trial.F + x - trial.x);
    next.x = lcp::project(run_.box(), y);
    if (!y.allFinite() || !run_.counted().eval(next.x, next.F)) return;
    const double fallen = psi(next.x, next.F, y);
    if (!(fallen <= chord_keeps * merit)) return;
    trial.x.swap(next.x);
    trial.F.swap(next.F);
    x = std::move(y);
    merit = fallen;
    ++run_.stats().chord_steps;
  }
}

/// The Newton point by its merit (M), by its distance (D), by both (O), or backtracked to (B).
bool PathSteps::accept(const NewtonPoint& newton, double least, Iteration& it) {
  taken_ = run_.shows_ways() ? taken(way_to(newton)) : WayTaken{};
  if (!newton.solved()) {
    it.kind = 'B';
    return search(way_to(newton), newton.t(), 1, least, it);
  }
  Point& trial = trial_;
  trial.x = lcp::project(run_.box(), newton.x());
  const double distance = (trial.x - point_.x).norm();
  bool defined = run_.counted().eval(trial.x, trial.F);
  if (defined) {
    const double merit = psi(trial.x, trial.F, newton.x());
    const bool near = method_.nms.on && distance <= delta_ && unchecked_ + 1 < method_.nms.mstep_frequency &&
                      watchdogs_ <= method_.nms.maximum_watchdogs && std::isfinite(merit);
    const bool falls = merit <= references_.largest() - 2 * method_.sigma * psi_;
    Vec x = newton.x();
    double chord = merit;
    if (near || falls) {
      const Vec z = trial.x;
      const Vec F = trial.F;
      follow_chord(newton, trial, x, chord);
      defined = run_.counted().jacobian(trial.x, trial.J);
      if (!defined && trial.x != z) {  // the Newton point itself may do
        trial.x = z;
        trial.F = F;
        x = newton.x();
        chord = merit;
        defined = run_.counted().jacobian(trial.x, trial.J);
      }
    }
    if (defined && (near || falls)) {
      it.kind = near && falls ? 'O' : falls ? 'M' : 'D';
      it.step = taken_.T = 1;
      if (falls) {
        references_.replace_largest(chord);
        unchecked_ = 0;
        saved_.reset();
      } else {
        ++run_.stats().unchecked_steps;
        if (unchecked_++ == 0) saved_ = Saved{.point = point_, .way = way_to(newton), .t = newton.t(), .psi = psi_};
      }
      delta_ = near ? method_.nms.distance_decrease * delta_ : std::max(delta_, distance);
      const bool by_chord = chord != merit;  // into another cell, perhaps
      moved(std::move(trial), std::move(x), chord);
      if (!by_chord) cells_ = newton.path.cells;
      return true;
    }
  }
  ++it.backtracks;
  if (!defined) ++undefined_;
  if (unchecked_ > 0) return false;  // the watchdog's turn
  it.kind = 'B';
  return search(way_to(newton), 1, method_.beta, least, it) || (least > 0 && leap(newton, it));
}

/// The Newton point, untested (a D-step), where the search has come to nothing: before a proximal term is raised.
bool PathSteps::leap(const NewtonPoint& newton, Iteration& it) {
  if (!method_.nms.on || newton.lambda > lambda_ || watchdogs_ > method_.nms.maximum_watchdogs) return false;
  Point& trial = trial_;
  trial.x = lcp::project(run_.box(), newton.x());
  if (!run_.counted().eval(trial.x, trial.F)) return false;
  const double merit = psi(trial.x, trial.F, newton.x());
  if (!(merit <= leap_rises * references_.largest()) || !run_.counted().jacobian(trial.x, trial.J)) return false;
  it.kind = 'D';
  it.step = taken_.T = 1;
  ++run_.stats().unchecked_steps;
  unchecked_ = 1;
  saved_ = Saved{.point = point_, .way = way_to(newton), .t = newton.t(), .psi = psi_};
  delta_ = leap_distance * (trial.x - point_.x).norm();
  moved(std::move(trial), newton.x(), merit);
  cells_ = newton.path.cells;
  return true;
}

/// To begin with after a step by this one. Where J has been singular more than once it may be so at the solution, too:
/// lambda then stays O(||Phi||) to the end, which keeps the order of Newton's method where ||Phi|| bounds the distance
/// to the solutions (Fan & Yuan 2005). A lambda that had to be raised is needed by more than the singular J.
double PathSteps::lambda_after(double lambda, double size) const {
  if (singular_ >= often_singular) {
    const double smaller = path_prox_singular_decay * lambda;
    return lambda > lambda_ ? smaller : std::min(smaller, lambda_of(path_prox_singular, size));
  }
  const double smaller = path_prox_decay * lambda;
  return smaller > path_prox_least * lambda_of(path_prox_first, size) ? smaller : 0;
}

/// Where the basis of the start is singular, with a proximal term: artificials would pivot for what it does at once.
NewtonPoint PathSteps::without_artificials(double& lambda) {
  NewtonPoint newton = newton_points_.solve(point_, x_, cells_, lambda, Repair::Never);
  if (!newton.not_begun()) return newton;
  lambda = lambda_of_singular();
  return newton_points_.solve(point_, x_, cells_, lambda);
}

/// The same for a quadratic program while the merit falls by it: a program without a solution has no end of such steps.
NewtonPoint PathSteps::doubtful_point(double& lambda) {
  NewtonPoint newton = without_artificials(lambda);
  if (lambda == 0 || newton.stopped() || newton_points_.exhausted()) return newton;
  Vec F;
  const Vec z = lcp::project(run_.box(), newton.x());
  if (newton.solved() && run_.counted().eval(z, F) && psi(z, F, newton.x()) <= doubtful_falls * psi_) return newton;
  doubtful_ = false;
  singular_ = 0;
  lambda = 0;
  return newton_points_.solve(point_, x_, cells_, lambda);
}

/// Linearised problems with growing lambda until one gives a step.
bool PathSteps::newton_step(Iteration& it) {
  const double size = size_of(point_.J);
  double lambda = lambda_;
  for (int i = 0; i <= path_prox_tries; ++i) {
    const bool avoid =
        iterations_ == 1 && lambda == 0 && method_.crash.on && method_.proximal_adaptive && !run_.mcp().is_affine();
    // With a larger lambda a path takes a few pivots, a ray takes them from the other end of the box.
    const Fallback fallback = proximal_start_ && lambda > 0 && i < path_prox_tries ? Fallback::None : Fallback::Rays;
    last_ = doubtful_ ? doubtful_point(lambda)
            : avoid   ? without_artificials(lambda)
                      : newton_points_.solve(point_, x_, cells_, lambda, Repair::Artificials, fallback);
    proximal_start_ = proximal_start_ || (avoid && lambda > 0);
    it.prox = lambda;
    it.linear = last_->letter();
    if (last_->solved()) basis_ = last_->path.cells;
    if (last_->stopped() || newton_points_.exhausted()) return false;
    if (last_->path.certificate.size() > 0 && lambda == 0 && run_.mcp().is_affine() &&
        run_.disprove(last_->path.certificate, "the path of Lemke's method runs off along a ray that certifies it"))
      return false;
    if (!last_->solved() && only_newton()) return false;
    const bool last = i == path_prox_tries || !method_.proximal_adaptive;
    if (last_->usable() && accept(*last_, last ? 0 : least_step, it)) {
      if (lambda > 0) ++run_.stats().proximal_steps;
      lambda_ = lambda_after(lambda, size);
      return true;
    }
    if (unchecked_ > 0 || !method_.proximal_adaptive) return false;
    singular_ += last_->singular && lambda == 0;
    lambda = lambda > 0 ? path_prox_growth * lambda : lambda_of(path_prox_first, size);
    cells_.clear();
  }
  return false;
}

/// Back to the last point that passed a merit test, and a search along its way.
bool PathSteps::watchdog(Iteration& it) {
  if (!saved_) return false;
  ++run_.stats().watchdogs;
  ++watchdogs_;
  Saved saved = std::move(*saved_);
  saved_.reset();
  unchecked_ = 0;
  it.kind = 'W';
  if (run_.shows_ways()) taken_ = taken(saved.way);
  Vec x = normal_point(run_.box(), saved.point.x, saved.point.F);
  moved(std::move(saved.point), std::move(x), saved.psi);
  const Vec from = point_.x;
  const bool found = search(saved.way, saved.t, method_.beta, watchdog_least, it);
  delta_ = found ? (point_.x - from).norm() : 0;
  return found;
}

/// A projected gradient step of the Fischer-Burmeister merit from the best point.
bool PathSteps::gradient_step(Iteration& it) {
  if (gradient_steps_ >= method_.gradient_step_limit) return false;
  if (best_psi_ < psi_) {
    Point best;
    best.x = best_z_;
    if (run_.evaluate(best)) moved(std::move(best), normal_point(run_.box(), best_z_, best.F), best_psi_);
  }
  Linearisation descent;
  linearise(fb_, run_.box(), point_, descent);
  const Vec d = lcp::project(run_.box(), point_.x + descent.cauchy_step()) - point_.x;
  const SearchOutcome found =
      line_search(run_, fb_, Armijo{.sigma = method_.sigma}, d, descent.gradient.dot(d), descent.merit, true, point_);
  it.backtracks += found.backtracks;
  undefined_ += found.undefined;
  if (!found.found) return false;
  it.kind = 'G';
  it.step = found.t;
  it.prox = 0;
  ++gradient_steps_;
  x_ = normal_point(run_.box(), point_.x, point_.F);
  cells_.clear();
  psi_ = psi(point_.x, point_.F, x_);
  best_psi_ = std::min(best_psi_, psi_);
  best_z_ = point_.x;
  references_.reset(psi_);
  unchecked_ = 0;
  saved_.reset();
  return true;
}

bool PathSteps::iterate(Iteration& it) {
  undefined_ = 0;
  ++iterations_;
  it = {.k = it.k + 1, .normal_map = true};
  const bool found = newton_step(it) || (may_go_on() && (watchdog(it) || gradient_step(it)));
  it.pivots = newton_points_.take_pivots();
  it.merit = psi_;
  if (!found || it.kind == 'G') taken_.T = 0;
  if (run_.shows_ways()) it.way = &taken_;
  if (!found) explain(it);
  return found;
}

/// The verdict when no step was found.
void PathSteps::explain(const Iteration& it) {
  if (last_->stopped()) return;  // the run says so
  if (newton_points_.needed() > 0)
    run_.end(Status::IterationLimit,
             "the next path would take some " + quantity(newton_points_.needed(), "pivot") + ", and " +
                 std::to_string(newton_points_.left()) + " are left",
             "raise cumulative_iteration_limit");
  else if (newton_points_.exhausted())
    run_.end(Status::IterationLimit, "the limit of pivots in all attempts was reached",
             "raise cumulative_iteration_limit");
  else if (undefined_ > 0 && undefined_ == it.backtracks)
    run_.end(Status::EvaluationFailed, "F or its Jacobian is not defined at any trial point, however short the step",
             "try another start, or bounds that keep the iterates inside the domain");
  else if (!last_->usable())
    run_.end(Status::SubproblemFailed,
             "the linearised problem could not be solved (" + std::string(lcp::to_string(last_->path.end)) + ")" +
                 (last_->lambda > 0 ? ", with proximal terms up to " + number(last_->lambda) + " neither" : ""),
             "try another start");
  else
    run_.end(Status::NoProgress,
             method_.gradient_step_limit > 0 ? "neither the Newton steps nor the gradient decrease the merit function"
                                             : "the Newton steps do not decrease the merit function",
             "try another start");
}

}  // namespace perp::ncp
