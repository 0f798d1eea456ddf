// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp explain`: why a model has no solution, which row is the cause, and what would mend it (ncp/explain).
#include <atomic>
#include <string>

#include "app/problem/problem.hpp"
#include "app/program/program.hpp"

namespace perp::app {

struct ExplainRequest {
  ProblemSource source{};
  double time_limit = 30;  ///< seconds
  std::string json{};      ///< "" for none, "-" for standard output (and the text to `err`)
};

/// exit_solved if the model has a solution, exit_unsolved if it has none or none was found, exit_input if the model was
/// refused; why is told in each case.
ExitCode explain(const ExplainRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::app
