// SPDX-License-Identifier: Apache-2.0
#pragma once
/// .sol files read back, text and binary, from programs one cannot trust (Gay, "Hooking your solver to AMPL", 1997,
/// and what ASL's write_sol writes). Text:
///
///     message lines, an empty line, "Options", k, k integers, rows, dual values, variables, values of variables,
///     [a tolerance, if the second of the k integers is 3: it then counts two of the k], the dual values, x, "objno 0
///     CODE"
///
/// What follows (suffixes) is not looked at. Binary: the same in records between two copies of their length.
#include <string>
#include <string_view>

#include "ncp/problem/mcp.hpp"

namespace perp::app::compare {

struct SolFile {
  std::string message{};
  int code = 0;  ///< solve_result_num: below 200 it claims a solution
  ncp::Vec x{};  ///< of the variables; empty if the program gave none
};

/// `variables`: how many the model has. Throws InputError saying why the text is no .sol file for it: cut off, not a
/// number where one belongs, other sizes, no objno.
SolFile parse_sol(std::string_view text, ncp::Index variables);

}  // namespace perp::app::compare
