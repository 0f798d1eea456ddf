// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An affine MCP as an LCP with free variables: pairs (x_k, w_k), w = M' x + q', with x_k, w_k >= 0 and x_k w_k = 0, or
/// x_k free and w_k = 0. Private to lcp/.
///     only l_i finite     x = z_i - l_i,   w = F_i
///     only u_i finite     x = u_i - z_i,   w = -F_i
///     both finite         x = z_i - l_i,   w = F_i + x',   and   x' >= 0,   w' = u_i - l_i - x   (x' = F_i- at the
///     upper bound) neither             x = z_i, free,   or, split,   x - x' = z_i,   w = F_i,   w' = -F_i l_i = u_i a
///     constant; no pair
/// M' is positive semidefinite iff M is on the variables that are not fixed: x'M'x = z'Mz in the homogeneous parts.
#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

struct StandardForm {
  SpMat M;
  Vec q;
  std::vector<char> free;  ///< of a pair

  explicit StandardForm(const AffineMcp& problem, bool split_free);

  Index size() const { return q.size(); }
  Vec to_x(In z) const;  ///< of a point in the box; x' of a variable with two bounds is zero
  Vec to_z(In x) const;
  /// y >= 0 (any sign where free) with M'y <= 0 (0 where free), q'y < 0, as a certificate of the problem's.
  Vec to_certificate(In y) const;

 private:
  const Box box_;
  std::vector<Index> pair_;      ///< of variable i, -1 if fixed
  std::vector<Index> opposite_;  ///< the second pair of variable i, or -1
};

}  // namespace perp::lcp
