#pragma once
/// Options by name for contact problems.
#include <vector>

#include "contact/solvers/run.hpp"
#include "ncp/settings/assignments.hpp"

namespace perp::capi {

/// Sets those that the variant's solver has, and takes tolerance and time limit from the rest. Throws
/// settings::InputError for others.
contact::RunLimits contact_options(contact::Variant& variant, std::vector<settings::Assignment> given);

}  // namespace perp::capi
