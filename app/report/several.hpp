#pragma once
/// `perp solve --all`: several solutions, by deflation (ncp/strategy/deflation.hpp).
#include <cstddef>
#include <iosfwd>

#include "app/report/report.hpp"

namespace perp::app {

inline constexpr std::size_t long_table = 60;  ///< rows from which on tables are shortened

inline constexpr int default_solutions = 10;

/// How many solutions `--all K` asks for: default_solutions where K is empty. Throws InputError.
int parse_solutions(const std::string& text);

/// The first solution by `method`, which alone the observer sees, the others by deflation; fills report.several and
/// report.result, the first. Throws InputError if the method has its own way to all solutions; what ncp::solve_all
/// throws.
void solve_several(Report& report, const ncp::Method& method, const ncp::Observer& observer);

/// The solutions numbered, each with its residual and how it was found, and side by side; nothing if only one was asked
/// for.
void print_several(std::ostream& out, const Report& report, bool full);

}  // namespace perp::app
