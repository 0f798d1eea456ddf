// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options on the command line.
#include <CLI/App.hpp>
#include <string>

namespace perp::app {

/// Adds one that takes a value; `shown` stands for it in the help.
template <class Value>
CLI::Option* option(CLI::App* command, const char* flag, Value& value, const std::string& help, const char* shown) {
  return command->add_option(flag, value, help)->option_text(shown);
}

}  // namespace perp::app
