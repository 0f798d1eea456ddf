#pragma once
/// Affine problems as .nl files, for programs that know nothing else.
#include <string>

#include "ncp/problem/mcp.hpp"

namespace perp::app::compare {

/// F(x) = M x + q over a box as a text .nl file with the initial guess x0: row i complements variable i, or is the
/// equation (M x)_i = -q_i where that variable is free (Gay, "Writing .nl files", 2005). Throws InputError if the
/// problem is not affine.
std::string affine_nl(const ncp::Mcp& mcp, ncp::In x0);

}  // namespace perp::app::compare
