// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Problems as .nl files: row i complements variable i, but where the variable is free it is an equation.
#include <optional>
#include <string>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp::ampl {

/// The text of the .nl file of an affine problem, or of one whose F is written down (Mcp::expressions); nothing for
/// others. Linear parts are sums of coefficients; what is used several times is a defined variable; 0 times an
/// expression is 0. Throws std::invalid_argument if F contains a number that is not finite.
/// Reference: Gay, "Writing .nl files" (2005).
std::optional<std::string> nl_text(const Mcp& mcp, In x0);

}  // namespace perp::ncp::ampl
