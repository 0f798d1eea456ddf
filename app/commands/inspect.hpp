// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp inspect`: what can be said of a problem without solving it (ncp/analysis/inspection.hpp), told to a person by
/// inspect_text.cpp and to a program by inspect_json.cpp.
#include <atomic>
#include <iosfwd>
#include <string>

#include "app/problem/problem.hpp"
#include "app/program/program.hpp"
#include "ncp/analysis/inspection.hpp"

namespace perp::app {

using ncp::Concern;
using ncp::ConditionFindings;
using ncp::Extreme;
using ncp::Indices;
using ncp::ScalingFindings;
using ncp::StartFindings;
using ncp::StructureFindings;
using ncp::VariableKinds;

struct Inspection : ncp::Inspection {
  const LoadedProblem* loaded = nullptr;
};

/// Throws std::invalid_argument if the problem is malformed: what ncp::solve throws. `interrupt` may be null. The
/// problem outlives the answer.
Inspection inspect_problem(const LoadedProblem& problem, const std::atomic<bool>* interrupt = nullptr);
Inspection inspect_problem(LoadedProblem&&, const std::atomic<bool>* = nullptr) = delete;

/// Returns the concerns of the inspection and the remarks on its model (ncp/ampl/model.hpp).
std::vector<Concern> all_concerns(const Inspection& inspection);

void print_inspection(std::ostream& out, const Inspection& inspection);
/// docs/schema/inspect.json describes it.
std::string inspect_json(const Inspection& inspection);

struct InspectRequest {
  ProblemSource source{};
  std::string json{};  ///< "" for none, "-" for standard output (and the text to `err`)
};

/// exit_solved if there was something to inspect, whatever was found.
ExitCode inspect(const InspectRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::app
