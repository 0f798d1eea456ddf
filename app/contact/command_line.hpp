// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The command line of `perp contact`.
#include <CLI/App.hpp>
#include <atomic>
#include <optional>
#include <string>

#include "app/contact/contact.hpp"
#include "app/program/program.hpp"

namespace perp::app::contacts {

/// The request that a command line makes.
struct ContactWords {
  ContactRequest request{};
  std::string level = "info";
  std::optional<double> mu{};             ///< of all problems that are made
  bool show = false;                      ///< what the method tries, without a problem
  std::optional<std::string> variants{};  ///< a list to be told about
};

/// Adds the command; what it is called with goes to `words`, which must outlive `app`.
CLI::App* add_command(CLI::App& app, ContactWords& words);

/// Runs it; its exit code.
int run_command(const CLI::App& command, const ContactWords& words, Streams streams,
                const std::atomic<bool>* interrupt);

}  // namespace perp::app::contacts
