// SPDX-License-Identifier: Apache-2.0
#include "app/worker/worker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <new>

#include "app/campaign/cell.hpp"
#include "app/campaign/process.hpp"
#include "app/campaign/selection.hpp"
#include "app/problem/problem.hpp"
#include "app/worker/external.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::app::compare {

namespace {

using Clock = std::chrono::steady_clock;

Answer describe(const Task& task) {
  const LoadedProblem problem = load_problem(ProblemSource{.problem = task.problem});
  Answer answer;
  AskedProblem& described = answer.described;
  described.n = problem.mcp->size();
  described.nonzeros = problem.mcp->jacobian_pattern().nonZeros();
  described.affine = problem.mcp->is_affine();
  described.starts = problem.starts;
  described.known_solutions = static_cast<int>(problem.solutions.size());
  described.no_solution = problem.no_solution;
  if (task.problem.find('/') != std::string::npos) described.crc = file_crc(task.problem);
  return answer;
}

Answer solve(const Task& task, Clock::time_point begin, const std::atomic<bool>* interrupt) {
  const LoadedProblem problem = load_problem(ProblemSource{.problem = task.problem, .start = task.rule.start});
  const ncp::Mcp& mcp = *problem.mcp;
  ncp::Method method = settings_of(task.method, task.tol).settings.method;
  Answer answer;
  if (std::holds_alternative<ncp::Affine>(method) && !mcp.is_affine()) {
    answer.not_applicable = true;
    answer.message = "the method is for affine problems, and this one does not say it is one";
    return answer;
  }
  ncp::Stop& stop = ncp::stop(method);
  stop.interrupt = interrupt;
  const double margin = std::clamp(0.02 * task.time_limit, 0.05, 1.0);
  stop.max_time = std::min(
      stop.max_time, std::chrono::duration<double>(std::max(1e-3, task.time_limit - margin - seconds_since(begin))));
  const ncp::Vec x0 = perturbed(mcp.box(), problem.x0, task.rule);
  const Clock::time_point solving = Clock::now();
  const ncp::Result result = ncp::solve(mcp, x0, method, [&](const ncp::Iteration& it) {
    answer.curve.push_back(it.residual);
    return ncp::Next::Continue;
  });
  answer.seconds = seconds_since(solving);
  answer.curve = thinned(answer.curve);
  answer.status = ncp::to_string(result.status);
  answer.claimed = result.solved();
  answer.to_rounding = result.status == ncp::Status::SolvedToRounding;
  answer.infeasible = answer.proven = result.status == ncp::Status::Infeasible;
  answer.not_applicable = result.status == ncp::Status::NotApplicable;
  answer.time_limit = result.status == ncp::Status::TimeLimit;
  answer.message = result.message;
  answer.out_of_memory = result.status == ncp::Status::OutOfMemory;
  const ncp::Stats& stats = result.stats;
  answer.iterations = stats.iterations;
  answer.F_evals = stats.F_evals;
  answer.J_evals = stats.J_evals;
  answer.factorizations = stats.factorizations;
  answer.krylov_iterations = stats.krylov_iterations;
  answer.has_x = result.x.size() == mcp.size();
  if (answer.has_x) write_point(task.folder, result.x);
  return answer;
}

/// A point that is out of its bounds by rounding only is judged at the bounds, where F is defined.
double natural_residual(const ncp::Mcp& mcp, ncp::In x, double tol) {
  const ncp::Vec inside = lcp::project(mcp.box(), x);
  const double out = x.allFinite() && x.size() > 0 ? (x - inside).lpNorm<Eigen::Infinity>() : 0;
  if (x.allFinite() && out <= tol) return std::max(out, ncp::residual(mcp, inside).natural);
  return ncp::residual(mcp, x).natural;
}

Answer judge(const Task& task) {
  const LoadedProblem problem = load_problem(ProblemSource{.problem = task.problem});
  ncp::Vec x = read_point(task.folder);
  Answer answer;
  // A .sol file has the model's own variables. Those of side inequalities, 0 <= y _|_ v - b - y >= 0, are best at 0:
  // the residual is then what v falls short of b.
  if (problem.model != nullptr && x.size() == problem.own_variables()) {
    x.conservativeResize(problem.mcp->size());
    x.tail(problem.mcp->size() - problem.own_variables()).setZero();
  }
  if (x.size() != problem.mcp->size()) throw input_error("{} values for {} variables", x.size(), problem.mcp->size());
  answer.natural = natural_residual(*problem.mcp, x, task.tol);
  answer.to_rounding = x.allFinite() && ncp::accuracy(*problem.mcp, lcp::project(problem.mcp->box(), x)).to_rounding;
  return answer;
}

Answer run(const Task& task, Clock::time_point begin, const std::atomic<bool>* interrupt) {
  switch (task.role) {
    case Task::Role::Describe:
      return describe(task);
    case Task::Role::Solve:
      return solve(task, begin, interrupt);
    case Task::Role::External:
      return run_external(task);
    case Task::Role::Judge:
      return judge(task);
  }
  return {};
}

Answer refusal(const std::string& why) {
  Answer answer;
  answer.refused = why;
  return answer;
}

}  // namespace

std::vector<double> thinned(const std::vector<double>& curve) {
  if (curve.size() <= longest_curve) return curve;
  std::vector<double> few(longest_curve);
  for (std::size_t k = 0; k < longest_curve; ++k) few[k] = curve[k * (curve.size() - 1) / (longest_curve - 1)];
  return few;
}

int worker(const std::string& text, const std::atomic<bool>* interrupt) {
  const Clock::time_point begin = Clock::now();
  std::string folder;
  Answer answer;
  try {
    const Task task = parse_task(text);
    folder = task.folder;
    answer = run(task, begin, interrupt);
  } catch (const std::bad_alloc&) {
    answer = {};
    answer.out_of_memory = true;
  } catch (const InputError& error) {
    answer = refusal(error.what());
  } catch (const ncp::ampl::ModelError& error) {
    answer = refusal(error.what());
  } catch (const lcp::FileError& error) {
    answer = refusal(error.what());
  } catch (const std::invalid_argument& error) {  // the library's door
    answer = refusal(error.what());
  }
  if (folder.empty()) {
    std::cerr << "perp: " << answer.refused << '\n';
    return exit_input;
  }
  write_answer(folder, answer);
  return exit_solved;
}

}  // namespace perp::app::compare
