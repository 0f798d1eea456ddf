// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Some pairs of a problem, or all with their equations in another order, as a transform. Private to ncp/.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "lcp/linalg/equation_order.hpp"
#include "ncp/reformulation/normal_map.hpp"
#include "ncp/run/transform.hpp"
#include "ncp/transforms/reduced_mcp.hpp"

namespace perp::ncp {

class PartTransform final : public Transform {
 public:
  /// Equation k is signs[k] times row rows[k], variable k is columns[k]; the others keep what they are in `point`,
  /// where F and J may be known. `mcp` outlives the transform.
  PartTransform(const Mcp& mcp, Point point, std::vector<Index> columns, std::vector<Index> rows, Vec signs = {})
      : mcp_(mcp),
        columns_(std::move(columns)),
        rows_(std::move(rows)),
        signs_(std::move(signs)),
        base_(point.x),
        part_(mcp, std::move(point), columns_, rows_, signs_) {}
  const Mcp& problem() const override { return part_; }
  Vec there(In x) const override { return x(columns_); }
  Vec back(In z) const override {
    Vec x = base_;
    x(columns_) = z;
    return x;
  }
  Vec iterate_back(const Vec& z, bool) const override { return back(z); }
  Vec kink_back(const Vec& z) const override { return back(z); }
  std::vector<lcp::Cell> there(const std::vector<lcp::Cell>& basis) const override {
    std::vector<lcp::Cell> cells;
    if (!basis.empty())
      for (const Index j : columns_) cells.push_back(basis[at(j)]);
    return cells;
  }
  std::vector<lcp::Cell> back(In x, std::vector<lcp::Cell> basis) const override {
    if (basis.empty()) return {};
    std::vector<lcp::Cell> cells = cells_at(mcp_.box(), x);
    for (std::size_t k = 0; k < basis.size(); ++k) cells[at(columns_[k])] = basis[k];
    return cells;
  }
  /// Of multipliers of the rows there, those of the rows here: 0 for the rows of other pairs.
  Vec multipliers_back(const Vec& y) const {
    if (y.size() != std::ssize(rows_)) return {};
    Vec here = Vec::Zero(mcp_.size());
    for (Index k = 0; k < y.size(); ++k) here[rows_[at(k)]] = signs_.size() > 0 ? signs_[k] * y[k] : y[k];
    return here;
  }
  std::optional<lcp::Refutation> refutation_back(const lcp::Refutation& there) const override {
    if (!keeps_residuals() || !std::ranges::is_sorted(columns_)) return {};
    const Vec signs = signs_.size() > 0 ? signs_ : Vec(Vec::Ones(mcp_.size()));
    return lcp::EquationOrder{.row_of = rows_, .sign = signs}.back(there);
  }
  Index equation_back(Index i) const override { return rows_[at(i)]; }
  bool keeps_residuals() const override { return std::ssize(columns_) == mcp_.size(); }

 private:
  const Mcp& mcp_;
  std::vector<Index> columns_, rows_;
  Vec signs_, base_;
  ReducedMcp part_;
};

}  // namespace perp::ncp
