// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/options.hpp"

namespace perp::ncp {

void describe(Stop& s, Fields& f) {
  constexpr double years = 1e9;  // of seconds: a limit that no clock overflows with
  f.add("convergence_tolerance", &s.tol, above(0),
        "tol: solved when the natural residual max_i |x_i - mid(l_i, x_i - F_i(x), u_i)| is at most tol", "tol");
  f.add(
      "relative_tolerance", &s.tol_relative, {.low = 0, .open_low = true},
      "R: solved only if also |F_i| <= R t_i in each equation whose variable is not at a bound, where t_i is the size "
      "of the terms of F_i; inf: no such condition",
      "tol_relative");
  f.add("major_iteration_limit", &s.max_iterations, at_least(0),
        "iterations (a linearisation each), of all attempts together, after which to give up; without a limit an "
        "attempt ends after 500 without progress",
        "max_iterations");
  f.add("evaluation_limit", &s.max_F_evals, at_least(1),
        "evaluations of F, of all attempts together, after which to give up; looked at after each iteration",
        "max_F_evals");
  f.add("cumulative_iteration_limit", &s.max_pivots, at_least(1), "limit of pivots in all attempts");
  f.add("time_limit", &s.max_time, strictly_between(0, years), "seconds after which to give up", "max_time");
  f.add("stall_limit", &s.max_stall, strictly_between(0, years),
        "seconds without progress, and 100 iterations, after which to give up: the best residual has not fallen by a "
        "tenth",
        "max_stall");
  f.add("check_derivatives", &s.check_derivatives,
        "compare the Jacobian with differences of F at the start, and refuse a problem whose Jacobian is wrong");
}

void describe(Armijo& a, Fields& f) {
  describe_memory(a.memory, f);
  describe_search(a.sigma, a.beta, a.max_backtracks, f);
}

void describe(Escape& e, Fields& f) {
  f.add("escape_rounds", &e.rounds, at_least(0),
        "proximal problems  F(x) + lambda (x - xbar)  that are tried when the method is stuck");
  f.when(e.rounds != 0, "escape_rounds = 0", [&] {
    f.add("escape_lambda", &e.lambda, above(0), "first lambda of an escape, in units of sqrt(|J|_1 |J|_inf)");
  });
}

void describe_search(double& sigma, double& beta, int& max_backtracks, Fields& f) {
  f.add("sigma", &sigma, strictly_between(0, 1), "line search: required share of the predicted decrease of the merit");
  f.add("beta", &beta, strictly_between(0, 1), "line search: factor of the step length from trial to trial");
  f.add("max_backtracks", &max_backtracks, between(0, 1000), "line search: trials before the direction is given up");
}

}  // namespace perp::ncp
