#include <array>
#include <limits>

#include "app/options_parts.hpp"

namespace perp::app {

namespace {

constexpr double max_int = std::numeric_limits<int>::max();

constexpr std::array crash_choices{Choice{"pnewton", 1}, Choice{"none", 0}};
constexpr std::array merit_choices{Choice{"fischer", static_cast<int>(ncp::PathMerit::Fischer)},
                                   Choice{"normal", static_cast<int>(ncp::PathMerit::NormalMap)}};
constexpr std::array search_choices{Choice{"path", static_cast<int>(ncp::Searchtype::Path)},
                                    Choice{"line", static_cast<int>(ncp::Searchtype::Line)},
                                    Choice{"arc", static_cast<int>(ncp::Searchtype::Arc)}};
constexpr std::array restart_choices{Choice{"own", static_cast<int>(ncp::PathRestarts::Own)},
                                     Choice{"documented", static_cast<int>(ncp::PathRestarts::Documented)}};
constexpr auto synonym = Choice::Role::Synonym;
constexpr std::array switch_choices{
    Choice{"yes", 1},         Choice{"no", 0},           Choice{"true", 1, synonym}, Choice{"false", 0, synonym},
    Choice{"on", 1, synonym}, Choice{"off", 0, synonym}, Choice{"1", 1, synonym},    Choice{"0", 0, synonym}};

/// The field, if the method is PathSearch or tries it.
template <class Get>
Field of_path(Settings& settings, Get get) {
  if (ncp::PathSearch* path = ncp::path_of(settings.method)) return get(*path);
  return {};
}

/// The crash's, and the non-monotone stabilisation's, where these are on.
template <class Get>
Field of_crash(Settings& settings, Get get) {
  return of_path(settings, [&](auto& path) -> Field {
    if (!path.crash.on) return NoEffect{"crash_method = none"};
    return get(path.crash);
  });
}

template <class Get>
Field of_nms(Settings& settings, Get get) {
  return of_path(settings, [&](auto& path) -> Field {
    if (!path.nms.on) return NoEffect{"nms = no"};
    return get(path.nms);
  });
}

/// What is printed, and what that depends on.
Field output_switch(Settings& settings, Switch Output::*part) {
  Output& output = settings.output;
  return Word{switch_choices, [&output, part] { return output.shows(output.*part) ? 1 : 0; },
              [&output, part](int value) { (output.*part).given = value != 0; }};
}

}  // namespace

std::vector<Option> path_search_options() {
  return {
      {"crash_method",
       {},
       {},
       "projected Newton steps before the first linearised problem: pnewton or none",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return word(m.crash.on, crash_choices); }); }},
      {"crash_iteration_limit",
       {},
       {0, max_int},
       "of the crash",
       [](Settings& s) { return of_crash(s, [](auto& m) -> Field { return &m.iteration_limit; }); }},
      {"crash_minimum_dimension",
       {},
       {0, max_int},
       "smaller problems go without a crash",
       [](Settings& s) { return of_crash(s, [](auto& m) -> Field { return &m.minimum_dimension; }); }},
      {"crash_nbchange_limit",
       {},
       {0, max_int},
       "the crash ends where fewer variables than this come to a bound or leave it",
       [](Settings& s) { return of_crash(s, [](auto& m) -> Field { return &m.nbchange_limit; }); }},
      {"crash_least_step",
       {},
       {0, 1, true, false},
       "the crash ends where its step would be shorter",
       [](Settings& s) { return of_crash(s, [](auto& m) -> Field { return &m.least_step; }); }},
      {"nms",
       {},
       {},
       "non-monotone stabilisation: D-steps, watchdog, reference values; no: every step must descend",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.nms.on; }); }},
      {"nms_initial_reference_factor",
       {},
       {1, 1e100},
       "the reference values begin at this multiple of the first merit",
       [](Settings& s) { return of_nms(s, [](auto& m) -> Field { return &m.initial_reference_factor; }); }},
      {"nms_mstep_frequency",
       {},
       {1, max_int},
       "iterations between two tests of the merit",
       [](Settings& s) { return of_nms(s, [](auto& m) -> Field { return &m.mstep_frequency; }); }},
      {"nms_maximum_watchdogs",
       {},
       {0, max_int},
       "returns to a checkpoint after which D-steps are no longer taken",
       [](Settings& s) { return of_nms(s, [](auto& m) -> Field { return &m.maximum_watchdogs; }); }},
      {"nms_searchtype",
       {},
       {},
       "where points are tried: path (the piecewise-linear one, with its kinks), line (straight to the Newton point) "
       "or "
       "arc (the projection of the straight way of the normal map)",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return word(m.search, search_choices); }); }},
      {"distance_decrease",
       {},
       {0, 1, true, false},
       "factor a D-step of the distance up to which Newton points go untested",
       [](Settings& s) { return of_nms(s, [](auto& m) -> Field { return &m.distance_decrease; }); }},
      {"merit_function",
       {},
       {},
       "fischer (Fischer-Burmeister) or normal (the normal map): half of its squared norm",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return word(m.merit, merit_choices); }); }},
      {"proximal_perturbation",
       {},
       {0, 1e100},
       "lambda of the proximal term lambda (z - z^k) to begin with, relative to the size of the Jacobian",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.proximal_perturbation; }); }},
      {"proximal_adaptive",
       {},
       {},
       "lambda > 0 also where a basis is singular or the path leads nowhere",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.proximal_adaptive; }); }},
      {"gradient_step_limit",
       {},
       {0, max_int},
       "projected gradient steps, taken where nothing else descends",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.gradient_step_limit; }); }},
      {"restart_limit",
       {},
       {0, max_int},
       "attempts after the first, so many of them: 'perp methods --show path'",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.restart_limit; }); }},
      {"restarts",
       {},
       {},
       "of these attempts: our own, other options and then other methods, or the three that PATH documents",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return word(m.restarts, restart_choices); }); }},
      {"cumulative_iteration_limit",
       {},
       {1, max_int},
       "pivots in all",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.cumulative_iteration_limit; }); }},
      {"preprocess",
       {},
       {},
       "presolve: take out what constant rows and columns decide",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.preprocess; }); }},
      {"scaling",
       {},
       {},
       "of rows and columns, where it helps; a solution is judged unscaled all the same",
       [](Settings& s) { return of_path(s, [](auto& m) -> Field { return &m.scaling; }); }},
  };
}

std::vector<Option> output_options() {
  return {
      {"output",
       {},
       {},
       "print the log (from AMPL: no, unless asked for); parts can be turned on and off by themselves",
       [](Settings& s) -> Field { return &s.output.all; }},
      {"output_crash_iterations",
       {},
       {},
       "print the table of the crash",
       [](Settings& s) { return output_switch(s, &Output::crash_iterations); }},
      {"output_crash_iterations_frequency",
       {},
       {1, max_int},
       "every line of it, every 2nd, ...",
       [](Settings& s) -> Field { return &s.output.crash_frequency; }},
      {"output_major_iterations",
       {},
       {},
       "print the table of the iterations",
       [](Settings& s) { return output_switch(s, &Output::major_iterations); }},
      {"output_major_iterations_frequency",
       {},
       {1, max_int},
       "every line of it, every 2nd, ...",
       [](Settings& s) -> Field { return &s.output.major_frequency; }},
      {"output_restart_log",
       {},
       {},
       "say which attempt begins",
       [](Settings& s) { return output_switch(s, &Output::restart_log); }},
      {"output_initial_statistics",
       {"output_initial_point_statistics"},
       {},
       "print the largest entries of x, F and the Jacobian at the start",
       [](Settings& s) { return output_switch(s, &Output::initial_statistics); }},
      {"output_final_statistics",
       {"output_final_point_statistics"},
       {},
       "print the residuals at the end, with the worst equation, and the largest entries of x and F",
       [](Settings& s) { return output_switch(s, &Output::final_statistics); }},
      {"output_final_summary",
       {},
       {},
       "print how many iterations, evaluations, ... there were",
       [](Settings& s) { return output_switch(s, &Output::final_summary); }},
      {"output_options",
       {},
       {},
       "print the options in force",
       [](Settings& s) { return output_switch(s, &Output::options); }},
  };
}

std::span<const std::string_view> path_options() {
  static const std::vector<std::string_view> names{"convergence_tolerance",
                                                   "crash_iteration_limit",
                                                   "crash_merit_function",
                                                   "crash_method",
                                                   "crash_minimum_dimension",
                                                   "crash_nbchange_limit",
                                                   "crash_perturb",
                                                   "crash_searchtype",
                                                   "cumulative_iteration_limit",
                                                   "factorization_method",
                                                   "gradient_searchtype",
                                                   "gradient_step_limit",
                                                   "interrupt_limit",
                                                   "lemke_rank_deficiency_iterations",
                                                   "lemke_start",
                                                   "lemke_start_type",
                                                   "logfile",
                                                   "major_iteration_limit",
                                                   "merit_function",
                                                   "minor_iteration_limit",
                                                   "nms",
                                                   "nms_initial_reference_factor",
                                                   "nms_maximum_watchdogs",
                                                   "nms_memory_size",
                                                   "nms_mstep_frequency",
                                                   "nms_searchtype",
                                                   "output",
                                                   "output_crash_iterations",
                                                   "output_crash_iterations_frequency",
                                                   "output_errors",
                                                   "output_factorization_singularities",
                                                   "output_final_degeneracy_statistics",
                                                   "output_final_point",
                                                   "output_final_point_statistics",
                                                   "output_final_scaling_statistics",
                                                   "output_final_statistics",
                                                   "output_final_summary",
                                                   "output_initial_point",
                                                   "output_initial_point_statistics",
                                                   "output_initial_scaling_statistics",
                                                   "output_initial_statistics",
                                                   "output_initial_summary",
                                                   "output_linear_model",
                                                   "output_major_iterations",
                                                   "output_major_iterations_frequency",
                                                   "output_minor_iterations",
                                                   "output_minor_iterations_frequency",
                                                   "output_model_statistics",
                                                   "output_options",
                                                   "output_preprocess",
                                                   "output_restart_log",
                                                   "output_time",
                                                   "output_warnings",
                                                   "preprocess",
                                                   "proximal_perturbation",
                                                   "restart_limit",
                                                   "return_best_point",
                                                   "statusfile",
                                                   "time_limit"};
  return names;
}

std::span<const std::string_view> ignored_options() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> rest(path_options().begin(), path_options().end());
    for (const Option& option : options()) {
      std::erase(rest, option.key);
      for (const std::string_view alias : option.aliases) std::erase(rest, alias);
    }
    return rest;
  }();
  return names;
}

}  // namespace perp::app
