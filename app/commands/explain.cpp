// SPDX-License-Identifier: Apache-2.0
#include "app/commands/explain.hpp"

#include <fmt/format.h>

#include <functional>
#include <ostream>

#include "app/program/files.hpp"
#include "app/report/json.hpp"
#include "app/report/report.hpp"
#include "app/text/json_parts.hpp"
#include "app/text/table.hpp"
#include "ncp/analysis/certificate.hpp"
#include "ncp/explain/explain.hpp"
#include "ncp/strategy/lists.hpp"

namespace perp::app {
namespace {

using ncp::Answer;
using ncp::Demand;

constexpr std::size_t answer_width = 110;

void print_answer(std::ostream& out, std::size_t number, bool proven, const std::string& text) {
  print_wrapped(out, fmt::format("{}: {}", proven ? "proven" : "likely", text), fmt::format("{}. ", number),
                answer_width);
}

void print_explanation(std::ostream& out, const LoadedProblem& problem, const ncp::Explanation& explanation) {
  print_size(out, problem);
  const ncp::Result& result = explanation.result;
  const std::size_t count = explanation.answers.size();
  if (result.accepted()) {
    out << (count == 0 ? "\n\nThe model has a solution, and nothing stands out.\n"
                       : "\n\nThe model has a solution, but look at this:\n\n");
  } else {
    out << (result.status == ncp::Status::Infeasible ? "\n\nThe model has no solution.\n"
                                                     : "\n\nNo solution was found.\n");
    print_wrapped(out, fmt::format("{}: {}", ncp::to_string(result.status), result.message), "  ", answer_width);
    out << '\n';
  }
  for (std::size_t k = 0; k < count; ++k)
    print_answer(out, k + 1, explanation.answers[k].proven, explanation.answers[k].text);
  for (const std::string& note : result.notes) print_wrapped(out, note, "Note: ", answer_width);
}

Json names_json(const std::vector<ncp::Index>& indices, const std::function<std::string(ncp::Index)>& name) {
  Json names = Json::array();
  for (const ncp::Index i : indices) names.push_back(name(i));
  return names;
}

Json demand_json(const ncp::Mcp& mcp, const Demand& demand) {
  return {{"what", ncp::to_string(demand.of)}, {"name", ncp::name_of(mcp, demand)}, {"index", demand.index}};
}

Json conflict_json(const ncp::Mcp& mcp, const ncp::Explanation& explanation) {
  if (!explanation.conflict) return nullptr;
  const ncp::Conflict& conflict = *explanation.conflict;
  Json demands = Json::array();
  for (const Demand& d : conflict.demands) demands.push_back(demand_json(mcp, d));
  Json certificate = nullptr;
  if (conflict.proof.certificate)
    certificate = Json::parse(certificate_json(mcp, explanation.result.x, conflict.proof));
  return {{"demands", std::move(demands)}, {"smallest", conflict.smallest}, {"certificate", std::move(certificate)}};
}

Json repair_json(const ncp::Mcp& mcp, const ncp::Repair& repair) {
  if (repair.changes.empty()) return nullptr;
  Json changes = Json::array();
  for (const ncp::Change& c : repair.changes) {
    Json change = demand_json(mcp, c.what);
    change["from"] = json_number(c.from);
    change["to"] = json_number(c.to);
    changes.push_back(std::move(change));
  }
  return {{"changes", std::move(changes)}, {"least", repair.least}, {"verified", repair.verified}};
}

std::string explain_json(const LoadedProblem& problem, const ncp::Explanation& explanation, ExitCode code) {
  const ncp::Mcp& mcp = *problem.mcp;
  Json json = json_header(Document::Explain);
  json["problem"] = problem.label;
  json["status"] = ncp::to_string(explanation.result.status);
  json["exit_code"] = static_cast<int>(code);
  json["message"] = explanation.result.message;
  json["answers"] = Json::array();
  for (const Answer& a : explanation.answers)
    json["answers"].push_back(
        {{"kind", ncp::to_string(a.kind)},
         {"proven", a.proven},
         {"text", a.text},
         {"rows", names_json(a.rows, [&](ncp::Index i) { return mcp.equation_name(i); })},
         {"variables", names_json(a.variables, [&](ncp::Index j) { return mcp.variable_name(j); })}});
  json["notes"] = explanation.result.notes;
  json["conflict"] = conflict_json(mcp, explanation);
  json["repair"] = repair_json(mcp, explanation.repair);
  return json_text(json);
}

/// Tells why a model cannot be read as a problem: each thing that the reader found wrong is an answer.
ExitCode explain_refused(const ExplainRequest& request, const ncp::ampl::ModelError& refused, Streams streams) {
  std::ostream& log = request.json == "-" ? streams.err : streams.out;
  Json json = json_header(Document::Explain);
  json["problem"] = request.source.problem;
  json["status"] = "InputError";
  json["exit_code"] = static_cast<int>(exit_input);
  json["message"] = refused.what();
  json["answers"] = Json::array();
  log << "The model is refused.\n\n";
  for (const std::string& text : refused.parts()) {
    print_answer(log, json["answers"].size() + 1, true, text);
    json["answers"].push_back({{"kind", "structure"},
                               {"proven", true},
                               {"text", text},
                               {"rows", Json::array()},
                               {"variables", Json::array()}});
  }
  json["notes"] = Json::array();
  json["conflict"] = json["repair"] = nullptr;
  if (!request.json.empty()) deliver_json(request.json, json_text(json), streams);
  return exit_input;
}

}  // namespace

ExitCode explain(const ExplainRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  if (!outputs_fit(std::vector<FileUse>{{"--json", request.json}}, files_of(request.source), streams))
    return exit_input;
  ExitCode code = exit_solved;
  bool refused = false;
  const std::string why = refusal(request.source.problem, [&] {
    LoadedProblem problem;
    try {
      problem = load_problem(request.source);
    } catch (const ncp::ampl::ModelError& error) {
      refused = true;
      code = explain_refused(request, error, streams);
      return;
    }
    const ncp::Explanation explanation =
        ncp::explain(*problem.mcp, problem.x0, {.method = ncp::automatic(), .seconds = request.time_limit}, interrupt);
    if (!explanation.result.accepted()) code = exit_unsolved;
    std::ostream& log = request.json == "-" ? streams.err : streams.out;
    print_explanation(log, problem, explanation);
    log.flush();
    if (!request.json.empty() && !deliver_json(request.json, explain_json(problem, explanation, code), streams))
      code = exit_input;
  });
  return why.empty() || refused ? code : deliver_refusal(request.json, request.source.problem, why, streams);
}

}  // namespace perp::app
