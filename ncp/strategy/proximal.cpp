// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/proximal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace perp::ncp {

ProximalMcp::ProximalMcp(const Mcp& base, double lambda, Vec center)
    : base_(base), lambda_(lambda), s_(1 / std::max(1.0, lambda)), center_(std::move(center)) {
  SpMat diagonal(base.size(), base.size());
  diagonal.setIdentity();
  SpMat ones = base.jacobian_pattern();
  std::fill_n(ones.valuePtr(), ones.nonZeros(), 1.0);  // no cancellation in the union
  pattern_ = ones + diagonal;
  pattern_.makeCompressed();
}

bool ProximalMcp::eval(In x, Out F) const {
  if (!base_.eval(x, F)) return false;
  F = s_ * F + s_ * lambda_ * (x - center_);
  return true;
}

bool ProximalMcp::jacobian(In x, SpMat& J) const {
  SpMat base = base_.jacobian_pattern();
  if (!base_.jacobian(x, base)) return false;
  for (Index j = 0; j < J.cols(); ++j) {
    SpMat::InnerIterator from(base, j);
    for (SpMat::InnerIterator to(J, j); to; ++to) {
      double value = to.row() == j ? s_ * lambda_ : 0;
      if (from && from.row() == to.row()) {
        value += s_ * from.value();
        ++from;
      }
      to.valueRef() = value;
    }
  }
  return true;
}

namespace {

/// sqrt(||J||_1 ||J||_inf) >= ||J||_2.
double norm_bound(const SpMat& J) {
  Vec rows = Vec::Zero(J.rows());
  double columns = 0;
  for (Index j = 0; j < J.cols(); ++j) {
    double sum = 0;
    for (SpMat::InnerIterator it(J, j); it; ++it) {
      sum += std::abs(it.value());
      rows[it.row()] += std::abs(it.value());
    }
    columns = std::max(columns, sum);
  }
  return std::sqrt(columns * rows.maxCoeff());
}

/// The base method on perturbed problems and on the problem itself, within the run.
class Rounds {
 public:
  Rounds(Run& run, const Vec& start, double residual, const Escape& escape, const Body& base)
      : run_(run), escape_(escape), base_(base), x_(start), residual_(residual) {}

  /// Where the method has come to: accepted by this escape's mark.
  const Vec& x() const { return x_; }

  /// The point of F + lambda (x - center); lambda grows until it is found. False if it never is.
  bool perturbed(Vec& center, double& lambda) {
    for (int tries = 0; tries < 4 && !run_.ended(); ++tries, lambda *= escape_.grow) {
      const ProximalMcp problem(run_.mcp(), lambda, center);
      const Result r = run_.within(problem,
                                   {.iterations = escape_.perturbed_iterations,
                                    .tol = std::max(run_.tol(), escape_.perturbed_tol),
                                    .shown = false},
                                   center, base_);
      run_.charge(r);
      if (!r.accepted()) continue;
      center = r.x;
      return true;
    }
    return false;
  }

  /// The base method from x on the problem itself; true if it came nearer to a solution.
  bool original(const Vec& x, int iterations) {
    const Share share{.iterations = iterations, .start_shown = false};
    const Result r = run_.within(run_.mcp(), share, x, base_);  // its start is the centre shown before
    if (r.accepted()) {
      run_.take(r);
      return true;
    }
    run_.charge(r);
    if (!(r.residual.natural <= escape_.accept * residual_)) return false;
    run_.take_point(r);
    x_ = r.x;
    residual_ = r.residual.natural;
    return true;
  }

  /// One record for a move of the centre by this lambda. True if it is accepted as it is.
  bool show_move(const Vec& x, double lambda, bool first) {
    Iteration it{.k = 0, .step = 1, .prox = lambda, .kind = 'E'};
    if (first) {
      it.attempt = "proximal escape";
      ++run_.stats().restarts;
    }
    Residual there;
    run_.show(x, it, there);
    return there.natural <= escape_.accept * residual_;
  }

 private:
  Run& run_;
  const Escape& escape_;
  const Body& base_;
  Vec x_;
  double residual_;
};

}  // namespace

int proximal_escape(Run& run, Vec center, double residual, const Escape& escape, const Body& base) {
  Rounds rounds(run, center, residual, escape, base);
  constexpr int all = std::numeric_limits<int>::max();
  SpMat J = run.mcp().jacobian_pattern();
  int k = 0;
  double lambda = 0;
  while (k < escape.rounds && !run.ended() && !run.stalled()) {
    const Vec before = center;
    if (lambda == 0) {
      if (!run.counted().jacobian(center, J)) break;
      lambda = escape.lambda * std::max(norm_bound(J), 1e-3);
    }
    if (!rounds.perturbed(center, lambda)) break;
    const bool good = rounds.show_move(center, lambda, k == 0);
    lambda *= escape.shrink;
    ++k;
    if (run.ended()) break;
    const int tries = good ? all : escape.trial_iterations;
    if (tries > 0 && rounds.original(center, tries)) {
      if (!good && !run.ended()) rounds.original(rounds.x(), all);
      center = rounds.x();
      lambda = 0;
    }
    if ((center - before).lpNorm<Eigen::Infinity>() <= 1e-12 * (1 + before.lpNorm<Eigen::Infinity>())) break;
  }
  return k;
}

}  // namespace perp::ncp
