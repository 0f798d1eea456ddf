// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options by name for contact problems.
#include <vector>

#include "contact/solvers/run.hpp"
#include "ncp/settings/assignments.hpp"

namespace perp::contact {

/// Sets those that the variant's solver has, and takes tolerance and time limit from the rest. Throws
/// settings::InputError for others.
RunLimits apply_options(Variant& variant, std::vector<settings::Assignment> given);

}  // namespace perp::contact
