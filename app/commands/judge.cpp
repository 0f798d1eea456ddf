// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "app/commands/commands.hpp"
#include "app/report/json.hpp"
#include "app/text/json_parts.hpp"
#include "lcp/io/matrix_market.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/vi.hpp"

namespace perp::app {

namespace {

struct Verdict {
  ncp::Vec x{};
  ncp::Residual residual{};
  bool to_rounding = false;
};

/// Returns the point to judge. A solver that was given an .nl file knows the model's own variables only: those added
/// for side inequalities, 0 <= y _|_ v - b - y >= 0, are best at 0, where the residual is what v falls short of b.
ncp::Vec point_of(const JudgeRequest& request, const LoadedProblem& problem) {
  const ncp::Index n = problem.mcp->size();
  if (request.point.empty()) return problem.x0;
  ncp::Vec x = lcp::read_vector(request.point);
  if (x.size() == problem.own_variables()) {
    x.conservativeResize(n);
    x.tail(n - problem.own_variables()).setZero();
  }
  if (x.size() != n) throw input_error("'{}': {} values for {} variables", request.point, x.size(), n);
  return x;
}

/// Judges a point that is out of its bounds by no more than the tolerance at the bounds, where F is defined.
Verdict verdict_of(const ncp::Mcp& mcp, ncp::Vec x, double tol) {
  const ncp::Vec inside = lcp::project(mcp.box(), x);
  const bool finite = x.allFinite();
  const double out = finite && x.size() > 0 ? (x - inside).lpNorm<Eigen::Infinity>() : 0;
  Verdict verdict{.x = std::move(x)};
  const bool near = finite && out <= tol;
  verdict.residual = ncp::residual(mcp, near ? inside : verdict.x);
  if (near) verdict.residual.natural = std::max(out, verdict.residual.natural);
  if (mcp.polyhedron() != nullptr) {  // multipliers need not be unique: x alone is judged
    lcp::Limits limits;
    limits.tol = tol;
    const lcp::ViResult of_x = ncp::judge_vi(mcp, (near ? inside : verdict.x).head(mcp.polyhedron()->size()), limits);
    verdict.residual.natural = near ? std::max(out, of_x.residual) : of_x.residual;
    verdict.residual.worst = of_x.worst;
    verdict.to_rounding = of_x.accepted();
    return verdict;
  }
  verdict.to_rounding = finite && ncp::accuracy(mcp, inside).to_rounding;
  return verdict;
}

std::string judge_json(const JudgeRequest& request, const LoadedProblem& problem, const Verdict& verdict,
                       ExitCode code) {
  const ncp::Mcp& mcp = *problem.mcp;
  Json json = json_header(Document::Judge);
  json["problem"] = problem.label;
  json["start"] = problem.start;
  json["size"] = mcp.size();
  json["own_variables"] = problem.own_variables();
  json["nonzeros"] = mcp.jacobian_pattern().nonZeros();
  json["affine"] = mcp.is_affine();
  json["starts"] = problem.starts;
  json["known_solutions"] = problem.solutions.size();
  json["no_solution"] = problem.no_solution;
  json["tol"] = json_number(request.tol);
  json["residual"] = residual_json(mcp, verdict.residual);
  json["solution"] = code == exit_solved;
  json["to_rounding"] = verdict.to_rounding;
  json["exit_code"] = static_cast<int>(code);
  if (request.full) {
    json["lower"] = json_numbers(mcp.box().lower);
    json["x"] = json_numbers(verdict.x);
    json["upper"] = json_numbers(mcp.box().upper);
  }
  return json_text(json);
}

}  // namespace

ExitCode judge(const JudgeRequest& request, Streams streams) {
  std::vector<FileUse> inputs = files_of(request.source);
  inputs.push_back({"POINT", request.point});
  if (!outputs_fit(std::vector<FileUse>{{"--json", request.json}}, inputs, streams)) return exit_input;
  ExitCode code = exit_solved;
  std::string json;
  const std::string why = refusal(request.source.problem, [&] {
    if (!(request.tol > 0)) throw input_error("--tol {:g}: a tolerance is positive", request.tol);
    const LoadedProblem problem = load_problem(request.source);
    const Verdict verdict = verdict_of(*problem.mcp, point_of(request, problem), request.tol);
    const bool solution = verdict.residual.natural <= request.tol;
    if (!solution) code = exit_unsolved;
    json = judge_json(request, problem, verdict, code);
    std::ostream& log = request.json == "-" ? streams.err : streams.out;
    log << fmt::format(
        "{}: natural residual {:.3g}{}: {} to {:g}{}\n", problem.label, verdict.residual.natural,
        verdict.residual.worst < 0 ? "" : fmt::format(" (at {})", problem.mcp->equation_name(verdict.residual.worst)),
        solution ? "a solution" : "no solution", request.tol,
        !solution && verdict.to_rounding ? ", but as near as rounding lets it be" : "");
  });
  if (!why.empty()) return deliver_refusal(request.json, request.source.problem, why, streams);
  return deliver_json(request.json, json, streams) ? code : exit_input;
}

}  // namespace perp::app
