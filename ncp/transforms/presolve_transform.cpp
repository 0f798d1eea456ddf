// SPDX-License-Identifier: Apache-2.0
#include "ncp/transforms/presolve_transform.hpp"

#include "ncp/reformulation/normal_map.hpp"

namespace perp::ncp {

Vec PresolveTransform::iterate_back(const Vec& z, bool) const {
  return pre_.postsolve(lcp::project(pre_.problem().box(), z));
}

Vec PresolveTransform::kink_back(const Vec& z) const {
  Vec full = iterate_back(z, true);
  for (std::size_t k = 0; k < pre_.columns().size(); ++k) full[pre_.columns()[k]] = z[static_cast<Index>(k)];
  return full;
}

// Rows that went have bounded their variables: the proof here knows it from the rows themselves.
Vec PresolveTransform::multipliers_back(const Vec& y) const {
  if (y.size() != static_cast<Index>(pre_.rows().size())) return {};
  Vec full = Vec::Zero(mcp_.size());
  for (Index k = 0; k < y.size(); ++k) full[equation_back(k)] = y[k];
  return full;
}

std::vector<lcp::Cell> PresolveTransform::there(const std::vector<lcp::Cell>& basis) const {
  std::vector<lcp::Cell> cells;
  if (!basis.empty())
    for (const Index j : pre_.columns()) cells.push_back(basis[static_cast<std::size_t>(j)]);
  return cells;
}

std::vector<lcp::Cell> PresolveTransform::back(In x, std::vector<lcp::Cell> basis) const {
  if (basis.empty()) return {};
  std::vector<lcp::Cell> cells = cells_at(mcp_.box(), x);
  for (std::size_t k = 0; k < basis.size(); ++k) cells[static_cast<std::size_t>(pre_.columns()[k])] = basis[k];
  return cells;
}

}  // namespace perp::ncp
