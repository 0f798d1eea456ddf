// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Certificates of infeasibility as text that holds all they rest on: the rows and bounds, exact to the last digit. The
/// checker scripts/check_certificate.py knows no solver and reads nothing else.
#include <string>

#include "ncp/run/result.hpp"

namespace perp::ncp {

/// Returns the certificate of a result as JSON, as docs/schema/solve.json describes it; "null" if there is none.
/// `x`: a point where J is defined, for problems that are not affine.
std::string certificate_json(const Mcp& mcp, In x, const Infeasibility& proof);

/// Returns the rows that a certificate uses, in the model's names, for messages: "rows supply, demand and 3 others"; at
/// most `most` names; of one row "row supply and the bounds". Empty if there is none.
std::string rows_in_words(const Mcp& mcp, const Infeasibility& proof, std::size_t most = 4);

/// Returns whether terms that are not affine take part in the certificate (ncp/analysis/row_sums.hpp).
bool uses_terms(const Mcp& mcp, const Infeasibility& proof);

}  // namespace perp::ncp
