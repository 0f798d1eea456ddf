// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What every part of the program `perp` shares: where text goes, exit codes, errors a user can mend, and versions.
#include <fmt/format.h>

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/settings/input_error.hpp"

namespace perp::app {

/// Where a command writes: `out` is for results, `err` for warnings and errors.
struct Streams {
  std::ostream& out;
  std::ostream& err;
  std::ostream* terminal = nullptr;  ///< `err` for what steers the cursor, where `err` lets no such thing through
};

enum ExitCode : int {
  exit_solved = 0,
  exit_unsolved = 1,
  exit_input = 2,     ///< wrong usage, a file or an option that makes no sense, a result that cannot be written
  exit_internal = 3,  ///< an exception nobody expected
};

using settings::input_error;
using settings::InputError;

/// Says on `err` why not; exit_input.
ExitCode say_refused(const Streams& streams, std::string_view why);

/// Of a problem that does not fit: "'obstacle:20000x20000': out of memory: ...".
std::string out_of_memory(const std::string& problem);

using settings::did_you_mean;

/// A word as a shell takes it: in quotes where it needs them.
std::string shell_quoted(const std::string& word);

/// "1.0.0".
std::string_view version_number();
/// One line for `-v`; its first number of the form x.y.z is ours (Pyomo looks for it).
std::string version_line();
/// "Eigen 3.4.0", ...: what the program links.
std::vector<std::string> library_versions();
/// Under which licence the program is as it is linked (lcp/gpl.hpp).
std::string licence_line();
/// Version, effective licence, and the versions of the libraries linked.
std::string version_text();

}  // namespace perp::app
