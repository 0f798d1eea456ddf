// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options by name for contact problems.
#include <optional>
#include <string>
#include <vector>

#include "contact/solvers/variant.hpp"
#include "ncp/problem/fields.hpp"
#include "ncp/settings/assignments.hpp"

namespace perp::contact {

/// Values that options set beside the method, and notes on those without effect.
struct AppliedOptions {
  std::optional<double> tol{};
  std::optional<double> seconds{};
  std::vector<std::string> notes{};
};

/// Sets the options of the variant's solver: those of contact/, and those that its method has in ncp/ or lcp/. Throws
/// settings::InputError for others.
AppliedOptions apply_options(Variant& variant, std::vector<settings::Assignment> given);

/// Describes the solver's options if it is one of contact/, which *of is to outlive. Those of its method in ncp/ or
/// lcp/ are not among them.
ncp::Fields own_options(Variant::Solver& of);
/// Returns their keys, comma-separated.
std::string own_keys(Variant::Solver of);

}  // namespace perp::contact
