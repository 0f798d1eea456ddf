// SPDX-License-Identifier: Apache-2.0

#include "ncp/settings/settings.hpp"

namespace perp::settings {

void describe(Output& output, ncp::Fields& f) {
  const auto add = [&](std::string_view key, Switch& part, std::string_view help, std::string_view alias = {}) {
    f.add(key, ncp::Flag{[&output, &part] { return output.shows(part); }, [&part](bool on) { part.given = on; }}, help,
          alias);
  };
  const std::string_view every = "every line of it, every 2nd, ...";
  f.add("output", &output.all,
        "print the log (from AMPL: no, unless asked for); parts can be turned on and off by themselves");
  add("output_crash_iterations", output.crash_iterations, "print the table of the crash");
  f.add("output_crash_iterations_frequency", &output.crash_frequency, ncp::at_least(1), every);
  add("output_major_iterations", output.major_iterations, "print the table of the iterations");
  f.add("output_major_iterations_frequency", &output.major_frequency, ncp::at_least(1), every);
  add("output_restart_log", output.restart_log, "say which attempt begins");
  add("output_initial_statistics", output.initial_statistics,
      "print the largest entries of x, F and the Jacobian at the start", "output_initial_point_statistics");
  add("output_final_statistics", output.final_statistics,
      "print the residuals at the end, with the worst equation, and the largest entries of x and F",
      "output_final_point_statistics");
  add("output_final_summary", output.final_summary, "print how many iterations, evaluations, ... there were");
  add("output_options", output.options, "print the options in force");
}

ncp::TableOptions table_options(const Output& output) {
  return {.crash = output.shows(output.crash_iterations),
          .major = output.shows(output.major_iterations),
          .restarts = output.shows(output.restart_log),
          .crash_frequency = output.crash_frequency,
          .major_frequency = output.major_frequency};
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
      std::erase(rest, option.alias);
    }
    return rest;
  }();
  return names;
}

}  // namespace perp::settings
