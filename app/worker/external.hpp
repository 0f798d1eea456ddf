// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Somebody else's program, by AMPL's convention: `COMMAND STUB -AMPL` reads STUB.nl and writes STUB.sol.
#include <string>
#include <vector>

#include "app/worker/worker.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::app::compare {

/// The COMMAND of --external with the campaign's tolerance, in as many digits as reading the same double back takes, in
/// place of every {tol}. Nothing else: braces are the shell's, ${tol} is its variable.
std::string with_tolerance(const std::string& command, double tol);
/// The bare {word}s of a COMMAND that with_tolerance() leaves to the shell, as which they mean next to nothing: likely
/// a {tol} that is written wrongly. Not ${word}, not {a,b}, {1..3}, {}.
std::vector<std::string> unfilled_words(const std::string& command);

/// One run, on a copy of the model (and of its .col and .row) in task.folder, with the start of task.rule;
/// problems that are no .nl files are written as such, and not applicable where they cannot be. Whatever the program
/// leaves running is killed. The calling process is to be one of run_process() with `runs_others`: where the campaign
/// dies, SIGUSR1 ends it and all it runs.
Answer run_external(const Task& task);

}  // namespace perp::app::compare
