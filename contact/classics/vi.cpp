// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/vi.hpp"

#include <algorithm>

namespace perp::contact {
namespace {

/// rho is no longer shortened after so many times: F is not continuous in floating point for ever.
constexpr int most_shortenings = 100;

}  // namespace

void describe(StepRule& rule, Fields& f) {
  f.add("adaptive", &rule.adaptive, "rho follows F");
  f.add("rho", &rule.rho, above(0), "the first step length, in scaled units");
  f.add("shrink", &rule.shrink, strictly_between(0, 1), "factor of rho where l is above longest");
  f.add("grow", &rule.grow, at_least(1), "factor of rho where l is below shortest");
  f.add("longest", &rule.longest, strictly_between(0, 1), "l = rho |F(r) - F(s)| / |r - s| at most");
  f.add("shortest", &rule.shortest, {.low = 0, .high = 1, .open_high = true}, "l below which rho grows");
}

Vec start_or_zero(const Scaled& problem, const Vec& start) {
  return start.size() > 0 ? start : Vec(Vec::Zero(problem.size()));
}

ContactVi::Prediction ContactVi::predict(const StepRule& rule, In r, In F_r, double& rho) const {
  for (int k = 0;; ++k) {
    Prediction to{.r = project(r - rho * F_r), .F = {}, .rho = rho};
    to.F = F(to.r);
    const double moved = (to.r - r).norm();
    if (!rule.adaptive || moved == 0 || k == most_shortenings) return to;
    const double l = rho * (to.F - F_r).norm() / moved;
    if (l <= rule.longest) {
      if (l < rule.shortest) rho *= rule.grow;
      return to;
    }
    rho *= rule.shrink * std::min(1.0, 1 / l);
  }
}

}  // namespace perp::contact
