// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The command line of `perp contact`.
#include <CLI/App.hpp>
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "app/contact/ball.hpp"
#include "app/program/program.hpp"

namespace perp::app::contacts {

/// What the words of a command line say, before anything is looked at.
struct ContactWords {
  std::vector<std::string> problems{};
  std::vector<std::string> generated{};
  std::string formulation{};
  std::string method{}, encoding{}, row{}, form{}, json{}, fclib_out{}, svg{};
  std::vector<std::string> options{};
  std::string level = "info";
  std::optional<double> tol{}, time_limit{}, mu{}, rotation{};
  bool full = false;
  bool show = false;
  std::optional<std::string> variants{};
  BallRequest ball{};  ///< of `perp contact ball`
};

/// Adds the command; what it is called with goes to `words`, which must outlive `app`.
CLI::App* add_command(CLI::App& app, ContactWords& words);

/// Runs it; its exit code.
int run_command(const CLI::App& command, const ContactWords& words, Streams streams,
                const std::atomic<bool>* interrupt);

}  // namespace perp::app::contacts
