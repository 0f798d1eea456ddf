// SPDX-License-Identifier: Apache-2.0
/// De Saxce & Feng's projection with a step length of its own, and Korpelevich's extragradient method with Khobotov's.
#include "contact/classics/classics.hpp"
#include "contact/classics/trial.hpp"

namespace perp::contact {
namespace {

template <class Method>
void describe_projection(Method& m, Fields& f) {
  describe(m.rule, f);
  describe_loop(m.max_iterations, m.scaling, f);
}

/// `corrects`: each step is made from r again, with F of where it led.
template <class Method>
void project(Trial& trial, const Scaled& problem, const Method& method, const Vec& start, bool corrects) {
  const ContactVi vi(problem);
  Vec r = vi.project(start_or_zero(problem, start));
  Vec F = vi.F(r);
  double rho = method.rule.rho;
  for (int k = 0; k < method.max_iterations && F.allFinite(); ++k) {
    ContactVi::Prediction next = vi.predict(method.rule, r, F, rho);
    if (corrects) {
      next.r = vi.project(r - next.rho * next.F);
      next.F = vi.F(next.r);
    }
    const bool done = next.r == r;
    r = std::move(next.r);
    F = std::move(next.F);
    if (trial.cheap_step(r, {.step = next.rho})) return;
    if (done) break;
  }
  trial.judge_iterate(r, {.step = rho});
}

}  // namespace

void describe(FixedPoint& m, Fields& f) { describe_projection(m, f); }
void describe(Extragradient& m, Fields& f) { describe_projection(m, f); }

void iterate(Trial& trial, const Scaled& problem, const FixedPoint& method, const Vec& start) {
  project(trial, problem, method, start, false);
}
void iterate(Trial& trial, const Scaled& problem, const Extragradient& method, const Vec& start) {
  project(trial, problem, method, start, true);
}

}  // namespace perp::contact
