// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "app/process.hpp"
#include "app/program/signals.hpp"

namespace perp::app {

std::vector<std::string> arguments_of(int argc, char** argv) { return {argv, argv + argc}; }

void begin_process(char**, std::atomic<bool>& interrupted) { wait_for_signals(interrupted); }

bool can_factor(std::ostream&) { return true; }

bool reader_has_gone() { return errno == EPIPE; }

void end_process(int code) {
  std::fflush(nullptr);
  std::_Exit(code);
}

}  // namespace perp::app
