// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/deflated_newton.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/linalg/blocks.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "ncp/reformulation/line_search.hpp"

namespace perp::ncp {

double DeflationOperator::log_value(In x) const {
  double sum = 0;
  for (const auto& [r, D] : roots_) sum += std::log(std::pow(D / (x - r).norm(), p_) + sigma_);
  return sum;
}

Vec DeflationOperator::log_gradient(In x) const {
  Vec m = Vec::Zero(x.size());
  for (const auto& [r, D] : roots_) {
    const double distance = (x - r).norm();
    m -= p_ / (distance * distance * (1 + sigma_ * std::pow(distance / D, p_))) * (x - r);
  }
  return m;
}

double deflated_length(double m_dot_d) { return 1 / (1 - m_dot_d); }

namespace {

/// The steps of one iteration, from the fastest to the safest.
class DeflatedSteps {
 public:
  explicit DeflatedSteps(Run& run) : run_(run), lu_(lcp::LuBackend::General), lm_(lcp::LuBackend::General) {}

  /// tau d.
  bool newton(const Linearisation& lin, const Vec& m, Vec& step) {
    ++run_.stats().factorizations;
    if (lu_.factor(lin.H) != lcp::LuStatus::Ok) return false;
    step.resize(m.size());
    lu_.solve(-lin.at.Phi, step);
    step *= deflated_length(m.dot(step));
    return step.allFinite();
  }

  /// The minimiser of ||Phi + G s||^2 + nu ||s||^2, G = H + Phi m': with K = [I H; H' -nu I] and the rank-two rest
  /// (Phi (m's); m (Phi'r)), three solves with K.
  bool levenberg_marquardt(const Linearisation& lin, const Vec& m, double nu, Vec& step) {
    const Index n = m.size();
    ++run_.stats().factorizations;
    if (lm_.factor(lcp::least_squares_system(lin.H, nu)) != lcp::LuStatus::Ok) return false;
    Vec rhs = Vec::Zero(2 * n), a(2 * n), b(2 * n);
    rhs.head(n) = lin.at.Phi;
    lm_.solve(rhs, a);
    rhs.head(n).setZero();
    rhs.tail(n) = m;
    lm_.solve(rhs, b);
    // (r; s) = -(1 + alpha) a - beta b with alpha = m's, beta = Phi'r.
    const double ma = m.dot(a.tail(n)), mb = m.dot(b.tail(n));
    const double fa = lin.at.Phi.dot(a.head(n)), fb = lin.at.Phi.dot(b.head(n));
    const double determinant = (1 + ma) * (1 + fb) - mb * fa;
    const double alpha = (-ma * (1 + fb) + mb * fa) / determinant;
    const double beta = -fa / determinant;
    step = -(1 + alpha) * a.tail(n) - beta * b.tail(n);
    return step.allFinite();
  }

 private:
  Run& run_;
  lcp::SparseLu lu_, lm_;
};

constexpr double sigma = 1e-4;      // Armijo
constexpr int max_backtracks = 20;  // of a step
constexpr double longest = 10;      // a full step, relative to 1 + ||x||
constexpr int damping_tries = 4;
constexpr double damping_growth = 100;

/// log ||M Phi|| and what it is made of.
struct Merit {
  const CFunction& c;
  const DeflationOperator& M;
  const Box& box;
  double operator()(In x, In F) const {
    const double psi = merit(c, box, x, F);
    return psi > 0 ? M.log_value(x) + 0.5 * std::log(2 * psi) : -infinity;
  }
};

/// Takes x + t step, t = 1, 1/2, ..., where F and J are defined and, if searching, log ||M Phi|| is at most `reference`
/// + log(1 + sigma t slope). `slope` is that of log ||M Phi|| along the step: -1 for a Newton step.
struct DeflatedSearch {
  Run& run;
  const Merit& value;
  bool searching;
  double reference;
  Iteration& it;

  bool take(const Vec& step, double slope, Point& point) const {
    if (!(slope < 0)) return false;
    Point trial;
    double t = std::min(1.0, longest * (1 + point.x.norm()) / step.norm());
    for (int k = 0; k <= max_backtracks; ++k, t *= 0.5) {
      trial.x = point.x + t * step;
      if (trial.x == point.x) return false;
      if (run.counted().eval(trial.x, trial.F)) {
        const double reached = value(trial.x, trial.F);
        const bool enough = !searching || reached <= reference + std::log(std::max(1 + sigma * t * slope, 1e-16));
        if (enough && reached < infinity && run.counted().jacobian(trial.x, trial.J)) {
          std::swap(point, trial);
          it.step = t;
          it.merit = std::exp(2 * std::min(reached, 300.0)) / 2;
          return true;
        }
      }
      ++it.backtracks;
    }
    return false;
  }
};

}  // namespace

void deflated_newton(Run& run, const DeflationTry& attempt, const std::vector<DeflationOperator::Root>& roots,
                     Point point) {
  const DeflationOperator M(roots, attempt.p, attempt.sigma);
  const Merit value{.c = attempt.cfunction, .M = M, .box = run.box()};
  DeflatedSteps steps(run);
  Memory memory(5);
  Stall stall(30);
  Linearisation lin;
  Iteration it{.k = 0, .kind = 'I'};
  double current = value(point.x, point.F);
  memory.push(current);
  while (run.go_on(point, it)) {
    it = {.k = it.k + 1};
    linearise(attempt.cfunction, run.box(), point, lin);
    const Vec m = M.log_gradient(point.x);
    // grad log ||M Phi|| = H'Phi / ||Phi||^2 + m
    const Vec gradient = lin.gradient / (2 * lin.merit) + m;
    const DeflatedSearch search{.run = run,
                                .value = value,
                                .searching = attempt.search,
                                .reference = attempt.search ? memory.reference() : infinity,
                                .it = it};
    Vec step;
    it.kind = 'N';
    bool done = steps.newton(lin, m, step) && search.take(step, -1, point);
    double nu = 1e-6 * std::max(1e-8, lin.H.squaredNorm() / static_cast<double>(m.size()));
    for (int k = 0; k < damping_tries && !done; ++k, nu *= damping_growth) {
      it.kind = 'L';
      it.prox = nu;
      done = steps.levenberg_marquardt(lin, m, nu, step) && search.take(step, gradient.dot(step), point);
    }
    if (!done) {
      run.end(Status::NoProgress, "no direction decreases the deflated merit function", "");
      continue;
    }
    current = value(point.x, point.F);
    memory.push(current);
    if (attempt.search && stall.stalled(std::exp(std::min(current, 300.0))))
      run.end(Status::NoProgress, "the deflated merit function has stopped falling", "");
  }
}

}  // namespace perp::ncp
