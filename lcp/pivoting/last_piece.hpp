// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The linear piece of the normal map that a path ended in, with factors of its matrix; private to lcp/.
#include "lcp/types.hpp"

namespace perp::lcp {

class LastPiece {
 public:
  LastPiece() = default;
  LastPiece(const LastPiece&) = delete;
  LastPiece& operator=(const LastPiece&) = delete;
  virtual ~LastPiece() = default;
  /// lemke.hpp's; needs nothing of the problem and the options that the path was made with.
  virtual Vec chord_step(In r) const = 0;
};

}  // namespace perp::lcp
