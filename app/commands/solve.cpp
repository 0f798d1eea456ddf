// SPDX-License-Identifier: Apache-2.0
#include "app/commands/solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <ostream>
#include <utility>

#include "app/problem/warm_start.hpp"
#include "app/program/files.hpp"
#include "app/report/bounded_run.hpp"
#include "app/report/json.hpp"
#include "app/report/plot.hpp"
#include "app/report/report.hpp"
#include "lcp/io/matrix_market.hpp"

namespace perp::app {

namespace {

std::vector<Assignment> assignments(const SolveRequest& request) {
  std::vector<Assignment> all;
  if (!request.options_file.empty()) all = read_options_file(request.options_file);
  for (const std::string& option : request.options) all.push_back(parse_assignment(option, "--option"));
  all.insert(all.end(), request.flags.begin(), request.flags.end());
  return all;
}

/// Flags that contradict each other.
void check_request(const SolveRequest& request) {
  if (!request.warm_start.empty() && (!request.start_at.empty() || request.start))
    throw input_error("--warm-start and {} both say where to start", request.start ? "--start" : "--start-at");
  if (request.plot_iteration && request.plot.empty())
    throw input_error("--plot-iteration {} says which iteration --plot FILE draws, which is not given",
                      *request.plot_iteration);
  if (request.plot_iteration && *request.plot_iteration < 1)
    throw input_error("--plot-iteration {}: iterations are counted from 1", *request.plot_iteration);
}

ProblemSource source_of(const SolveRequest& request) {
  return {.problem = request.problem,
          .q = request.q,
          .lower = request.lower,
          .upper = request.upper,
          .rows = request.rows,
          .row_lower = request.row_lower,
          .row_upper = request.row_upper,
          .start_at = request.start_at,
          .start = request.start};
}

/// Can what is asked for be written, and does it leave the input alone? A refusal is not written as JSON then.
bool files_fit(const SolveRequest& request, Streams streams) {
  std::vector<FileUse> inputs = files_of(source_of(request));
  inputs.push_back({"--options-file", request.options_file});
  inputs.push_back({"--warm-start", request.warm_start});
  const std::vector<FileUse> outputs{
      {"--json", request.json}, {"--plot", request.plot}, {"--solution", request.solution}};
  return outputs_fit(outputs, inputs, streams);
}

/// Writes the picture. Throws InputError.
void draw(const SolveRequest& request, const Report& report, const WayKeeper& ways, Streams streams) {
  if (request.plot_iteration && !ways.kept() && request.log_level >= LogLevel::Warning)
    streams.err << fmt::format(
        "perp: note: --plot-iteration {}: that iteration was not reached, or followed no path; the picture is "
        "without\n",
        *request.plot_iteration);
  write_file(request.plot, plot_svg(report, ways.kept()));
}

/// Everything between reading the input and writing JSON. Throws what run_method() does.
Report run_and_print(const SolveRequest& request, const std::shared_ptr<const LoadedProblem>& loaded,
                     const Applied& options, Streams streams, const Patience& patience, ncp::Observer observer) {
  const LoadedProblem& problem = *loaded;
  std::ostream& log = request.json == "-" ? streams.err : streams.out;
  const auto shows = [&](LogLevel level) { return request.log_level >= level; };
  if (shows(LogLevel::Warning))
    for (const std::string& note : options.notes) streams.err << "perp: note: " << note << '\n';
  if (shows(LogLevel::Info)) print_heading(log, problem, options.settings);
  const Output& output = options.settings.output;
  const auto shows_part = [&](const Switch& part) { return shows(LogLevel::Info) && output.shows(part); };
  if (shows(LogLevel::Debug) || shows_part(output.options)) print_options(log, options.settings);
  if (shows_part(output.initial_statistics)) print_initial_statistics(log, problem);
  const bool table = shows(LogLevel::Info) && output.table();
  if (table) log << '\n';
  const bool writes = request.full || !request.json.empty() || !request.solution.empty();
  Report report = run_within(patience, loaded, options.settings, writes ? problem.mcp->size() : 0,
                             table ? &log : nullptr, std::move(observer));
  writing_takes(patience_with_writing(problem.mcp->size()));
  report.notes = options.notes;
  if (shows(LogLevel::Info)) {
    log << '\n';
    print_notes(log, report);
    if (!report.result.notes.empty()) log << '\n';
    print_solution(log, report, request.full);
    log << '\n';
  }
  if (shows(LogLevel::Summary)) {
    if (!shows(LogLevel::Info)) print_notes(log, report);
    print_verdict(log, report);
    if (shows_part(output.final_statistics)) print_final_statistics(log, report);
    if (shows_part(output.final_summary))
      print_final_summary(log, report);
    else
      print_short_summary(log, report);
    print_remarks(log, report);
    print_all_solutions(log, report, request.full);
    print_several(log, report, request.full);
  }
  log.flush();
  return report;
}

/// The problem, and the options that depend on it.
std::shared_ptr<const LoadedProblem> load(const SolveRequest& request, Applied& options, const Patience& patience) {
  const auto changed = std::make_shared<Applied>(options);
  auto problem = load_within(
      patience,
      [request, changed] {
        LoadedProblem made = load_problem(source_of(request));
        changed->settings.solutions = request.all;
        note_limits_of_size(made.mcp->size(), *changed);
        if (!request.warm_start.empty()) set_warm_start(read_warm_start(request.warm_start, *made.mcp), made, *changed);
        return made;
      },
      fmt::format("'{}' was being read", request.problem));
  options = std::move(*changed);
  return problem;
}

ExitCode solve_within_limits(const SolveRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  Applied options = apply_options(assignments(request));
  check_request(request);
  const Patience limits = patience(ncp::stop(options.settings.method).max_time, interrupt);
  end_by(limits.deadline);
  const auto problem = load(request, options, limits);
  const ncp::PathSearch* path = ncp::path_of(options.settings.method);
  const auto ways =
      std::make_shared<WayKeeper>(request.plot_iteration, path != nullptr ? path->merit : ncp::PathMerit::Fischer);
  ncp::Observer observer;
  if (!request.plot.empty())
    observer = ncp::of_ways([ways, keep = ways->observer()](const ncp::Iteration& it) { return keep(it); });
  const Report report = run_and_print(request, problem, options, streams, limits, std::move(observer));
  if (!request.plot.empty()) draw(request, report, *ways, streams);
  if (!request.solution.empty()) lcp::write_vector(request.solution, report.result.x, "solution of " + problem->label);
  const bool delivered = request.json.empty() || deliver_json(request.json, solve_json(report), streams);
  return delivered ? report.exit_code() : exit_input;
}

}  // namespace

std::span<const std::string_view> log_level_names() {
  static constexpr std::array<std::string_view, 5> names{"quiet", "warning", "summary", "info", "debug"};
  return names;
}

LogLevel log_level(std::string_view name) {
  const auto names = log_level_names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw input_error("--log-level: '{}' is none of {}", name, fmt::join(names, ", "));
  return static_cast<LogLevel>(found - names.begin());
}

ExitCode solve(const SolveRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  if (!files_fit(request, streams)) return exit_input;
  ExitCode code = exit_solved;
  std::string why;
  try {
    why = refusal(request.problem, [&] { code = solve_within_limits(request, streams, interrupt); });
  } catch (const OutOfTime& out) {
    say_refused(streams, out.what());
    const bool delivered = deliver_json(request.json, no_point_json(request.problem, out), streams);
    return delivered ? exit_unsolved : exit_input;
  }
  return why.empty() ? code : deliver_refusal(request.json, request.problem, why, streams);
}

}  // namespace perp::app
