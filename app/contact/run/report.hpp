// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A run on a contact problem, told to a person (text) and to programs (JSON; docs/schema/ describes it).
#include <iosfwd>
#include <span>
#include <string>

#include "app/contact/run/run.hpp"
#include "app/program/program.hpp"

namespace perp::app::contacts {

/// Size, coefficients, rank and symmetry of W; formulation and method.
void print_heading(std::ostream& out, const Loaded& loaded, const Variant& variant, double tol);
/// The points judged on the way: metrics and steps.
void print_history(std::ostream& out, const Run& run);
/// Contact, state, r_N, |r_T|, mu r_N, u_N, |u_T|, margin of each contact; shortened beyond 60 unless `full`.
void print_contacts(std::ostream& out, const contact::Problem& problem, const Run& run, bool full);
/// What came out, for whom it counts, how many contacts do what, and how long it took.
void print_verdict(std::ostream& out, const contact::Problem& problem, const Run& run);
/// The judge's metrics.
void print_judge(std::ostream& out, const contact::Problem& problem, const Run& run);

struct Summary {
  std::string label;
  Run run;
  std::string refused{};  ///< why, where it was
};
/// One line a problem, where there are several.
void print_summaries(std::ostream& out, std::span<const Summary> all);

/// One run as a JSON object.
std::string run_json(const Loaded& loaded, const Run& run, ExitCode code);
/// Says of a list of variants, to programs that run them: label, whether its law is Coulomb's, flags of `perp contact`.
/// Problems that are files are read, and refused as by a run.
ExitCode list_variants(const std::string& list, const std::vector<std::string>& problems, const std::string& json,
                       Streams streams);
/// Several: objects as above, or as of refused input.
std::string runs_json(std::span<const std::string> objects, ExitCode code);

}  // namespace perp::app::contacts
