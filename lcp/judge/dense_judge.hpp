// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The judge (lcp/judge/judge.hpp) of problems with a dense M.
#include "lcp/judge/judge.hpp"

namespace perp::lcp {

/// MCP(lower, upper, M z + q).
struct DenseMcp {
  Eigen::MatrixXd M;
  Vec q;
  Box box;

  Index size() const { return q.size(); }
};

Judgement judge(const DenseMcp& problem, In z);

}  // namespace perp::lcp
