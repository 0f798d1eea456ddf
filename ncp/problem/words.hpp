#pragma once
/// Numbers in messages. Private to ncp/.
#include <string>
#include <string_view>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// Four digits, for messages.
std::string number(double value);

/// "1 iteration", "3 iterations".
std::string quantity(Index n, std::string_view noun);

}  // namespace perp::ncp
