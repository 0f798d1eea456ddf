// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "lcp/iterative/interior_path.hpp"
#include "lcp/linalg/quasi_definite.hpp"
#include "ncp/methods/active_set_step.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// Reductions of a step for the neighbourhood, by 0.8 each.
constexpr int neighbourhood_cuts = 6;
constexpr double cut = 0.8;
/// Halvings for the domain of F and the growth of the residual.
constexpr int max_halvings = 20;
/// A step below this is none.
constexpr double vanishing_step = 1e-8;
/// Starts tried, mu falling by 16.
constexpr int most_starts = 20;
/// Weight of the proximal term.
constexpr double proximal = 1e-14;
/// Products of the square of this share of the natural residual are small enough: smaller ones at the same residual
/// would lead along the bounds.
constexpr double share_of_residual = 0.03;

using lcp::InteriorPath;

class InteriorRun {
 public:
  InteriorRun(Run& run, const InteriorPoint& method, Point point);
  void run();

 private:
  using Iterate = InteriorPath::Iterate;

  bool start();
  bool open_here(double tau);
  bool open(const Vec& z, const Vec& t, double mu, double most_residual);
  void follow_equations();
  bool follow();
  void linearise();
  double residual(const Iterate& x, const Point& point) const { return path_.residual(x, point.F).norm(); }
  double natural() const { return ncp::residual(run_.box(), point_.x, point_.F).natural; }
  double merit() const;
  bool central(const Iterate& x) const;
  bool advance(const Iterate& d);
  bool step();
  bool finish();
  bool raise_tau();
  void give_up();

  Run& run_;
  const InteriorPoint& method_;
  Point point_;
  SpMat J_;  // with a full diagonal
  InteriorPath path_;
  std::optional<Point> left_;  // the interior point that active-set steps began from
  Iteration it_;
  int undefined_ = 0;
  ActiveSetFinish finish_;
  int raises_ = 0;
  int factorizations_ = 0;
  bool singular_ = false;
};

InteriorRun::InteriorRun(Run& run, const InteriorPoint& method, Point point)
    : run_(run),
      method_(method),
      point_(std::move(point)),
      J_(lcp::with_diagonal(point_.J)),
      path_(J_, run.box(), false, method.to_boundary, proximal, method.lu),
      finish_(run, method.lu) {}

/// Opens the path by the size of the linearisation at the start, where that leads to no larger residuals than it comes
/// from, or than the products; else by the start itself. False: F or J is defined at no point tried.
bool InteriorRun::start() {
  const Vec z = path_.nearest(point_.x, point_.F);
  const Vec t = path_.halves(z, point_.F + J_ * (z - point_.x));
  const double mean = path_.pairs() > 0 ? t.squaredNorm() / static_cast<double>(path_.pairs()) : 0;
  const double mu = mean > 0 && std::isfinite(mean) ? mean : 1;
  const double size = point_.F.norm();
  return open(z, t, mu, size) || open(point_.x, path_.halves(point_.x, point_.F), mu, size) || open_here(1);
}

/// Moves the point inside by up to 1 and gives it multipliers w >= F, where that makes the row feasible, and products
/// of tau or more; at least of the mean times the root of the neighbourhood's width, halfway from its border to the
/// centre: steps would be tiny until those on the border have grown.
bool InteriorRun::open_here(double tau) {
  const Vec from = point_.x;
  Iterate& at = path_.x;
  double margin = std::min(1.0, tau);
  for (int k = 0; k < most_starts; ++k, margin /= 4) {
    path_.open_inside(from, margin);
    point_.x = at.z;
    if (!run_.evaluate(point_)) {
      ++undefined_;
      continue;
    }
    for (Index p = 0; p < path_.pairs(); ++p) {
      const auto& b = path_.bounds()[static_cast<std::size_t>(p)];
      at.w[p] = std::max(b.sign * point_.F[b.i], tau / std::max(1.0, at.s[p]));
    }
    const double least = std::sqrt(method_.neighbourhood) * path_.gap(at);
    at.w = at.w.cwiseMax(least * at.s.cwiseInverse());
    return true;
  }
  return false;
}

/// Goes on centrally from z with products mu, or less where F or J is not defined.
bool InteriorRun::open(const Vec& z, const Vec& t, double mu, double most_residual) {
  for (int k = 0; k < most_starts; ++k, mu /= 16) {
    path_.open_centrally(z, t, mu);
    Point to;
    to.x = lcp::project(run_.box(), path_.x.z);
    if (!run_.evaluate(to)) {
      ++undefined_;
      continue;
    }
    if (residual(path_.x, to) > method_.growth * std::max(path_.gap(path_.x), most_residual)) break;
    point_ = std::move(to);
    follow_equations();
    return true;
  }
  return false;
}

/// Moves the free variables to where a Newton step solves their equations, the others held, if it does halve what these
/// leave: v = sum x is no longer so where all x have moved inside.
void InteriorRun::follow_equations() {
  const auto left = [&](const Point& at) {
    double sum = 0;
    for (Index i = 0; i < at.F.size(); ++i)
      if (run_.box().is_free(i)) sum += at.F[i] * at.F[i];
    return std::sqrt(sum);
  };
  const double size = left(point_);
  Vec dz(point_.x.size());
  if (size == 0) return;
  linearise();
  if (!path_.step_of_free(point_.F, dz)) return;
  Point to;
  to.x = point_.x + dz;
  if (!run_.evaluate(to) || !(left(to) < size / 2)) return;
  point_ = std::move(to);
  path_.x.z += dz;
}

/// Sets J_ to J at the point.
void InteriorRun::linearise() {
  for (Index j = 0; j < J_.cols(); ++j) {
    SpMat::InnerIterator a(point_.J, j);
    for (SpMat::InnerIterator k(J_, j); k; ++k) {
      k.valueRef() = 0;
      if (a && a.row() == k.row()) k.valueRef() = a.value(), ++a;
    }
  }
  path_.update();
}

/// 1/2 (||F - w + v||^2 + sum of squared products).
double InteriorRun::merit() const {
  const Iterate& x = path_.x;
  return (std::pow(residual(x, point_), 2) + x.s.cwiseProduct(x.w).squaredNorm()) / 2;
}

/// False: F or J is not defined at x for this tau.
bool InteriorRun::follow() {
  if (!method_.follow) return true;
  method_.follow(path_.gap(path_.x));
  return run_.evaluate(point_);
}

bool InteriorRun::central(const Iterate& x) const {
  const double least = method_.neighbourhood * path_.gap(x);
  return (x.s.array() * x.w.array() >= least).all();
}

/// The step along d; false if F is defined at no point of it or the residual grows wherever it ends.
bool InteriorRun::advance(const Iterate& d) {
  if (!d.z.allFinite() || !d.w.allFinite()) return false;
  double alpha = InteriorPath::least(path_.length(d));
  for (int k = 0; k < neighbourhood_cuts && !central(path_.moved(d, {alpha, alpha})); ++k) alpha *= cut;
  const double size = residual(path_.x, point_);
  const double floor = path_.gap(path_.x);  // a residual below the products is small enough
  for (int k = 0; k < max_halvings && alpha > vanishing_step; ++k, alpha /= 2, ++it_.backtracks) {
    Iterate to = path_.moved(d, {alpha, alpha});
    Point point;
    point.x = lcp::project(run_.box(), to.z);
    if (!run_.counted().eval(point.x, point.F)) {
      ++undefined_;
      continue;
    }
    if (!(residual(to, point) <= method_.growth * std::max(size, floor))) continue;
    point.J.swap(point_.J);  // its pattern
    const bool defined = run_.counted().jacobian(point.x, point.J);
    if (!defined) {
      ++undefined_;
      point_.J.swap(point.J);
      run_.counted().jacobian(point_.x, point_.J);  // as it was
      continue;
    }
    point_ = std::move(point);
    path_.x = std::move(to);
    it_.step = alpha;
    it_.kind = 'N';
    return true;
  }
  return false;
}

bool InteriorRun::step() {
  singular_ = !follow();
  if (singular_) return false;
  linearise();
  const lcp::LuStatus status = path_.factor(point_.F);
  run_.stats().factorizations += path_.system().factorizations() - factorizations_;
  factorizations_ = path_.system().factorizations();
  singular_ = status != lcp::LuStatus::Ok;
  if (singular_) return false;
  const double size = residual(path_.x, point_);
  if (!advance(path_.newton(std::pow(share_of_residual * natural(), 2)))) {
    const Vec centre = 0.8 * path_.gap(path_.x) - path_.x.s.cwiseProduct(path_.x.w).array();
    return path_.pairs() > 0 && advance(path_.direction(centre));
  }
  path_.adapt_proximal(it_.step, size, residual(path_.x, point_));
  return true;
}

bool InteriorRun::finish() {
  Point to;
  if (!finish_.step(point_, to)) return false;
  if (!left_) left_ = point_;
  point_ = std::move(to);
  it_.kind = 'S';
  it_.step = 1;
  return true;
}

/// Restarts from the best point, every other time from where the run is, with larger products: its natural residual,
/// times 10 a restart.
bool InteriorRun::raise_tau() {
  if (raises_ == method_.restarts) return false;
  ++raises_;
  if (raises_ % 2 == 1) point_.x = run_.best();
  if (!open_here(std::pow(10.0, raises_ - 1) * std::clamp(run_.best_residual(), 1e-3, 1e6))) return false;
  it_.kind = 'U';
  it_.step = 1;
  return true;
}

void InteriorRun::give_up() {
  const std::string raised = raises_ == 0 ? "" : ", after tau was raised " + quantity(raises_, "time");
  if (undefined_ > 0 && undefined_ >= it_.backtracks)
    run_.end(Status::EvaluationFailed, "F or its Jacobian is not defined at any trial point, however short the step",
             "try another start or method; check the derivatives (--check-derivatives)");
  else if (singular_)
    run_.end(Status::LinearAlgebraFailed, "the Newton matrix J + diag(w / s + v / t) is singular" + raised,
             "try another method; 'perp inspect' says why a Jacobian is singular");
  else
    run_.end(
        Status::NoProgress,
        "the natural residual has stopped falling on the central path, at tau = " + number(path_.gap(path_.x)) + raised,
        "try another start, or a method with proximal escapes, --method proxi or semicomp");
}

void InteriorRun::run() {
  it_ = {.k = 0, .kind = 'I'};
  if (!run_.go_on(point_, it_)) return;
  if (!start()) {
    give_up();
    return;
  }
  Stall stall(method_.patience);
  do {
    it_ = {.k = it_.k + 1};
    undefined_ = 0;
    if (!method_.finish || method_.follow || !finish()) {
      if (left_) point_ = std::move(*left_);  // the path goes on from where it was left
      left_.reset();
      if (!stall.stalled(natural()) && step()) {
      } else if (raise_tau()) {
        stall = Stall(method_.patience);
      } else {
        give_up();
        break;
      }
    }
    it_.merit = merit();
    it_.mu = path_.gap(path_.x);
  } while (run_.go_on(point_, it_));
}

}  // namespace

void describe(InteriorPoint& m, Fields& f) {
  describe_lu(m.lu, f);
  f.add("patience", &m.patience, at_least(1),
        "iterations in which the natural residual must fall by 1 %, or the parameter is raised");
  f.add("interior_to_boundary", &m.to_boundary, strictly_between(0, 1),
        "largest step, as a share of the way to the boundary");
  f.add("interior_finish", &m.finish, "interior: Newton steps on the active set at the end");
  f.add("interior_neighbourhood", &m.neighbourhood, strictly_between(0, 1),
        "the least product is kept above this share of the mean");
  f.add("interior_growth", &m.growth, strictly_between(1, 1e100),
        "interior: factor by which |F - w + v| may grow in one step");
  f.add("interior_restarts", &m.restarts, at_least(0),
        "interior: number of times that tau is raised when the residual no longer falls");
}

void iterate(Run& run, const InteriorPoint& method, Point point) {
  if (!run.ended()) InteriorRun(run, method, std::move(point)).run();
}

}  // namespace perp::ncp
