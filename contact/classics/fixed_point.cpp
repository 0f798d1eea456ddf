// SPDX-License-Identifier: Apache-2.0
/// De Saxce & Feng's projection, with a step length of its own.
#include "contact/classics/classics.hpp"
#include "contact/classics/trial.hpp"

namespace perp::contact {

void describe(FixedPoint& m, Fields& f) {
  describe(m.rule, f);
  describe_loop(m.max_iterations, m.scaling, f);
}

void iterate(Trial& trial, const Scaled& problem, const FixedPoint& method, const Vec& start) {
  const ContactVi vi(problem);
  Vec r = vi.project(start_or_zero(problem, start));
  Vec F = vi.F(r);
  double rho = method.rule.rho;
  for (int k = 0; k < method.max_iterations && F.allFinite(); ++k) {
    ContactVi::Prediction next = vi.predict(method.rule, r, F, rho);
    const bool done = next.r == r;
    r = std::move(next.r);
    F = std::move(next.F);
    if (trial.cheap_step(r, {.step = next.rho})) return;
    if (done) break;
  }
  trial.judge_iterate(r, {.step = rho});
}

}  // namespace perp::contact
