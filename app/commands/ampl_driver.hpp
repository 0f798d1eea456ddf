// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Perp as a solver of AMPL:  perp stub -AMPL [key=value]...  reads stub.nl and writes stub.sol. The executable is also
/// installed as `pathampl`, the name under which Pyomo and others call PATH; by that name it needs no -AMPL.
///
/// Options come from the environment variables perp_options, path_options and pathampl_options, in this order, then
/// from the command line; a later value wins. `optfile=FILE` stands for the lines of an option file.
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "app/program/program.hpp"
#include "ncp/run/result.hpp"

namespace perp::app {

struct AmplRequest {
  std::string program = "perp";        ///< the name it was called by
  std::vector<std::string> arguments;  ///< without that name
  std::function<const char*(const char*)> environment = [](const char*) -> const char* { return nullptr; };
};

/// Is this a call by AMPL's conventions? By the name pathampl, with -AMPL, or to ask for version (-v) or usage (-=,
/// -?).
bool is_ampl_call(const std::string& program, const std::vector<std::string>& arguments);

/// exit_solved whenever the solver ran and wrote a .sol file, whatever the outcome: AMPL reads it from the file.
/// exit_input if the model or an option was refused (a .sol file says why, unless there is no model), or if nothing
/// could be written.
ExitCode ampl_driver(const AmplRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

/// AMPL's solve_result_num: 0 solved, 4xx a limit, 5xx a failure.
int solve_result_num(ncp::Status status);

}  // namespace perp::app
