// SPDX-License-Identifier: Apache-2.0
#include "lcp/affine_mcp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/words.hpp"

namespace perp::lcp {

std::optional<std::string> AffineMcp::invalid() const {
  const Index n = q.size();
  if (M.rows() != n || M.cols() != n || box.lower.size() != n)
    return text_of("M is ", M.rows(), " x ", M.cols(), ", q has ", n, " entries, the box has ", box.lower.size());
  if (auto bad = box.invalid()) return bad;
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(q[i])) return text_of("q of index ", i, " is ", q[i]);
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it)
      if (!std::isfinite(it.value())) return text_of("M of row ", it.row(), ", column ", j, " is ", it.value());
  return std::nullopt;
}

AffineMcp standard_lcp(SpMat M, Vec q) {
  const Index n = q.size();
  return {std::move(M), std::move(q), Box::nonnegative(n)};
}

double natural_residual(const AffineMcp& problem, In z) {
  if (z.size() != problem.size()) {
    refuse_input("natural_residual: z has ", z.size(), " entries, the problem ", problem.size());
  }
  const Vec F = problem.M * z + problem.q;
  if (!F.allFinite() || !z.allFinite()) return infinity;  // an infinity may project onto a bound
  double worst = 0;
  // z - mid(l, z - F, u) = mid(z - u, F, z - l), which does not lose F beside a large z.
  for (Index i = 0; i < z.size(); ++i)
    worst =
        std::max(worst, std::abs(std::min(std::max(F[i], z[i] - problem.box.upper[i]), z[i] - problem.box.lower[i])));
  return worst;
}

}  // namespace perp::lcp
