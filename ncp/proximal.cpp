#include "ncp/proximal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::ncp {

ProximalMcp::ProximalMcp(const Mcp& base, double lambda, Vec center)
    : base_(base), lambda_(lambda), center_(std::move(center)) {
  SpMat diagonal(base.size(), base.size());
  diagonal.setIdentity();
  SpMat ones = base.jacobian_pattern();
  std::fill_n(ones.valuePtr(), ones.nonZeros(), 1.0);  // no cancellation in the union
  pattern_ = ones + diagonal;
  pattern_.makeCompressed();
}

bool ProximalMcp::eval(In x, Out F) const {
  if (!base_.eval(x, F)) return false;
  F += lambda_ * (x - center_);
  return true;
}

bool ProximalMcp::jacobian(In x, SpMat& J) const {
  SpMat base = base_.jacobian_pattern();
  if (!base_.jacobian(x, base)) return false;
  for (Index j = 0; j < J.cols(); ++j) {
    SpMat::InnerIterator from(base, j);
    for (SpMat::InnerIterator to(J, j); to; ++to) {
      double value = to.row() == j ? lambda_ : 0;
      if (from && from.row() == to.row()) {
        value += from.value();
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
  Rounds(const Mcp& mcp, const Method& method, Result stuck, const RunMethod& run, const Observer& observer)
      : mcp_(mcp), method_(method), run_(run), observer_(observer), best_(std::move(stuck)) {}

  const Result& best() const { return best_; }
  bool over() const { return over_ || best_.solved(); }

  /// The point of F + lambda (x - center); lambda grows until it is found. False if it never is.
  bool perturbed(Vec& center, double& lambda) {
    for (int tries = 0; tries < 4 && !over(); ++tries, lambda *= 10) {
      const ProximalMcp problem(mcp_, lambda, center);
      const Result r = run(problem, center, std::max(stop(method_).tol, loose_tol), perturbed_iterations, {});
      if (!r.solved()) continue;
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
    const bool better = r.solved() || r.residual.natural < 0.5 * best_.residual.natural;
    if (better) best_ = r;
    return better;
  }

  Result finish(int rounds) {
    if (best_.solved())
      best_.message += ", after " + std::to_string(rounds) + " proximal escapes from a local minimum";
    else if (rounds > 0)
      best_.message += "; " + std::to_string(rounds) + " proximal escapes led nowhere better";
    best_.stats = stats_;
    return best_;
  }

  /// One record for a move of the centre.
  void show_move(const Vec& x) {
    const Residual r = residual(mcp_, x);
    Iteration it{.k = 0, .residual = r.natural, .worst = r.worst, .step = 1, .kind = 'E', .x = &x};
    shown(it);
  }

  static constexpr int trial_iterations = 25;

 private:
  static constexpr double loose_tol = 1e-6;
  static constexpr int perturbed_iterations = 60;

  Result run(const Mcp& mcp, const Vec& x, double tol, int iterations, const Observer& observer) {
    Method method = method_;
    Stop& limits = stop(method);
    limits.tol = tol;
    limits.max_iterations = std::min(iterations, limits.max_iterations - stats_.iterations);
    limits.max_time -= stats_.time;
    if (limits.max_iterations <= 0 || limits.max_time.count() <= 0) {
      over_ = true;
      return best_;
    }
    Result r = run_(mcp, x, method, observer);
    add(r.stats);
    over_ = over_ || r.status == Status::Interrupted || r.status == Status::TimeLimit;
    return r;
  }

  void add(const Stats& s) {
    stats_.iterations += s.iterations;
    stats_.F_evals += s.F_evals;
    stats_.J_evals += s.J_evals;
    stats_.factorizations += s.factorizations;
    stats_.pivots += s.pivots;
    stats_.time += s.time;
  }

  Next shown(Iteration it) {
    it.k += stats_.iterations;
    it.F_evals += stats_.F_evals;
    it.J_evals += stats_.J_evals;
    const Next next = observer_ ? observer_(it) : Next::Continue;
    over_ = over_ || next == Next::Stop;
    return next;
  }

  const Mcp& mcp_;
  const Method& method_;
  const RunMethod& run_;
  const Observer& observer_;
  Result best_;
  Stats stats_ = best_.stats;
  bool over_ = false;
};

}  // namespace

Result proximal_escape(const Mcp& mcp, const Method& method, const Escape& escape, Result stuck, const RunMethod& run,
                       const Observer& observer) {
  Vec center = stuck.x;
  Rounds rounds(mcp, method, std::move(stuck), run, observer);
  SpMat J = mcp.jacobian_pattern();
  int k = 0;
  while (k < escape.rounds && !rounds.over()) {
    const Vec before = center;
    if (!mcp.jacobian(center, J)) break;
    double lambda = escape.lambda * std::max(norm_bound(J), 1e-3);
    if (!rounds.perturbed(center, lambda)) break;
    ++k;
    rounds.show_move(center);
    if (rounds.original(center, Rounds::trial_iterations)) {
      if (!rounds.best().solved() && !rounds.over()) rounds.original(rounds.best().x, stop(method).max_iterations);
      center = rounds.best().x;
    }
    if ((center - before).lpNorm<Eigen::Infinity>() <= 1e-12 * (1 + before.lpNorm<Eigen::Infinity>())) break;
  }
  return rounds.finish(k);
}

}  // namespace perp::ncp
