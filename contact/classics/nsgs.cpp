// SPDX-License-Identifier: Apache-2.0
/// Nonsmooth Gauss-Seidel to the end.
#include "contact/classics/classics.hpp"
#include "contact/classics/gauss_seidel.hpp"
#include "contact/classics/trial.hpp"

namespace perp::contact {

void describe_loop(int& max_iterations, bool& scaling, Fields& f) {
  f.add("max_iterations", &max_iterations, at_least(1), "of the outermost loop");
  f.add("scaling", &scaling, "in the units of the contacts");
}

void describe(Nsgs& m, Fields& f) {
  using enum LocalSolver;
  f.choice("local", &m.local, {{"newton", Newton}, {"projection", Projection}, {"cases", Cases}},
           "what solves the problem of one contact");
  f.add("omega", &m.omega, strictly_between(0, 2), "relaxation");
  describe_loop(m.max_iterations, m.scaling, f);
}

void iterate(Trial& trial, const Scaled& problem, const Nsgs& method, const Vec& start) {
  const GaussSeidel sweeps(problem, method.local, method.omega);
  Vec r = start_or_zero(problem, start);
  Vec u = problem.W * r + problem.q;
  constexpr int refresh = 50;  // u is updated term by term, and drifts
  for (int k = 1; k <= method.max_iterations; ++k) {
    const double change = sweeps.sweep(r, u);
    ++trial.stats.sweeps;
    if (trial.cheap_step(r, {}) || !std::isfinite(change)) return;
    if (k % refresh == 0) u = problem.W * r + problem.q;
    if (change == 0) break;
  }
  trial.judge_iterate(r, {});
}

}  // namespace perp::contact
