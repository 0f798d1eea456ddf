// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The calls of the system that main() makes.
#include <atomic>
#include <ostream>
#include <string>
#include <vector>

namespace perp::app {

/// The arguments of main() in UTF-8, its name the first.
std::vector<std::string> arguments_of(int argc, char** argv);

/// Before anything else is done.
void begin_process(char** argv, std::atomic<bool>& interrupted);

/// Returns whether there is room to factor a matrix; else `err` says what is missing.
bool can_factor(std::ostream& err);

/// Returns whether nobody reads the standard output any more.
bool reader_has_gone();

/// Ends the process without its destructors.
[[noreturn]] void end_process(int code);

}  // namespace perp::app
