// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Notes on what a solve makes of the parts of a model that are no complementarity conditions.
#include "ncp/ampl/model.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::settings {

/// Adds the model's remarks to result.notes (ncp/ampl/model.hpp); and where no solution was found, but there is one
/// without the side inequalities, which of them hold it out. That takes a second solve, no longer than the first one or
/// a second.
void add_model_notes(const ncp::Mcp& mcp, const ncp::ampl::Model& model, ncp::In x0, const ncp::Method& method,
                     ncp::Result& result);

}  // namespace perp::settings
