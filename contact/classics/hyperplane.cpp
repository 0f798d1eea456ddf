// SPDX-License-Identifier: Apache-2.0
/// Solodov & Svaiter's projection onto a separating hyperplane.
#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/classics/classics.hpp"
#include "contact/classics/trial.hpp"

namespace perp::contact {
namespace {

/// Shorter steps tell nothing apart.
constexpr double shortest_trial = 1e-12;
constexpr int multiplier_steps = 60;  // doublings, and halvings: a double has 53 bits

/// P_{K and H}(r) = P_K(r - lambda F_y) with the least lambda >= 0 for which that is in H: F_y.(x - y) falls with
/// lambda. From P_H(r)'s lambda on, which is too short or right.
Vec project_onto_both(const ContactVi& vi, const Vec& r, const Vec& F_y, const Vec& y, double lambda) {
  const auto beyond = [&](const Vec& x) { return F_y.dot(x - y) > 0; };
  double low = lambda;
  double high = lambda;
  Vec x = vi.project(r - high * F_y);
  for (int k = 0; k < multiplier_steps && beyond(x); ++k) {
    low = high;
    high *= 2;
    x = vi.project(r - high * F_y);
  }
  for (int k = 0; k < multiplier_steps && high - low > 1e-3 * high; ++k) {
    const double middle = (low + high) / 2;
    Vec trial = vi.project(r - middle * F_y);
    if (beyond(trial)) {
      low = middle;
    } else {
      high = middle;
      x = std::move(trial);
    }
  }
  return x;
}

}  // namespace

void describe(Hyperplane& m, Fields& f) {
  f.add("sigma", &m.sigma, strictly_between(0, 1), "share of |r - s|^2 that F(y).(r - s) must have");
  f.add("gamma", &m.gamma, strictly_between(0, 1), "factor of t in the search");
  f.add("theta", &m.theta, at_least(1), "factor of the last t where the next search begins");
  f.add("intersection", &m.intersection, "projects onto cone and half-space at once");
  describe_loop(m.max_iterations, m.scaling, f);
}

void iterate(Trial& trial, const Scaled& problem, const Hyperplane& method, const Vec& start) {
  const ContactVi vi(problem);
  Vec r = vi.project(start_or_zero(problem, start));
  double t = 1;
  for (int k = 0; k < method.max_iterations; ++k) {
    const Vec F = vi.F(r);
    const Vec d = r - vi.project(r - F);
    const double square = d.squaredNorm();
    if (square == 0 || !std::isfinite(square)) break;
    t = std::min(1.0, method.theta * t);
    Vec F_y = vi.F(r - t * d);
    while (F_y.dot(d) < method.sigma * square && t > shortest_trial) {
      t *= method.gamma;
      F_y = vi.F(r - t * d);
    }
    const double lambda = t * F_y.dot(d) / F_y.squaredNorm();  // of P_H(r)
    r = method.intersection ? project_onto_both(vi, r, F_y, r - t * d, lambda) : vi.project(r - lambda * F_y);
    if (trial.cheap_step(r, {.step = t}) || !r.allFinite()) return;
  }
  trial.judge_iterate(r, {.step = t});
}

}  // namespace perp::contact
