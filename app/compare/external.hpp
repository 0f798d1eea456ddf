#pragma once
/// Somebody else's program, by AMPL's convention: `COMMAND STUB -AMPL` reads STUB.nl and writes STUB.sol.
#include "app/compare/worker.hpp"

namespace perp::app::compare {

/// One run, on a copy of the model (and of its .col and .row) in task.folder, with the start of task.rule; affine
/// problems that are no .nl files are written as such. Whatever the program leaves running is killed. The calling
/// process is to be one of run_process() with `runs_others`: where the campaign dies, SIGUSR1 ends it and all it runs.
Answer run_external(const Task& task);

}  // namespace perp::app::compare
