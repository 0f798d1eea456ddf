#include "ncp/proximal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ncp/run.hpp"

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

/// Runs the base method within what is left of the user's limits, counting on from the runs before.
class Rounds {
 public:
  Rounds(const Mcp& mcp, const Method& method, const Escape& escape, Result stuck, const RunMethod& run,
         const Observer& observer)
      : mcp_(mcp), method_(method), escape_(escape), run_(run), observer_(observer), best_(std::move(stuck)) {}

  const Result& best() const { return best_; }
  bool over() const { return ended_.has_value() || best_.accepted(); }

  /// The point of F + lambda (x - center); lambda grows until it is found. False if it never is.
  bool perturbed(Vec& center, double& lambda) {
    for (int tries = 0; tries < 4 && !over(); ++tries, lambda *= escape_.grow) {
      const ProximalMcp problem(mcp_, lambda, center);
      const Result r =
          run(problem, center, std::max(stop(method_).tol, escape_.perturbed_tol), escape_.perturbed_iterations, {});
      if (!r.accepted()) continue;
      center = r.x;
      return true;
    }
    return false;
  }

  /// The base method from x on the problem itself; true if it came nearer to a solution.
  bool original(const Vec& x, int iterations) {
    const Result r = run(mcp_, x, stop(method_).tol, iterations, [this](const Iteration& it) {
      return it.k == 0 ? Next::Continue : shown(it);  // the start of a trial is the centre shown before
    });
    if (!r.accepted() && !(r.residual.natural <= escape_.accept * best_.residual.natural)) return false;
    if (r.accepted()) {
      best_ = r;
    } else {  // the verdict stays that of the run that got stuck
      best_.x = r.x;
      best_.F = r.F;
      best_.residual = r.residual;
    }
    return true;
  }

  Result finish(int rounds) {
    const std::string escapes = quantity(rounds, "proximal escape");
    if (best_.accepted()) {
      best_.message += ", after " + escapes + " from a local minimum";
    } else {
      if (ended_.has_value()) {
        best_.status = ended_->status;
        best_.message = ended_->message;
        best_.advice = ended_->advice;
      }
      best_.message += "; " + escapes + (rounds == 1 ? " has" : " have") + " not led to a solution";
      if (ended_.has_value() && best_.residual.worst >= 0)
        best_.message += "; the best point has natural residual " + number(best_.residual.natural) +
                         ", worst in equation " + mcp_.equation_name(best_.residual.worst) + " of variable " +
                         mcp_.variable_name(best_.residual.worst);
    }
    best_.stats = stats_;
    return best_;
  }

  /// One record for a move of the centre by this lambda. True if it is accepted as it is.
  bool show_move(const Vec& x, double lambda, bool first) {
    Vec F;
    CountedMcp guarded(mcp_);
    const Residual r = guarded.eval(x, F) ? residual(mcp_.box(), x, F) : Residual{};
    stats_.F_evals += guarded.F_evals();
    Iteration it{.k = 0, .residual = r.natural, .worst = r.worst, .step = 1, .prox = lambda, .kind = 'E'};
    if (first) {
      it.attempt = "proximal escape";
      ++stats_.restarts;
    }
    it.x = &x;
    it.problem = &mcp_;
    if (shown(it) == Next::Stop)
      end({Status::Interrupted, "interrupted after " + quantity(stats_.iterations, "iteration"),
           "run on from the point returned"});
    return r.natural <= escape_.accept * best_.residual.natural;
  }

  bool jacobian(const Vec& x, SpMat& J) {
    CountedMcp guarded(mcp_);
    const bool defined = guarded.jacobian(x, J);
    stats_.J_evals += guarded.J_evals();
    return defined;
  }

 private:
  struct Verdict {
    Status status;
    std::string message, advice;
  };
  void end(Verdict verdict) {
    if (!ended_) ended_ = std::move(verdict);
  }

  Result run(const Mcp& mcp, const Vec& x, double tol, int iterations, const Observer& observer) {
    Method method = method_;
    Stop& limits = stop(method);
    limits.tol = tol;
    const int left = limits.max_iterations - stats_.iterations;
    limits.max_iterations = std::min(iterations, left);
    limits.max_F_evals = std::max(1, limits.max_F_evals - stats_.F_evals);
    limits.max_time -= stats_.time;
    limits.max_time = std::max(limits.max_time, std::chrono::duration<double>(0));
    Result r = run_(mcp, x, method, observer);
    stats_ += r.stats;
    if (r.status == Status::Interrupted)
      end({r.status, "interrupted after " + quantity(stats_.iterations, "iteration"), r.advice});
    else if (r.status == Status::TimeLimit)
      end({r.status, "the time limit was reached", r.advice});
    else if (!r.accepted() && stats_.F_evals >= stop(method_).max_F_evals)
      end({Status::IterationLimit,
           "the limit of " + quantity(stop(method_).max_F_evals, "evaluation") + " of F was reached", r.advice});
    else if (r.status == Status::IterationLimit && iterations >= left)
      end({r.status, "the limit of " + quantity(stop(method_).max_iterations, "iteration") + " was reached", r.advice});
    return r;
  }

  Next shown(Iteration it) {
    it.k += stats_.iterations;
    it.F_evals += stats_.F_evals;
    it.J_evals += stats_.J_evals;
    const Next next = observer_ ? observer_(it) : Next::Continue;
    return next;
  }

  const Mcp& mcp_;
  const Method& method_;
  const Escape& escape_;
  const RunMethod& run_;
  const Observer& observer_;
  Result best_;
  Stats stats_ = best_.stats;
  std::optional<Verdict> ended_;  // by a limit or an observer
};

}  // namespace

Result proximal_escape(const Mcp& mcp, const Method& method, const Escape& escape, Result stuck, const RunMethod& run,
                       const Observer& observer) {
  Vec center = stuck.x;
  Rounds rounds(mcp, method, escape, std::move(stuck), run, observer);
  SpMat J = mcp.jacobian_pattern();
  int k = 0;
  double lambda = 0;
  while (k < escape.rounds && !rounds.over()) {
    const Vec before = center;
    if (lambda == 0) {
      if (!rounds.jacobian(center, J)) break;
      lambda = escape.lambda * std::max(norm_bound(J), 1e-3);
    }
    if (!rounds.perturbed(center, lambda)) break;
    const bool good = rounds.show_move(center, lambda, k == 0);
    lambda *= escape.shrink;
    ++k;
    if (rounds.over()) break;
    const int iterations = good ? stop(method).max_iterations : escape.trial_iterations;
    if (iterations > 0 && rounds.original(center, iterations)) {
      if (!good && !rounds.best().accepted() && !rounds.over())
        rounds.original(rounds.best().x, stop(method).max_iterations);
      center = rounds.best().x;
      lambda = 0;
    }
    if ((center - before).lpNorm<Eigen::Infinity>() <= 1e-12 * (1 + before.lpNorm<Eigen::Infinity>())) break;
  }
  return rounds.finish(k);
}

}  // namespace perp::ncp
