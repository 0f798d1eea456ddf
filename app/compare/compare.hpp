// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp compare`: a campaign of methods x problems x starts, each run in a process of its own.
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "app/program/program.hpp"

namespace CLI {
class App;
}

namespace perp::app::compare {

/// Beside those of app/program/program.hpp: stopped by a signal, --resume goes on.
inline constexpr int exit_interrupted = 4;

struct CompareRequest {
  std::optional<std::string> problems{};  ///< LIST; all
  std::optional<std::string> methods{};   ///< LIST; presets
  std::optional<std::string> starts{};    ///< "all" or how many of each problem at most; all
  std::optional<double> tol{};            ///< 1e-6
  std::optional<double> time_limit{};     ///< s; 60
  std::optional<long long> memory_mb{};   ///< 4096
  std::optional<int> jobs{};              ///< cores
  std::optional<int> restarts{};          ///< 0
  std::optional<unsigned> seed{};         ///< 1
  std::vector<std::string> externals{};   ///< NAME=COMMAND
  std::optional<std::string> shard{};     ///< K/N: one of N parts of the cells; all
  std::string out = "comparison";         ///< the directory
  bool resume = false;                    ///< go on with what is there; what is not given is as it was
  std::string baseline{};                 ///< cells.csv or outcomes.csv of another campaign; "" for none
  std::vector<std::string> command_line{};
  std::string program = "/proc/self/exe";  ///< run for each process
};

/// exit_solved: complete; exit_unsolved: complete, with regressions; exit_input; exit_interrupted. Errors in the
/// request are printed, not thrown. `interrupt` may be null.
int compare(const CompareRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

// The command line of `perp compare`.

/// Adds the command; what it is called with goes to `request`, which must outlive `app`.
CLI::App* add_command(CLI::App& app, CompareRequest& request);

}  // namespace perp::app::compare
