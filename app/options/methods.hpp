// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp methods`, and the methods by the names of app/.
#include <string>
#include <vector>

#include "app/program/program.hpp"
#include "ncp/settings/method_table.hpp"

namespace perp::app {

using settings::default_method;
using settings::find_method;
using settings::method_named;
using settings::method_names;
using settings::MethodEntry;
using settings::methods;

/// Prints the methods, their options with types and defaults, and the PATH options that have no effect.
int print_methods(Streams streams);
/// All methods and C-functions as JSON; with `method`, its options in force for these key=value, and notes on those
/// without effect. Throws InputError.
std::string methods_json(const std::string& method, const std::vector<std::string>& options);
/// Prints what the method tries in turn, and its options. Throws InputError for a name that is none.
int show_method(const std::string& text, Streams streams);

}  // namespace perp::app
