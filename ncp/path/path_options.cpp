// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/path_search.hpp"

namespace perp::ncp {

void describe(Crash& c, Fields& f) {
  f.choice("crash_method", &c.on, {{"pnewton", true}, {"none", false}},
           "projected Newton steps before the first linearised problem: pnewton or none");
  f.when(c.on, "crash_method = none", [&] {
    f.add("crash_iteration_limit", &c.iteration_limit, at_least(0), "limit of iterations of the crash");
    f.add("crash_minimum_dimension", &c.minimum_dimension, at_least(0), "smaller problems go without a crash");
    f.add("crash_nbchange_limit", &c.nbchange_limit, at_least(0),
          "the crash ends where fewer variables than this come to a bound or leave it");
  });
}

void describe(Nms& n, Fields& f) {
  describe_memory(n.memory, f);
  f.add("nms", &n.on, "non-monotone stabilisation: D-steps, watchdog, reference values; no: every step must descend");
  f.when(n.on, "nms = no", [&] {
    f.add("nms_initial_reference_factor", &n.initial_reference_factor, between(1, 1e100),
          "the reference values begin at this multiple of the first merit");
    f.add("nms_mstep_frequency", &n.mstep_frequency, at_least(1), "iterations between two tests of the merit");
    f.add("nms_maximum_watchdogs", &n.maximum_watchdogs, at_least(0),
          "returns to a checkpoint after which D-steps are no longer taken");
  });
}

void describe(PathSearch& m, Fields& f) {
  describe_search(m.sigma, m.beta, m.max_backtracks, f);
  f.add("chord_steps", &m.chord_steps, between(0, 1000),
        "simplified Newton steps with the last matrix after a Newton point, while they pay");
  f.add("patience", &m.patience, at_least(1),
        "iterations in which the best merit must fall by 1 %, or the attempt is given up");
  f.choice("lemke_start", &m.start,
           {{"automatic", PathStart::Automatic}, {"first", PathStart::First}, {"always", PathStart::Always}},
           lemke_start_help);
  describe(m.lemke, f);
  describe(m.crash, f);
  describe(m.nms, f);
  f.choice(
      "nms_searchtype", &m.search, {{"path", Searchtype::Path}, {"line", Searchtype::Line}, {"arc", Searchtype::Arc}},
      "where points are tried: path (the piecewise-linear one, with its kinks), line (straight to the Newton point) "
      "or arc (the projection of the straight way of the normal map)");
  f.choice("merit_function", &m.merit, {{"fischer", PathMerit::Fischer}, {"normal", PathMerit::NormalMap}},
           "fischer (Fischer-Burmeister) or normal (the normal map): half of its squared norm");
  f.add("proximal_perturbation", &m.proximal_perturbation, between(0, 1e100),
        "lambda of the proximal term lambda (z - z^k) to begin with, relative to the size of the Jacobian");
  f.add("gradient_step_limit", &m.gradient_step_limit, at_least(0),
        "projected gradient steps, taken where nothing else descends");
}

}  // namespace perp::ncp
