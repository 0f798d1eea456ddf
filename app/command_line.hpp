// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The command line of the program `perp`.
#include <atomic>
#include <string>
#include <vector>

#include "app/program/program.hpp"

namespace perp::app {

/// Does what the `arguments` after the program's name ask for, and returns the exit code. Help and results go to
/// `streams`. A command line that is wrong is refused there, with what was meant.
int run_command(std::vector<std::string> arguments, Streams streams, const std::atomic<bool>* interrupt);

}  // namespace perp::app
