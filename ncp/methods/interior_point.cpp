// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "ncp/methods/active_set_step.hpp"
#include "ncp/methods/predictor_corrector.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// sigma at least in restarts.
constexpr double restart_centring = 0.1;
/// Reductions of a step for the neighbourhood, by 0.8 each.
constexpr int neighbourhood_cuts = 6;
constexpr double cut = 0.8;
/// Halvings for the domain of F and the growth of the residual.
constexpr int max_halvings = 20;
/// A step below this is none.
constexpr double vanishing_step = 1e-8;
/// Proximal terms tried in turn, relative to the largest entry of J.
constexpr double first_proximal = 1e-14;
constexpr double proximal_growth = 1e4;
constexpr int proximal_tries = 5;

struct Iterate {
  Point point;
  Vec w, v;  // 0 where there is no such bound
};

struct InteriorStep {
  Vec x, w, v;
};

class InteriorPath {
 public:
  InteriorPath(Run& run, const InteriorPoint& method, Point point);
  void run();

  // Of predictor_corrector().
  InteriorStep direction(double target, const InteriorStep* affine) const;
  double reach(const InteriorStep& d) const;
  double mean_after(const InteriorStep& d, double alpha) const { return gap(moved(d, alpha)); }

 private:
  bool below(Index i) const { return has_[static_cast<std::size_t>(i)].below; }
  bool above(Index i) const { return has_[static_cast<std::size_t>(i)].above; }
  bool fixed(Index i) const { return run_.box().lower[i] == run_.box().upper[i]; }
  double s(const Iterate& at, Index i) const { return at.point.x[i] - run_.box().lower[i]; }
  double t(const Iterate& at, Index i) const { return run_.box().upper[i] - at.point.x[i]; }

  bool enter(double tau);
  void multipliers(double tau);
  Vec residual(const Iterate& at) const;
  double gap(const Iterate& at) const;
  double natural() const { return ncp::residual(run_.box(), at_.point.x, at_.point.F).natural; }
  double merit() const;
  bool follow();
  bool factor();
  Iterate moved(const InteriorStep& d, double alpha) const;
  bool central(const Iterate& at) const;
  bool advance(const InteriorStep& d);
  bool step();
  bool finish();
  bool raise_tau();
  void give_up();

  struct Bounds {
    bool below, above;
  };
  Run& run_;
  const InteriorPoint& method_;
  std::vector<Bounds> has_;  // finite bounds of variables that are not fixed
  Index pairs_ = 0;
  Iterate at_;
  std::optional<Iterate> left_;  // the interior point that active-set steps began from
  double last_step_ = 1;
  lcp::SparseLu lu_;
  SpMat K_;
  Iteration it_;
  int undefined_ = 0;
  ActiveSetFinish finish_;
  int raises_ = 0;
  bool singular_ = false;
};

InteriorPath::InteriorPath(Run& run, const InteriorPoint& method, Point point)
    : run_(run), method_(method), lu_(method.lu, run.deadline()), finish_(run, method.lu) {
  const Index n = point.x.size();
  for (Index i = 0; i < n; ++i) {
    const bool held = fixed(i);
    has_.push_back({!held && run.box().lower[i] > -infinity, !held && run.box().upper[i] < infinity});
    pairs_ += (below(i) ? 1 : 0) + (above(i) ? 1 : 0);
  }
  SpMat diagonal(n, n);
  diagonal.setIdentity();
  K_ = point.J + diagonal;
  K_.makeCompressed();
  at_.point = std::move(point);
}

/// Moves x inside and gives it multipliers of products about tau. False: F or J is defined at no point tried.
bool InteriorPath::enter(double tau) {
  const Vec from = at_.point.x;
  const Box& box = run_.box();
  double margin = method_.margin * std::min(1.0, tau);
  for (int k = 0; k < max_halvings; ++k, margin /= 4) {
    for (Index i = 0; i < from.size(); ++i) {
      const double inside = below(i) && above(i) ? std::min(margin, (box.upper[i] - box.lower[i]) / 2) : margin;
      if (below(i)) at_.point.x[i] = std::max(at_.point.x[i], box.lower[i] + inside);
      if (above(i)) at_.point.x[i] = std::min(at_.point.x[i], box.upper[i] - inside);
    }
    if (run_.evaluate(at_.point)) {
      multipliers(tau);
      return true;
    }
    ++undefined_;
    at_.point.x = from;
  }
  return false;
}

/// w >= F where that makes the row feasible, s w >= tau.
void InteriorPath::multipliers(double tau) {
  const Index n = at_.point.x.size();
  at_.w = Vec::Zero(n);
  at_.v = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const double F = at_.point.F[i];
    if (below(i)) at_.w[i] = std::max(F, tau / std::max(1.0, s(at_, i)));
    if (above(i)) at_.v[i] = std::max(-F, tau / std::max(1.0, t(at_, i)));
  }
}

Vec InteriorPath::residual(const Iterate& at) const {
  Vec r = at.point.F - at.w + at.v;
  for (Index i = 0; i < r.size(); ++i)
    if (fixed(i)) r[i] = 0;
  return r;
}

/// The mean product.
double InteriorPath::gap(const Iterate& at) const {
  double sum = 0;
  for (Index i = 0; i < at.w.size(); ++i) {
    if (below(i)) sum += s(at, i) * at.w[i];
    if (above(i)) sum += t(at, i) * at.v[i];
  }
  return pairs_ > 0 ? sum / static_cast<double>(pairs_) : 0;
}

/// 1/2 (||F - w + v||^2 + sum of squared products).
double InteriorPath::merit() const {
  double sum = residual(at_).squaredNorm();
  for (Index i = 0; i < at_.w.size(); ++i) {
    if (below(i)) sum += std::pow(s(at_, i) * at_.w[i], 2);
    if (above(i)) sum += std::pow(t(at_, i) * at_.v[i], 2);
  }
  return sum / 2;
}

/// False: F or J is not defined at x for this tau.
bool InteriorPath::follow() {
  if (!method_.follow) return true;
  method_.follow(gap(at_));
  return run_.evaluate(at_.point);
}

/// K = J + diag(w / s + v / t), rows and columns of fixed variables those of the identity, with as small a proximal
/// term as makes it regular.
bool InteriorPath::factor() {
  const Index n = at_.point.x.size();
  const SpMat& J = at_.point.J;
  const double size = J.nonZeros() > 0 ? J.coeffs().abs().maxCoeff() : 1;
  Vec diagonal = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    if (below(i)) diagonal[i] += at_.w[i] / s(at_, i);
    if (above(i)) diagonal[i] += at_.v[i] / t(at_, i);
  }
  double proximal = first_proximal;
  for (int attempt = 0; attempt < proximal_tries; ++attempt, proximal *= proximal_growth) {
    for (Index j = 0; j < n; ++j) {
      SpMat::InnerIterator a(J, j);
      for (SpMat::InnerIterator k(K_, j); k; ++k) {
        double value = 0;
        if (a && a.row() == k.row()) {
          value = fixed(j) || fixed(k.row()) ? 0 : a.value();
          ++a;
        }
        if (k.row() == j) value = fixed(j) ? 1 : value + diagonal[j] + proximal * std::max(1.0, size);
        k.valueRef() = value;
      }
    }
    ++run_.stats().factorizations;
    if (lu_.try_factor(K_)) {
      if (proximal > first_proximal) it_.prox = proximal * std::max(1.0, size);
      return true;
    }
  }
  return false;
}

/// Newton's direction towards products `target`, with the second-order terms of `affine` if there is one.
InteriorStep InteriorPath::direction(double target, const InteriorStep* affine) const {
  const Index n = at_.point.x.size();
  InteriorStep d{.x = Vec(n), .w = Vec::Zero(n), .v = Vec::Zero(n)};
  Vec c = Vec::Zero(n);
  Vec e = Vec::Zero(n);
  Vec rhs = -residual(at_);
  for (Index i = 0; i < n; ++i) {
    if (below(i)) {
      c[i] = target - s(at_, i) * at_.w[i] - (affine != nullptr ? affine->x[i] * affine->w[i] : 0);
      rhs[i] += c[i] / s(at_, i);
    }
    if (above(i)) {
      e[i] = target - t(at_, i) * at_.v[i] + (affine != nullptr ? affine->x[i] * affine->v[i] : 0);
      rhs[i] -= e[i] / t(at_, i);
    }
  }
  lu_.solve(rhs, d.x);
  for (Index i = 0; i < n; ++i) {
    if (below(i)) d.w[i] = (c[i] - at_.w[i] * d.x[i]) / s(at_, i);
    if (above(i)) d.v[i] = (e[i] + at_.v[i] * d.x[i]) / t(at_, i);
  }
  return d;
}

/// The step to the boundary, at most one.
double InteriorPath::reach(const InteriorStep& d) const {
  double alpha = 1;
  const auto limit = [&alpha](double value, double change) {
    if (change < 0) alpha = std::min(alpha, -value / change);
  };
  for (Index i = 0; i < d.x.size(); ++i) {
    if (below(i)) limit(s(at_, i), d.x[i]), limit(at_.w[i], d.w[i]);
    if (above(i)) limit(t(at_, i), -d.x[i]), limit(at_.v[i], d.v[i]);
  }
  return alpha;
}

Iterate InteriorPath::moved(const InteriorStep& d, double alpha) const {
  Iterate to;
  to.point.x = at_.point.x + alpha * d.x;
  to.w = at_.w + alpha * d.w;
  to.v = at_.v + alpha * d.v;
  return to;
}

bool InteriorPath::central(const Iterate& at) const {
  const double least = method_.neighbourhood * gap(at);
  for (Index i = 0; i < at.w.size(); ++i) {
    if (below(i) && !(s(at, i) * at.w[i] >= least)) return false;
    if (above(i) && !(t(at, i) * at.v[i] >= least)) return false;
  }
  return true;
}

/// The step along d; false if F is defined at no point of it or the residual grows wherever it ends.
bool InteriorPath::advance(const InteriorStep& d) {
  if (!d.x.allFinite() || !d.w.allFinite() || !d.v.allFinite()) return false;
  double alpha = std::min(1.0, method_.to_boundary * reach(d));
  for (int k = 0; k < neighbourhood_cuts && !central(moved(d, alpha)); ++k) alpha *= cut;
  const double size = residual(at_).norm();
  const double floor = gap(at_);  // a residual below the products is small enough
  for (int k = 0; k < max_halvings && alpha > vanishing_step; ++k, alpha /= 2, ++it_.backtracks) {
    Iterate to = moved(d, alpha);
    if (!run_.counted().eval(to.point.x, to.point.F)) {
      ++undefined_;
      continue;
    }
    if (!(residual(to).norm() <= method_.growth * std::max(size, floor))) continue;
    to.point.J.swap(at_.point.J);  // its pattern
    const bool defined = run_.counted().jacobian(to.point.x, to.point.J);
    if (!defined) {
      ++undefined_;
      at_.point.J.swap(to.point.J);
      run_.counted().jacobian(at_.point.x, at_.point.J);  // as it was
      continue;
    }
    at_ = std::move(to);
    it_.step = last_step_ = alpha;
    it_.kind = 'N';
    return true;
  }
  return false;
}

bool InteriorPath::step() {
  singular_ = !follow() || !factor();
  if (singular_) return false;
  if (pairs_ == 0) return advance(direction(0, nullptr));
  const double tau = gap(at_);
  const double least = raises_ > 0 ? std::max(restart_centring, method_.least_centring) : method_.least_centring;
  if (advance(predictor_corrector(*this, tau, least, last_step_).direction) && it_.step > vanishing_step) return true;
  return advance(direction(most_centring * tau, nullptr));
}

bool InteriorPath::finish() {
  Point to;
  if (!finish_.step(at_.point, to)) return false;
  if (!left_) left_ = at_;
  at_.point = std::move(to);
  it_.kind = 'S';
  it_.step = 1;
  return true;
}

/// From the best point, or for every other restart from where the run is, with larger products: its natural residual,
/// times 10 a restart.
bool InteriorPath::raise_tau() {
  if (raises_ == method_.restarts) return false;
  ++raises_;
  if (raises_ % 2 == 1) at_.point.x = run_.best();
  const double tau = std::pow(10.0, raises_ - 1) * std::clamp(run_.best_residual(), 1e-3, 1e6);
  if (!enter(tau)) return false;
  last_step_ = 1;
  it_.kind = 'U';
  it_.step = 1;
  return true;
}

void InteriorPath::give_up() {
  const std::string raised = raises_ == 0 ? "" : ", after tau was raised " + quantity(raises_, "time");
  if (undefined_ > 0 && undefined_ >= it_.backtracks)
    run_.end(Status::EvaluationFailed, "F or its Jacobian is not defined at any trial point, however short the step",
             "try another start or method; check the derivatives (--check-derivatives)");
  else if (singular_)
    run_.end(Status::LinearAlgebraFailed, "the Newton matrix J + diag(w / s + v / t) is singular" + raised,
             "try another method; 'perp inspect' says why a Jacobian is singular");
  else
    run_.end(Status::NoProgress,
             "the natural residual has stopped falling on the central path, at tau = " + number(gap(at_)) + raised,
             "try another start, or a method with proximal escapes, --method proxi or semicomp");
}

void InteriorPath::run() {
  it_ = {.k = 0, .kind = 'I'};
  if (!run_.go_on(at_.point, it_)) return;
  if (!enter(1)) {
    give_up();
    return;
  }
  Stall stall(method_.patience);
  do {
    it_ = {.k = it_.k + 1};
    undefined_ = 0;
    if (!method_.finish || method_.follow || !finish()) {
      if (left_) at_ = std::move(*left_);  // the path goes on from where it was left
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
    it_.mu = gap(at_);
  } while (run_.go_on(at_.point, it_));
}

}  // namespace

void describe(InteriorPoint& m, Fields& f) {
  describe_lu(m.lu, f);
  f.add("patience", &m.patience, at_least(1),
        "iterations in which the natural residual must fall by 1 %, or the parameter is raised");
  f.add("interior_centring", &m.least_centring, strictly_between(0, 1),
        "interior: least sigma, the share of the mean product tau that a step aims at");
  f.add("interior_to_boundary", &m.to_boundary, strictly_between(0, 1),
        "largest step, as a share of the way to the boundary");
  f.add("interior_finish", &m.finish, "interior: Newton steps on the active set at the end");
  f.add("interior_neighbourhood", &m.neighbourhood, strictly_between(0, 1),
        "the least product is kept above this share of the mean");
  f.add("interior_growth", &m.growth, strictly_between(1, 1e100),
        "interior: factor by which |F - w + v| may grow in one step");
  f.add("interior_margin", &m.margin, strictly_between(0, 1e100),
        "interior: the start is moved inside finite bounds by this much, or to the middle");
  f.add("interior_restarts", &m.restarts, at_least(0),
        "interior: number of times that tau is raised when the residual no longer falls");
}

void iterate(Run& run, const InteriorPoint& method, Point point) {
  if (!run.ended()) InteriorPath(run, method, std::move(point)).run();
}

}  // namespace perp::ncp
