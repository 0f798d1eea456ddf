// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp solve`.
#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/options/options_text.hpp"
#include "app/program/program.hpp"

namespace perp::app {

/// What is printed; each level adds to those before it.
enum class LogLevel {
  Quiet,    ///< errors
  Warning,  ///< warnings and notes
  Summary,  ///< the closing summary
  Info,     ///< the iteration table and the solution
  Debug,    ///< the options in force
};
std::span<const std::string_view> log_level_names();
/// Throws InputError.
LogLevel log_level(std::string_view name);

struct SolveRequest {
  std::string problem;                 ///< FILE.nl, NAME or M.mtx
  std::optional<int> start{};          ///< from 1
  std::string options_file{};          ///< "" for none
  std::vector<std::string> options{};  ///< key=value, in order; after the file's
  std::vector<Assignment> flags{};     ///< options that have a flag of their own; after those
  std::string json{};                  ///< "" for none, "-" for standard output (and the log to `err`)
  LogLevel log_level = LogLevel::Info;
  bool full = false;    ///< print every row of the solution
  std::string q{};      ///< of a matrix file: the vector's
  std::string lower{};  ///< of a matrix file: a file or a number
  std::string upper{};
  std::string rows{};       ///< of a variational inequality with that matrix: the file of A
  std::string row_lower{};  ///< of A: a file or a number
  std::string row_upper{};
  std::string start_at{};               ///< a file with the start
  std::string warm_start{};             ///< the JSON of an earlier run: start from its point and basis
  std::string plot{};                   ///< where to draw the run as SVG; "" for nowhere
  std::optional<int> plot_iteration{};  ///< the iteration whose way is drawn
  std::string solution{};               ///< where to write x as a Matrix Market vector; "" for nowhere
  std::optional<int> all{};             ///< look for several solutions, so many at most
};

/// Solves and reports. `interrupt`, when set, ends the run as Interrupted; may be null. Errors in the request are
/// printed, not thrown.
ExitCode solve(const SolveRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::app
