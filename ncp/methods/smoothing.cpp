// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/linalg/blocks.hpp"
#include "ncp/methods/active_set_step.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// The first nu of Levenberg-Marquardt steps, in units of the size of H'H times ||Phi_mu||.
constexpr double lm_first = 1e-6;
/// mu stays above this part of the tolerance: Phi_mu is as good as Phi_0 there.
constexpr double least_mu = 1e-4;
/// The k-th raise is by 10 x 10^k, from the present mu or the schedule's.
constexpr double raise = 10;
/// Factors of mu tried after a corrector step.
constexpr double reductions[] = {0.1, 0.3, 0.5, 0.7, 0.9};
/// A predictor that comes to less than this part of mu is worth its evaluation.
constexpr double predicted_share = 0.5;

class Smoother {
 public:
  Smoother(Run& run, const Smoothing& method, Point point)
      : run_(run),
        method_(method),
        point_(std::move(point)),
        lu_(method.lu),
        memory_(method.search.memory),
        finish_(run, method.lu) {}
  void run();

 private:
  double natural(const Point& p) const { return residual(run_.box(), p.x, p.F).natural; }
  /// ||Phi_mu||_inf.
  double size(const Point& p, double mu) const;
  double merit(const Point& p, double mu) const;
  /// Chen & Mangasarian's mu(x): their alpha is 1/r for r < 1, 1/sqrt(r) beyond.
  double scheduled(const Point& p) const {
    const double r = natural(p);
    return std::min(r, std::sqrt(r));
  }
  void set_mu(double mu);

  void linearise();
  bool step();
  bool predict();
  bool newton(const Vec& rhs, Vec& d) const;
  bool levenberg_marquardt(double nu, Vec& d);
  Vec cauchy_step() const;
  bool search(const Vec& d, char kind);
  bool finish();
  void reduce();
  bool raise_mu();
  void give_up(bool stationary, bool stalled);

  Run& run_;
  const Smoothing& method_;
  Point point_;
  lcp::SparseLu lu_;
  Memory memory_;  // of merits for the present mu
  double mu_ = 1;
  double beta_ = 1;
  // At point_ for mu_:
  SmoothReformulation at_;
  SpMat H_;
  Vec gradient_;
  double stationarity_ = 0;

  Iteration it_;
  int undefined_ = 0;  // trial points of this iteration at which F or J was not defined
  ActiveSetFinish finish_;
  int raises_ = 0;
};

double Smoother::size(const Point& p, double mu) const {
  Vec Phi(p.x.size());
  reformulate(method_.function, run_.box(), p.x, p.F, mu, Phi);
  return Phi.size() > 0 ? Phi.lpNorm<Eigen::Infinity>() : 0;
}

double Smoother::merit(const Point& p, double mu) const {
  Vec Phi(p.x.size());
  reformulate(method_.function, run_.box(), p.x, p.F, mu, Phi);
  return 0.5 * Phi.squaredNorm();
}

void Smoother::set_mu(double mu) {
  mu_ = std::max(mu, least_mu * run_.tol());
  memory_.reset(merit(point_, mu_));
}

void Smoother::linearise() {
  reformulate(method_.function, run_.box(), point_.x, point_.F, mu_, at_);
  assemble(at_.Da, at_.Db, point_.J, H_);
  gradient_ = H_.transpose() * at_.Phi;
  const Vec terms = H_.cwiseAbs().transpose() * at_.Phi.cwiseAbs();
  stationarity_ = stationarity(gradient_, terms);
}

bool Smoother::newton(const Vec& rhs, Vec& d) const {
  lu_.solve(rhs, d);
  return d.allFinite();
}

bool Smoother::levenberg_marquardt(double nu, Vec& d) {
  ++run_.stats().factorizations;
  lcp::SparseLu lu(method_.lu);
  return lcp::damped_least_squares(lu, H_, -at_.Phi, nu, d);
}

/// The minimiser of ||Phi_mu + H d|| along d = -gradient.
Vec Smoother::cauchy_step() const {
  const double curvature = (H_ * gradient_).squaredNorm();
  const double length = curvature > 0 ? gradient_.squaredNorm() / curvature : 1;
  return -(std::isfinite(length) ? length : 1) * gradient_;
}

/// x + t d with  psi(x + t d) <= reference + sigma t psi'(x; d),  psi = 1/2 ||Phi_mu||^2, F and J defined there.
bool Smoother::search(const Vec& d, char kind) {
  const double slope = gradient_.dot(d);
  if (!(slope < 0)) return false;
  Point trial;
  double t = 1;
  for (int k = 0; k <= method_.search.max_backtracks; ++k, t *= method_.search.beta, ++it_.backtracks) {
    trial.x = point_.x + t * d;
    if (trial.x == point_.x) return false;  // t d has vanished in rounding
    if (!run_.counted().eval(trial.x, trial.F)) {
      ++undefined_;
      continue;
    }
    const double psi = merit(trial, mu_);
    if (!(psi <= memory_.reference() + method_.search.sigma * t * slope)) continue;
    if (!run_.counted().jacobian(trial.x, trial.J)) {
      ++undefined_;
      continue;
    }
    std::swap(point_, trial);
    memory_.push(psi);
    it_.step = t;
    it_.kind = kind;
    return true;
  }
  return false;
}

/// From the fastest to the safest.
bool Smoother::step() {
  const auto n = static_cast<double>(point_.x.size());
  Vec d(point_.x.size());
  ++run_.stats().factorizations;
  if (lu_.factor(H_) == lcp::LuStatus::Ok) {
    if (method_.schedule == SmoothingSchedule::PredictorCorrector && predict()) return true;
    if (newton(-at_.Phi, d) && search(d, 'N')) return true;
  }
  double nu = lm_first * std::max(1e-8, H_.squaredNorm() / n) * std::min(1.0, at_.Phi.norm());
  for (int k = 0; k < lm_tries && !run_.interrupted(); ++k, nu *= lm_growth)
    if (levenberg_marquardt(nu, d) && search(d, 'L')) {
      it_.prox = nu;
      return true;
    }
  return search(cauchy_step(), 'G');
}

bool Smoother::predict() {
  Vec Phi(point_.x.size());
  reformulate(method_.function, run_.box(), point_.x, point_.F, 0, Phi);
  Vec d(Phi.size());
  if (!newton(-Phi, d)) return false;
  Point trial;
  trial.x = point_.x + d;
  if (!run_.counted().eval(trial.x, trial.F)) return false;
  const double mu = std::min(predicted_share * mu_, size(trial, 0));
  if (!(size(trial, mu) <= beta_ * mu) || !run_.counted().jacobian(trial.x, trial.J)) return false;
  std::swap(point_, trial);
  set_mu(mu);
  it_.kind = 'H';
  it_.step = 1;
  return true;
}

bool Smoother::finish() {
  Point to;
  if (!finish_.step(point_, to)) return false;
  std::swap(point_, to);
  set_mu(std::min(mu_, scheduled(point_)));
  it_.kind = 'S';
  it_.step = 1;
  return true;
}

/// After a step for the present mu.
void Smoother::reduce() {
  double mu = mu_;
  if (method_.schedule == SmoothingSchedule::NewtonArmijo) {
    mu = std::min(mu, scheduled(point_));
    if (size(point_, mu) <= method_.centring * mu) mu *= method_.shrink;
  } else {
    for (const double factor : reductions)
      if (size(point_, factor * mu_) <= beta_ * factor * mu_) {
        mu *= factor;
        break;
      }
  }
  if (mu < mu_) set_mu(mu);
}

/// Local minima of the merit function move with mu, and most of them merge where it is large.
bool Smoother::raise_mu() {
  if (raises_ == method_.restarts) return false;
  ++raises_;
  set_mu(raise * std::pow(10.0, raises_) * std::max(mu_, scheduled(point_)));
  it_.kind = 'U';
  return true;
}

void Smoother::give_up(bool stationary, bool stalled) {
  const bool nowhere = undefined_ > 0 && undefined_ == it_.backtracks;
  const std::string merit_name =
      "the merit function 1/2 ||Phi_mu||^2 (" + method_.function.name + ", mu = " + number(mu_) + ")";
  const std::string raised = raises_ == 0 ? "" : ", after mu was raised " + std::to_string(raises_) + " times";
  if (nowhere)
    run_.end(Status::EvaluationFailed, "F or its Jacobian is not defined at any trial point, however short the step",
             "try another start or method; check the derivatives (--check-derivatives)");
  else if (stationary)
    run_.end(Status::StationaryPoint, "a stationary point of " + merit_name + " that is no solution" + raised,
             "try another start, or a method with proximal escapes, --method proxi or semicomp");
  else
    run_.end(Status::NoProgress,
             stalled ? "the natural residual has stopped falling" + raised
                     : "no direction (Newton, Levenberg-Marquardt, gradient) decreases " + merit_name + raised,
             "try another start, or a method with proximal escapes, --method proxi or semicomp");
}

void Smoother::run() {
  set_mu(scheduled(point_));
  beta_ = std::max({method_.neighbourhood, 2 * method_.function.kappa, 2 * size(point_, mu_) / mu_});
  Stall stall(method_.patience);
  it_ = {.k = 0, .merit = merit(point_, mu_), .mu = mu_, .kind = 'I'};
  while (run_.go_on(point_, it_)) {
    it_ = {.k = it_.k + 1};
    undefined_ = 0;
    if (!method_.finish || !finish()) {
      linearise();
      const bool stationary = stationarity_ <= stationary_tol;
      const bool stalled = stall.stalled(natural(point_));
      if (!stationary && !stalled && step()) {
        reduce();
      } else if (raise_mu()) {
        stall = Stall(method_.patience);
      } else {
        give_up(stationary, stalled);
        break;
      }
    }
    it_.merit = merit(point_, mu_);
    it_.mu = mu_;
  }
}

}  // namespace

void describe(Smoothing& m, Fields& f) {
  using enum SmoothingSchedule;
  describe(m.search, f);
  describe_lu(m.lu, f);
  f.add("patience", &m.patience, at_least(1),
        "iterations in which the natural residual must fall by 1 %, or the parameter is raised");
  describe(m.function, f);
  f.choice("smoothing_schedule", &m.schedule,
           {{"newton-armijo", NewtonArmijo}, {"predictor-corrector", PredictorCorrector}},
           "how the parameter mu shrinks: newton-armijo (with the residual) or predictor-corrector (along the path "
           "Phi_mu(x) = 0)");
  f.add("smoothing_finish", &m.finish, "Newton steps on the active set at the end");
}

void iterate(Run& run, const Smoothing& method, Point point) { Smoother(run, method, std::move(point)).run(); }

}  // namespace perp::ncp
