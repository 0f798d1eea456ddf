// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp contact`: unilateral contact with Coulomb friction, by any formulation of contact/, judged by the exact law.
#include <atomic>
#include <string>
#include <vector>

#include "app/commands/solve.hpp"
#include "app/contact/run/variant.hpp"
#include "app/program/program.hpp"

namespace perp::app::contacts {

struct ContactRequest {
  std::vector<std::string> problems{};   ///< files, or NAME:SIZE[:SEED[:MU]]
  std::vector<std::string> generated{};  ///< --generate: NAME:SIZE[:SEED[:MU]] alone; after those
  VariantRequest variant{};
  double tol = 1e-8;        ///< exact laws: both published metrics; others: the natural residual of their own problem
  double time_limit = 30;   ///< s
  std::string json{};       ///< "" for none, "-" for standard output (and the text to `err`)
  std::string fclib_out{};  ///< where problem and solution are written; "" for nowhere
  LogLevel log_level = LogLevel::Info;
  bool full = false;  ///< print every row of a long table
};

/// exit_solved: every problem; exit_unsolved; exit_input if one was refused. Several problems are solved one after
/// another, refused ones left out. Errors are printed, not thrown. `interrupt` may be null.
ExitCode solve_contact(const ContactRequest& request, Streams streams, const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::app::contacts
