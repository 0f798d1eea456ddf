// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/linear_part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ncp/problem/affine.hpp"
#include "ncp/problem/counted_mcp.hpp"

namespace perp::ncp {

std::optional<LinearPart> linear_part(const Mcp& mcp, In x) {
  if (mcp.is_affine()) {
    const auto all = affine_part(mcp);
    if (!all) return std::nullopt;
    return LinearPart{.problem = *all};
  }
  const std::vector<bool> linear = mcp.linear_entries();
  if (linear.empty()) return std::nullopt;
  CountedMcp guarded(mcp);
  SpMat J = mcp.jacobian_pattern();
  if (!guarded.jacobian(x, J)) return std::nullopt;
  LinearPart out{
      .problem = {.M = {}, .q = Vec::Constant(mcp.size(), std::numeric_limits<double>::quiet_NaN()), .box = mcp.box()},
      .rows = std::vector<char>(at(mcp.size()), 1)};
  // Other rows may not be defined at 0: theirs are not asked for.
  mcp.eval(Vec::Zero(mcp.size()), out.problem.q);
  std::size_t p = 0;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it, ++p)
      if (!linear[p]) out.rows[at(it.row())] = 0;
  for (Index i = 0; i < mcp.size(); ++i) {
    if (!std::isfinite(out.problem.q[i])) out.rows[at(i)] = 0;
    if (out.rows[at(i)] == 0) out.problem.q[i] = 0;
  }
  if (std::ranges::none_of(out.rows, [](char known) { return known != 0; })) return std::nullopt;
  J.prune([&out](Index i, Index, double value) { return out.rows[at(i)] != 0 && value != 0; });
  out.problem.M = std::move(J);
  return out;
}

}  // namespace perp::ncp
