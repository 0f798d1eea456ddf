// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp contact --compare`: variants x problems, each cell a `perp contact` in a process of its own, with limits of
/// time and memory, so that a crash or a hang loses that cell alone. A cell counts as solved by its variant's own law:
/// glocker and ncp1 by Coulomb's exact one, faceted and frictionless variants by that of their affine problem; what
/// Coulomb's law says of them stands beside it.
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "app/program/program.hpp"

namespace perp::app::contacts {

/// What is not given: of a campaign that is resumed as it was, else as beside it.
struct CompareVariantsRequest {
  std::vector<std::string> problems{};
  std::optional<std::string> variants{};  ///< list of app/contact/run/variant.hpp; default_variants
  std::optional<double> tol{};            ///< 1e-8
  std::optional<double> time_limit{};     ///< s, wall clock of a run; 30
  std::optional<long long> memory_mb{};   ///< 4096
  double reading = 10;                    ///< s, beside the solve's own limit twice: then a process counts as hanging
  int jobs = 1;                           ///< runs at a time
  std::string out = "contact-comparison";
  bool resume = false;  ///< go on with the campaign in `out`, if there is one
  std::string json{};   ///< the cells once more, "-" for standard output; "" for nowhere
  std::string program = "/proc/self/exe";
};

/// exit_solved: complete, whatever was solved; exit_input; compare::exit_interrupted with what was finished written.
/// Errors in the request are printed, not thrown. `interrupt` may be null.
int compare_variants(const CompareVariantsRequest& request, Streams streams,
                     const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::app::contacts
