// SPDX-License-Identifier: Apache-2.0
#include "app/commands/inspect.hpp"

#include <ostream>

#include "app/program/files.hpp"
#include "app/report/json.hpp"

namespace perp::app {

Inspection inspect_problem(const LoadedProblem& problem, const std::atomic<bool>* interrupt) {
  return {ncp::inspect(*problem.mcp, problem.x0, interrupt), &problem};
}

std::vector<Concern> all_concerns(const Inspection& inspection) {
  std::vector<Concern> all = concerns(inspection);
  if (const ncp::ampl::Model* model = inspection.loaded->model; model != nullptr)
    for (std::string& remark : model->remarks()) all.push_back({Concern::Structure, std::move(remark)});
  return all;
}

ExitCode inspect(const InspectRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  const std::vector<FileUse> outputs{{"--json", request.json}};
  if (!outputs_fit(outputs, files_of(request.source), streams)) return exit_input;
  ExitCode code = exit_solved;
  const std::string why = refusal(request.source.problem, [&] {
    const LoadedProblem problem = load_problem(request.source);
    const Inspection inspection = inspect_problem(problem, interrupt);
    std::ostream& log = request.json == "-" ? streams.err : streams.out;
    print_inspection(log, inspection);
    log.flush();
    if (!request.json.empty() && !deliver_json(request.json, inspect_json(inspection), streams)) code = exit_input;
  });
  return why.empty() ? code : deliver_refusal(request.json, request.source.problem, why, streams);
}

}  // namespace perp::app
