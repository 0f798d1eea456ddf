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

/// One run, on a copy of the model (and of its .col and .row) in task.folder, with the start of task.rule; affine
/// problems that are no .nl files are written as such. Whatever the program leaves running is killed. The calling
/// process is to be one of run_process() with `runs_others`: where the campaign dies, SIGUSR1 ends it and all it runs.
Answer run_external(const Task& task);

// Affine problems as .nl files, for programs that know nothing else.

/// F(x) = M x + q over a box as a text .nl file with the initial guess x0: row i complements variable i, or is the
/// equation (M x)_i = -q_i where that variable is free (Gay, "Writing .nl files", 2005). Throws InputError if the
/// problem is not affine.
std::string affine_nl(const ncp::Mcp& mcp, ncp::In x0);

}  // namespace perp::app::compare
