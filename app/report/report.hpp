// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One run of a method on a problem, and how it is told to a person. (To programs: json.hpp; to AMPL:
/// app/commands/ampl_driver.hpp.)
#include <atomic>
#include <cstddef>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/options/options.hpp"
#include "app/problem/problem.hpp"
#include "ncp/settings/session.hpp"

namespace perp::app {

struct Report : settings::Outcome {
  const LoadedProblem* problem = nullptr;
  Settings settings{};
  std::vector<std::string> notes{};

  const ncp::Mcp& mcp() const { return *problem->mcp; }
  ExitCode exit_code() const { return result.solved() ? exit_solved : exit_unsolved; }
};

/// The tables of iterations, each line at once: someone who watches a pipe or a log file sees the run as it goes. The
/// stream and the problem outlive the observer.
ncp::Observer live_table(std::ostream& out, const ncp::Mcp& mcp, const Output& output);

/// A session on the problem. Throws what its run() does.
Report run_method(const LoadedProblem& problem, const Settings& settings, const std::atomic<bool>* interrupt = nullptr,
                  const ncp::Observer& observer = {}, const std::function<void(const Report&)>& found = {});

/// Where variable i is: "basic" (between its bounds), "at lower", "at upper", "fixed", "free" (it has no bounds), with
/// distances up to `tol` counted as "at".
std::string_view state_name(const ncp::Box& box, ncp::Index i, double x, double tol);

/// The variables of a model that are no unknowns, each the expression of a condition, at the result.
std::vector<ncp::ampl::Model::Computed> computed(const Report& report);

/// F_i at the result; NaN where it is not known.
double F_value(const Report& report, ncp::Index i);

/// Without a newline: how large it is, and what is not solved of a model.
void print_size(std::ostream& out, const LoadedProblem& problem);
/// Name, size, start, method.
void print_heading(std::ostream& out, const LoadedProblem& problem, const Settings& settings);
/// Name, lower, value, upper, F, state of each variable, computed ones last; shortened beyond 60 unless `full`.
void print_solution(std::ostream& out, const Report& report, bool full);
/// The largest entries of x, F and its Jacobian at the start.
void print_initial_statistics(std::ostream& out, const LoadedProblem& problem);
/// What is to be known before the numbers are used.
void print_notes(std::ostream& out, const Report& report);
/// What happened; what to try if it did not work.
void print_verdict(std::ostream& out, const Report& report);
/// The residuals at the end and the largest entries of x and F.
void print_final_statistics(std::ostream& out, const Report& report);
/// How many iterations, evaluations, ... there were: one a line, or the main ones in one line.
void print_final_summary(std::ostream& out, const Report& report);
void print_short_summary(std::ostream& out, const Report& report);
/// What verification and the check of the Jacobian found, the nearest known solution.
void print_remarks(std::ostream& out, const Report& report);
/// All solutions, if the method looked for all: what is not zero in each.
void print_all_solutions(std::ostream& out, const Report& report, bool full);
/// "verified: exactly one solution in this box, 2.1e-13 about the point", or why that cannot be said.
std::string verified_text(const ncp::Verified& verified);
/// Options in force.
void print_options(std::ostream& out, const Settings& settings);

// `perp solve --all`: several solutions, by deflation (ncp/strategy/deflation.hpp).

inline constexpr std::size_t long_table = 60;  ///< rows from which on tables are shortened

inline constexpr int default_solutions = 10;

/// How many solutions `--all K` asks for: default_solutions where K is empty. Throws InputError.
int parse_solutions(const std::string& text);

/// The solutions numbered, each with its residual and how it was found, and side by side; nothing if only one was asked
/// for.
void print_several(std::ostream& out, const Report& report, bool full);

}  // namespace perp::app
