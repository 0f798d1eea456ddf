// SPDX-License-Identifier: Apache-2.0
#include "app/worker/run_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/worker/external.hpp"

namespace perp::app::compare {

namespace {

namespace fs = std::filesystem;

constexpr double least_for_others = 60;  // s: for the judge and for a problem's description

bool too_large(const RunEnd& end, const Campaign& campaign) {
  return end.process.why == ProcessEnd::Why::MemoryLimit || end.answer.out_of_memory ||
         std::max(end.process.peak_mb, end.answer.peak_mb) > static_cast<double>(campaign.memory_mb);
}

bool timed_out(const RunEnd& end) { return end.process.why == ProcessEnd::Why::TimeLimit || end.answer.time_limit; }

std::string message_of(const RunEnd& end, Outcome outcome, const AskedProblem& problem, const Campaign& campaign) {
  const Answer& answer = end.answer;
  switch (outcome) {
    case Outcome::TimeLimit:
      return end.process.why != ProcessEnd::Why::TimeLimit ? answer.message
             : answer.complete ? fmt::format("told to end after {:g} s", campaign.time_limit)
                               : fmt::format("killed after {:.3g} s", end.process.seconds);
    case Outcome::MemoryLimit:
      return end.process.why == ProcessEnd::Why::MemoryLimit
                 ? fmt::format("killed: more than {} MB", campaign.memory_mb)
             : answer.out_of_memory ? "out of memory"
                                    : fmt::format("used more than {} MB", campaign.memory_mb);
    case Outcome::Crashed:
      return answer.crashed.empty() ? sudden_end(end.process) : answer.crashed;
    case Outcome::Garbage:
      return answer.garbage;
    case Outcome::FalseConvergence:
      if (!problem.solvable())
        return fmt::format("there is no solution: {}; it says: {}", problem.no_solution, answer.message);
      break;
    default:
      break;
  }
  return answer.refused.empty() ? answer.message : fmt::format("refused: {}", answer.refused);
}

}  // namespace

Outcome outcome_of_run(const RunEnd& end, const AskedProblem& problem, const Campaign& campaign) {
  const Answer& answer = end.answer;
  if (too_large(end, campaign)) return Outcome::MemoryLimit;
  if (timed_out(end)) return Outcome::TimeLimit;
  if (!answer.complete || !answer.crashed.empty()) return Outcome::Crashed;
  if (!answer.garbage.empty()) return Outcome::Garbage;
  if (answer.not_applicable) return Outcome::NotApplicable;
  const bool holds = end.natural <= campaign.tol && problem.solvable();
  if (answer.to_rounding && !holds)
    return end.to_rounding && problem.solvable() ? Outcome::SolvedToRounding : Outcome::FalseConvergence;
  if (answer.claimed || answer.to_rounding) return holds ? Outcome::Solved : Outcome::FalseConvergence;
  if (answer.infeasible && !problem.solvable()) return Outcome::Infeasible;
  if (answer.infeasible && answer.proven && !holds && problem.known_solutions == 0) return Outcome::Infeasible;
  if (answer.infeasible && (holds || problem.known_solvable())) return Outcome::FalseInfeasible;
  return holds ? Outcome::Unclaimed : Outcome::Failed;
}

bool is_failure(Outcome outcome) { return !good(outcome) && outcome != Outcome::NotApplicable; }

CellRunner::CellRunner(const Campaign& campaign, std::string program, std::string folder,
                       const std::atomic<bool>* interrupt)
    : campaign_(campaign), program_(std::move(program)), folder_(std::move(folder)), interrupt_(interrupt) {}

CellRunner::~CellRunner() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

ProcessEnd CellRunner::run_task(Task task, const ProcessLimits& limits) {
  task.folder = folder_;
  ProcessEnd end = run_process({.arguments = {program_, "compare-worker", task_json(task)},
                                .log = folder_ + "/log",
                                .limits = limits,
                                .runs_others = task.role == Task::Role::External},
                               interrupt_);
  if (end.why == ProcessEnd::Why::NotStarted)
    throw input_error("a process for '{}' cannot be started: {}", task.problem, end.error);
  return end;
}

std::string CellRunner::log_tail() const {
  constexpr std::size_t most = 300;
  const std::string text = read_text(folder_ + "/log");
  return text.size() <= most ? text : text.substr(text.size() - most);
}

std::optional<RunEnd> CellRunner::attempt(const AskedMethod& method, const AskedProblem& problem, int start, int run) {
  RunEnd end;
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  Task task{.role = method.external() ? Task::Role::External : Task::Role::Solve,
            .problem = problem.file.empty() ? problem.name : problem.file,
            .method = method,
            .tol = campaign_.tol,
            .time_limit = campaign_.time_limit,
            .rule = {.seed = campaign_.seed, .problem = problem.name, .start = start, .run = run}};
  task.method.command = with_tolerance(method.command, campaign_.tol);
  const double grace = std::clamp(0.1 * campaign_.time_limit, 0.5, 2.0);
  end.process = run_task(task, {campaign_.time_limit, grace, campaign_.memory_mb});
  if (end.process.why == ProcessEnd::Why::Interrupted) return std::nullopt;
  end.answer = read_answer(folder_);
  if (!end.answer.complete) end.answer.message = log_tail();
  if (!end.answer.complete || !end.answer.has_x) return end;
  task.role = Task::Role::Judge;
  fs::remove(folder_ + "/result.json");
  const ProcessEnd judging =
      run_task(task, {std::max(least_for_others, 2 * campaign_.time_limit), grace, 2 * campaign_.memory_mb});
  if (judging.why == ProcessEnd::Why::Interrupted) return std::nullopt;
  const Answer judged = read_answer(folder_);
  if (judged.complete && judged.refused.empty())
    end.natural = judged.natural, end.to_rounding = judged.to_rounding;
  else
    end.answer.message += fmt::format(" (the judge: {})", judged.complete ? judged.refused : sudden_end(judging));
  return end;
}

std::optional<Cell> CellRunner::run(const AskedMethod& method, const AskedProblem& problem, int start) {
  const std::optional<RunEnd> first = attempt(method, problem, start, 0);
  if (!first) return std::nullopt;
  const Answer& answer = first->answer;
  Cell cell{.method = method.label, .problem = problem.name, .start = start};
  cell.outcome = outcome_of_run(*first, problem, campaign_);
  cell.status = answer.refused.empty() ? answer.status : "Refused";
  cell.claimed = answer.claimed;
  cell.natural = first->natural;
  cell.iterations = answer.iterations;
  cell.F_evals = answer.F_evals;
  cell.J_evals = answer.J_evals;
  cell.factorizations = answer.factorizations;
  cell.krylov_iterations = answer.krylov_iterations;
  cell.seconds = answer.complete ? answer.seconds : first->process.seconds;
  cell.peak_mb = method.external() && answer.complete ? answer.peak_mb : first->process.peak_mb;
  cell.message = in_one_line(message_of(*first, cell.outcome, problem, campaign_));
  cell.curve = answer.curve;
  cell.outcome_after_restarts = cell.outcome;
  while (problem.solvable() && cell.restarts < campaign_.restarts && is_failure(cell.outcome_after_restarts)) {
    const std::optional<RunEnd> further = attempt(method, problem, start, cell.restarts + 1);
    if (!further) return std::nullopt;
    ++cell.restarts;
    cell.outcome_after_restarts = outcome_of_run(*further, problem, campaign_);
  }
  return cell;
}

std::optional<AskedProblem> CellRunner::describe(const AskedProblem& problem) {
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  const std::string source = problem.file.empty() ? problem.name : problem.file;
  const ProcessEnd end = run_task({.role = Task::Role::Describe, .problem = source},
                                  {std::max(least_for_others, 2 * campaign_.time_limit), 1, 2 * campaign_.memory_mb});
  if (end.why == ProcessEnd::Why::Interrupted) return std::nullopt;
  const Answer answer = read_answer(folder_);
  if (answer.out_of_memory || end.why == ProcessEnd::Why::MemoryLimit) throw InputError(out_of_memory(source));
  if (!answer.refused.empty()) throw InputError(answer.refused);
  if (!answer.complete)
    throw input_error(
        "'{}' cannot be built: {}; {}", source,
        end.why == ProcessEnd::Why::TimeLimit ? fmt::format("not done after {:.3g} s", end.seconds) : sudden_end(end),
        in_one_line(log_tail()));
  AskedProblem described = answer.described;
  described.name = problem.name;
  described.file = problem.file;
  described.cls = problem.cls;
  if (campaign_.starts > 0) described.starts = std::min(described.starts, campaign_.starts);
  return described;
}

}  // namespace perp::app::compare
