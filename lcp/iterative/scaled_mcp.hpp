// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An affine MCP without its fixed variables, z_i = D_i unit x_i, every row times D_i / unit: entries of M up to one, q
/// too, and D M D is monotone if M is. Private to lcp/iterative/.
#include <vector>

#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

class ScaledMcp {
 public:
  explicit ScaledMcp(const AffineMcp& problem);  ///< which outlives *this

  Index size() const { return q.size(); }
  Vec expand(const Vec& x) const;
  /// The natural residual of the problem itself at expand(x), of F = M x + q, but for rounding.
  double natural_residual(const Vec& x, const Vec& F) const;
  Vec expand_direction(const Vec& x) const;  ///< zero at fixed variables

  SpMat M;  ///< with a full diagonal in its pattern
  Vec q, l, u;

 private:
  void equilibrate();

  const AffineMcp& problem_;
  std::vector<Index> kept_;
  Vec whole_;
  Vec D_;
  double unit_ = 1;
};

}  // namespace perp::lcp
