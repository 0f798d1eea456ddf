// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A problem by its name, and a run of a variant on it (contact/solvers/run.hpp).
#include <memory>
#include <string>
#include <vector>

#include "app/contact/run/variant.hpp"
#include "app/program/files.hpp"
#include "app/report/bounded_run.hpp"
#include "contact/model/problem.hpp"
#include "contact/solvers/run.hpp"

namespace perp::app::contacts {

struct Loaded {
  std::string label;  ///< as it was given
  contact::Problem problem;
};
/// A file of FCLIB or Siconos, or NAME:SIZE[:SEED] of contact/scenes/generators.hpp, SIZE contacts, where there is no
/// such file. Throws InputError, lcp::FileError, std::invalid_argument, std::bad_alloc.
Loaded load(const std::string& argument);
/// The same where the argument has to be NAME:SIZE[:SEED].
Loaded generate(const std::string& argument);
/// Is it NAME:... of a generator and no file?
bool is_generated(const std::string& argument);
/// Those of the arguments that are files: for check_outputs().
std::vector<FileUse> files_of(const std::vector<std::string>& arguments);

using Limits = contact::RunLimits;
struct Run : contact::Run {
  Variant variant{};
  Limits limits{};
};
/// Throws what the libraries throw at malformed input.
Run run(const contact::Problem& problem, const Variant& variant, const Limits& limits);

// Both within their limits, whatever they are doing when those are reached.

/// Throws what load() does, and OutOfTime.
std::shared_ptr<const Loaded> load_within(const Patience& patience, const std::string& argument);
/// run() with the limits, of which the time is what is left of `patience`. Where it does not come back: the best point
/// met, judged, with status TimeLimit or Interrupted.
Run run_within(const Patience& patience, std::shared_ptr<const Loaded> loaded, const Variant& variant,
               const Limits& limits);

}  // namespace perp::app::contacts
