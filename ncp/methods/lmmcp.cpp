// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/lmmcp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

// Of Kanzow & Petra's program.
constexpr double least_nu = 1e-16;
constexpr double first_radius = 5, least_radius = 1;
constexpr double to_grow = 0.95;        // a step that leaves at most this much of ||Phi|| doubles the radius,
constexpr double to_shrink = 5 * 0.95;  // one that leaves more than that halves it
constexpr double shortest_step = 1e-8;
constexpr int monotone_steps = 5;
/// H'H is singular to rounding: the square of 1e-12 is below 1e-16 and 1e-25 are their limits.
constexpr double singular = 1e-12;

/// Phi and H of the 2 n equations, and Psi with its gradient.
class LeastSquares {
 public:
  LeastSquares(Run& run, const Lmmcp& method)
      : run_(run), lambda_(method.lambda), n_(run.box().size()), lu_(method.lu) {}

  double merit(In x, In F) {
    evaluate(x, F, Phi_trial_);
    return 0.5 * Phi_trial_.squaredNorm();
  }

  void linearise(const Point& point) {
    evaluate(point.x, point.F, Phi_);
    elements(fb_, run_.box(), point, at_);
    assemble(lambda_ * at_.Da, lambda_ * at_.Db, point.J, upper_);
    products(point.x, point.F);
    assemble((1 - lambda_) * at_.Da, (1 - lambda_) * at_.Db, point.J, lower_);
    gradient_ = upper_.transpose() * Phi_.head(n_) + lower_.transpose() * Phi_.tail(n_);
  }

  double merit() const { return 0.5 * Phi_.squaredNorm(); }
  double norm() const { return Phi_.norm(); }
  const Vec& gradient() const { return gradient_; }

  /// min ||Phi + H d||^2 + nu ||d||^2 by r = Phi + H d, H'r + nu d = 0. False: no factors.
  bool direction(double larger_nu, Vec& d, double& nu) {
    for (nu = least_nu; !factor(nu); nu = larger_nu)
      if (nu == larger_nu) return false;
    Vec rhs = Vec::Zero(3 * n_), solution(3 * n_);
    rhs.head(2 * n_) = Phi_;
    lu_.solve_refined(rhs, solution);
    d = solution.tail(n_);
    return d.allFinite();
  }

 private:
  void evaluate(In x, In F, Vec& Phi) const {
    const Box& box = run_.box();
    Phi.resize(2 * n_);
    reformulate(fb_, box, x, F, Phi.head(n_));
    for (Index i = 0; i < n_; ++i) {
      const bool below = std::isfinite(box.lower[i]), above = std::isfinite(box.upper[i]);
      double product = below || above ? 0 : F[i];
      if (below) product += std::max(0.0, x[i] - box.lower[i]) * std::max(0.0, F[i]);
      if (above) product += std::max(0.0, box.upper[i] - x[i]) * std::max(0.0, -F[i]);
      Phi[n_ + i] = product;
    }
    Phi.head(n_) *= lambda_;
    Phi.tail(n_) *= 1 - lambda_;
  }

  /// Da and Db of the second part.
  void products(In x, In F) {
    const Box& box = run_.box();
    for (Index i = 0; i < n_; ++i) {
      const bool below = std::isfinite(box.lower[i]), above = std::isfinite(box.upper[i]);
      at_.Da[i] = 0;
      at_.Db[i] = below || above ? 0 : 1;
      if (below && x[i] >= box.lower[i] && F[i] >= 0) at_.Da[i] += F[i], at_.Db[i] += x[i] - box.lower[i];
      if (above && x[i] <= box.upper[i] && F[i] <= 0) at_.Da[i] += F[i], at_.Db[i] += x[i] - box.upper[i];
    }
  }

  /// [I -H; H' nu I]
  bool factor(double nu) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(3 * n_ + 2 * (upper_.nonZeros() + lower_.nonZeros())));
    const auto add = [&](Index row, Index col, double value) {
      entries.emplace_back(static_cast<int>(row), static_cast<int>(col), value);
    };
    for (Index i = 0; i < 2 * n_; ++i) add(i, i, 1);
    for (Index j = 0; j < n_; ++j) {
      add(2 * n_ + j, 2 * n_ + j, nu);
      const auto column = [&](const SpMat& part, Index first) {
        for (SpMat::InnerIterator it(part, j); it; ++it) {
          add(first + it.row(), 2 * n_ + j, -it.value());
          add(2 * n_ + j, first + it.row(), it.value());
        }
      };
      column(upper_, 0);
      column(lower_, n_);
    }
    SpMat system(3 * n_, 3 * n_);
    system.setFromTriplets(entries.begin(), entries.end());
    ++run_.stats().factorizations;
    return lu_.factor(system) == lcp::LuStatus::Ok && (nu > least_nu || lu_.rcond() > singular * singular);
  }

  Run& run_;
  const CFunction fb_ = fischer_burmeister();
  double lambda_;
  Index n_;
  lcp::SparseLu lu_;
  Reformulation at_;
  Vec Phi_, Phi_trial_, gradient_;
  SpMat upper_, lower_;  // H by its two parts
};

/// Steps that are cut off, not searched along. False: the run has ended.
bool preprocess(Run& run, const Lmmcp& method, LeastSquares& equations, Point point, Iteration& it) {
  const Box& box = run.box();
  double radius = first_radius;
  for (int k = 1; k <= method.preprocess; ++k) {
    equations.linearise(point);
    Vec d;
    it = {.k = it.k + 1, .step = 1, .kind = 'P'};
    if (!equations.direction(1e-6 / (k + 1), d, it.prox) || d.norm() <= shortest_step) break;
    const double last = equations.norm();
    for (Index i = 0; i < d.size(); ++i) {
      const double least = std::max(std::min(box.lower[i] - point.x[i], 0.0), -radius);
      const double most = std::min(std::max(box.upper[i] - point.x[i], 0.0), radius);
      d[i] = std::clamp(d[i], least, most);
    }
    point.x += d;
    if (!run.evaluate(point)) break;
    it.merit = equations.merit(point.x, point.F);
    const double now = std::sqrt(2 * it.merit);
    if (now <= to_grow * last)
      radius = std::max(least_radius, 2 * radius);
    else if (now > to_shrink * last)
      radius = std::max(least_radius, radius / 2);
    if (!run.go_on(point, it)) return false;
  }
  return true;
}

/// t = 1, beta, beta^2, ... until Psi(x + t d) <= reference + t slope. 0: none.
double search(Run& run, const Lmmcp& method, LeastSquares& equations, const Vec& d, double reference, Point& point,
              Iteration& it) {
  const double slope = method.sigma * equations.gradient().dot(d);
  double t = 1;
  for (int k = 0; k <= method.max_backtracks; ++k, t *= method.beta) {
    Point trial;
    trial.x = point.x + t * d;
    trial.J = point.J;
    if (run.counted().eval(trial.x, trial.F)) {
      it.merit = equations.merit(trial.x, trial.F);
      if (it.merit <= reference + t * slope && run.counted().jacobian(trial.x, trial.J)) {
        point = std::move(trial);
        return t;
      }
    }
    ++it.backtracks;
  }
  return 0;
}

}  // namespace

void describe(Lmmcp& m, Fields& f) {
  describe_memory(m.memory, f);
  describe_search(m.sigma, m.beta, m.max_backtracks, f);
  describe_lu(m.lu, f);
}

void iterate(Run& run, const Lmmcp& method, Point point) {
  LeastSquares equations(run, method);
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = equations.merit(point.x, point.F);
  if (!run.go_on(point, it)) return;
  if (!preprocess(run, method, equations, point, it)) return;

  Memory memory(method.memory);
  double reference = equations.merit(point.x, point.F);
  Point best = point;
  double least = reference;
  int since_best = 0;
  Stall stall(200);
  for (int steps = 1;; ++steps) {
    equations.linearise(point);
    if (stall.stalled(least))
      return run.end(Status::NoProgress, "the merit function 1/2 ||Phi||^2 has stopped falling",
                     "try another start or --method path");
    Vec d;
    it = {.k = it.k + 1, .kind = 'L'};
    if (!equations.direction(0.1 / (it.k + 1), d, it.prox))
      return run.end(Status::LinearAlgebraFailed, "the least-squares problem of a step could not be solved",
                     "try --method semismooth");
    it.step = search(run, method, equations, d, reference, point, it);
    if (it.step == 0)
      return run.end(Status::NoProgress, "no step along the Levenberg-Marquardt direction decreases 1/2 ||Phi||^2",
                     "try another start or --method path");
    memory.push(it.merit);
    reference = steps <= monotone_steps ? it.merit : memory.reference();
    if (it.merit < least) {
      least = it.merit;
      best = point;
      since_best = 0;
    } else if (++since_best > method.watchdog) {
      point = best;
      reference = least;
      memory.reset(least);
      since_best = 0;
      ++run.stats().watchdogs;
    }
    if (!run.go_on(point, it)) return;
  }
}

}  // namespace perp::ncp
