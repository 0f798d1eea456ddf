// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The calls of the system that main() makes.
#include <atomic>
#include <ostream>

namespace perp::app {

/// Before anything else is done.
void begin_process(char** argv, std::atomic<bool>& interrupted);

/// Returns whether there is room to factor a matrix; else `err` says what is missing.
bool can_factor(std::ostream& err);

/// Returns whether nobody reads the standard output any more.
bool reader_has_gone();

/// Ends the process without its destructors.
[[noreturn]] void end_process(int code);

}  // namespace perp::app
