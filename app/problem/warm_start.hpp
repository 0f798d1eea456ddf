// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Warm starts: point and basis of an earlier run, from the JSON that `perp solve --json` wrote of it.
#include <string>
#include <string_view>
#include <vector>

#include "app/options/options.hpp"
#include "app/problem/problem.hpp"
#include "lcp/pivoting/lemke.hpp"

namespace perp::app {

std::string_view cell_name(lcp::Cell cell);  ///< "below", "inside", "above", "fixed"

struct WarmStart {
  ncp::Vec x;
  std::vector<lcp::Cell> basis{};  ///< empty: the run had none
};
/// Throws InputError, naming file and variable, if this is no result of as many variables with the same names, a value
/// is no finite number, or the basis is not one of all variables.
WarmStart read_warm_start(const std::string& path, const ncp::Mcp& mcp);
/// The same from the text of a file; `path` is for the errors.
WarmStart parse_warm_start(std::string_view text, const std::string& path, const ncp::Mcp& mcp);

/// Makes it the start of the problem and of the method. A basis that the method cannot use, and variables whose bounds
/// do not allow their cell any more (they take the cell of their value), are worth a note.
void set_warm_start(WarmStart warm, LoadedProblem& problem, Applied& options);

}  // namespace perp::app
