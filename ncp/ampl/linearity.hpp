// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which derivatives of an AMPL model are constants.
#include <vector>

#include "ncp/ampl/nl_check.hpp"
#include "ncp/ampl/pairing.hpp"

namespace perp::ncp::ampl {

/// One flag for each entry of the map, as Mcp::linear_entries: the entry (i, j) is constant if the expression of row i
/// mentions variable j nowhere, defined variables looked through, so that x_j is in the row's linear part only. Rows
/// that change with a variable without having a derivative (in conditions, round(), ...) get no flag. Empty if such a
/// row has no entry at all, for which no flag could tell it from a constant.
std::vector<bool> linear_entries(const NlModel& model, const Pairing& pairing, const JacobianMap& map);

}  // namespace perp::ncp::ampl
