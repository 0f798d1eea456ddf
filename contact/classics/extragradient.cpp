// SPDX-License-Identifier: Apache-2.0
/// Korpelevich's extragradient method with Khobotov's step length.
#include "contact/classics/classics.hpp"
#include "contact/classics/trial.hpp"

namespace perp::contact {

void describe(Extragradient& m, Fields& f) {
  describe(m.rule, f);
  describe_loop(m.max_iterations, m.scaling, f);
}

void iterate(Trial& trial, const Scaled& problem, const Extragradient& method, const Vec& start) {
  const ContactVi vi(problem);
  Vec r = vi.project(start_or_zero(problem, start));
  double rho = method.rule.rho;
  for (int k = 0; k < method.max_iterations; ++k) {
    const Vec F = vi.F(r);
    if (!F.allFinite()) return;
    const ContactVi::Prediction prediction = vi.predict(method.rule, r, F, rho);
    Vec next = vi.project(r - prediction.rho * prediction.F);
    const bool done = next == r;
    r = std::move(next);
    if (trial.cheap_step(r, {.step = prediction.rho})) return;
    if (done) break;
  }
  trial.judge_iterate(r, {.step = rho});
}

}  // namespace perp::contact
