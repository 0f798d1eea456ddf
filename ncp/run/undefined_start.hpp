// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Starts at which F or J is not defined: why, in the words of the model, and a start nearby at which they are. Private
/// to ncp/ and app/.
#include <optional>
#include <string>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

class CountedMcp;

/// "log(price) in row market: price = 0 at the start", of F at x, where it is not defined; or of J, if it is given. F
/// and J are what the problem left there. The row and its variables if no operation is known; empty if no row is.
std::string why_undefined(const Mcp& mcp, In x, In F, const SpMat* J = nullptr);
/// The same as a message: that F or J is not defined at the start, and why as far as it is known.
std::string undefined_start(const Mcp& mcp, In x, In F, const SpMat* J = nullptr);

/// A point of the box like x, which is in it, but off those of its bounds at which F or J is not defined.
struct MovedStart {
  Vec x;
  std::string note;  ///< why, and where to
};
/// Nothing: F and J are defined at x, or at no point that was tried.
std::optional<MovedStart> moved_start(CountedMcp& counted, In x);

}  // namespace perp::ncp
