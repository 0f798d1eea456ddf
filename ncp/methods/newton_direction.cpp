// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/newton_direction.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/linalg/blocks.hpp"

namespace perp::ncp {
namespace {

/// Auto: LU of a matrix this small costs little time and memory whatever its fill.
constexpr Index direct_to = 20'000;

/// Krylov solves that fail before a run stays with LU.
constexpr int most_failures = 2;

/// A direction that does not descend is computed again with eta smaller by this, so many times.
constexpr double tighter = 1e-3;
constexpr int tightenings = 2;

/// Residuals of chord steps: more digits would be those of the wrong matrix.
constexpr double chord_reduction = 0.1;

/// Truncated conjugate gradients in place of a Levenberg-Marquardt factorization.
constexpr double lm_reduction = 1e-2;
constexpr int lm_iterations = 200;

/// ||H||_F^2 of H = Da + Db J; J has its diagonal, or Da's is left out where it has not.
double squared_norm(const Reformulation& at, const SpMat& J) {
  double sum = 0;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      const double entry = at.Db[it.row()] * it.value() + (it.row() == j ? at.Da[j] : 0);
      sum += entry * entry;
    }
  return sum;
}

}  // namespace

Directions::Directions(Run& run, const SemismoothNewton& method)
    : run_(run),
      method_(method),
      limits_{.deadline = run.deadline(), .interrupted = [&run] { return run.interrupted(); }},
      krylov_(method.linear == LinearSolver::Krylov ||
              (method.linear == LinearSolver::Auto && run.box().size() > direct_to)),
      lu_(method.lu),
      lm_(method.lu) {}

double Directions::forcing_term(double norm) {
  const Forcing& f = method_.forcing;
  constexpr double memory = 0.1;
  double eta = f.eta_max;
  if (norm_ > 0) {
    eta = f.gamma * std::pow(norm / norm_, f.alpha);
    if (const double before = f.gamma * std::pow(eta_, f.alpha); before > memory) eta = std::max(eta, before);
  }
  // What the tolerance asks of the next residual, tenfold; and no digits that rounding takes.
  eta = std::max({eta, 0.1 * run_.tol() / norm, 1e-10});
  eta_ = std::min(eta, f.eta_max);
  norm_ = norm;
  return eta_;
}

bool Directions::newton(const Linearisation& lin, const Point& point, const std::function<bool(const Vec&)>& descends,
                        Direction& out) {
  if (krylov_) {
    const double norm = lin.at.Phi.norm();
    double eta = forcing_term(norm);
    lcp::KrylovOptions options;
    options.max_iterations = method_.forcing.max_iterations;
    system_.reset();
    // Chord steps solve with this J again: a line search has replaced the point's by then, a halving step has not.
    const SpMat& J = method_.cfunction.smooth_merit ? (J_ = point.J) : point.J;
    system_.emplace(J, lin.at.Da, lin.at.Db, options, limits_);
    for (int k = 0; k <= tightenings; ++k, eta = std::max(eta * tighter, 1e-13)) {
      lcp::KrylovResult found = system_->solve(-lin.at.Phi, eta);
      run_.stats().krylov_iterations += found.iterations;
      if (!found.solved()) break;
      out = {.d = std::move(found.d), .kind = 'N', .nu = 0, .linear = 'K'};
      if (descends(out.d)) return true;
      if (k == tightenings) return false;  // it is not for its error that the Newton direction does not descend
    }
    system_.reset();
    if (stopped()) return false;
    if (++failures_ >= most_failures) krylov_ = false;
    return direct(lin, point, out) && descends(out.d);
  }
  return direct(lin, point, out) && descends(out.d);
}

bool Directions::chord(In Phi, Vec& d) {
  if (!system_) return false;
  lcp::KrylovResult found = system_->solve(-Phi, chord_reduction);
  run_.stats().krylov_iterations += found.iterations;
  d = std::move(found.d);
  return found.solved();
}

bool Directions::direct(const Linearisation& lin, const Point& point, Direction& out) {
  ++run_.stats().factorizations;
  SpMat assembled;
  if (lin.H.rows() == 0) assemble(lin.at.Da, lin.at.Db, point.J, assembled);
  if (lu_.factor(lin.H.rows() == 0 ? assembled : lin.H) != lcp::LuStatus::Ok) return false;
  out = {.d = Vec(lin.at.Phi.size()), .kind = 'N', .nu = 0, .linear = failures_ > 0 ? 'D' : ' '};
  lu_.solve(-lin.at.Phi, out.d);
  return out.d.allFinite();
}

bool Directions::levenberg_marquardt(const Linearisation& lin, const Point& point, double nu, Direction& out) {
  if (lin.H.rows() == 0) {
    out = {.d = lcp::damped_least_squares(point.J, lin.at.Da, lin.at.Db, -lin.at.Phi, nu, lm_reduction, lm_iterations,
                                          limits_),
           .kind = 'L',
           .nu = nu,
           .linear = 'K'};
    return out.d.allFinite();
  }
  ++run_.stats().factorizations;
  out = {.d = {}, .kind = 'L', .nu = nu, .linear = ' '};
  return lcp::damped_least_squares(lm_, lin.H, -lin.at.Phi, nu, out.d);
}

Direction Directions::gradient(const Linearisation& lin, const Point& point) const {
  const Vec along = lin.at.Da.cwiseProduct(lin.gradient) + lin.at.Db.cwiseProduct(point.J * lin.gradient);
  const double curvature = along.squaredNorm();
  const double length = curvature > 0 ? lin.gradient.squaredNorm() / curvature : 1;
  return {.d = -(std::isfinite(length) ? length : 1) * lin.gradient, .kind = 'G', .nu = 0, .linear = ' '};
}

double Directions::first_nu(const Linearisation& lin, const Point& point) const {
  const double size = lin.H.rows() == 0 ? squared_norm(lin.at, point.J) : lin.H.squaredNorm();
  return std::min(1.0, lin.at.Phi.norm()) * std::max(1e-8, 1e-6 * size / static_cast<double>(point.x.size()));
}

std::string Directions::remark() const {
  if (failures_ == 0) return {};
  return "the Krylov method did not converge in " + quantity(failures_, "iteration") + ", where LU took over" +
         (method_.linear != LinearSolver::Direct && !krylov_ ? " for the rest of the run" : "");
}

}  // namespace perp::ncp
