// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Numbers and words in messages. Private to ncp/ and app/.
#include <string>
#include <string_view>

#include "lcp/words.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// Four digits, for messages.
std::string number(double value);
/// The same rounded down or up, of what is proven to be at least, or at most, the value.
std::string number_below(double value);
std::string number_above(double value);

using perp::quantity;

/// Levenshtein's distance, in which neighbours exchanged are one edit, without regard to case.
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace perp::ncp
