// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Presolve as a transform. Private to ncp/.
#include "ncp/run/transform.hpp"
#include "ncp/transforms/presolve.hpp"

namespace perp::ncp {

class PresolveTransform final : public Transform {
 public:
  /// Both outlive the transform.
  PresolveTransform(const Mcp& mcp, const Presolved& pre) : mcp_(mcp), pre_(pre) {}
  const Mcp& problem() const override { return pre_.problem(); }
  Vec there(In x) const override { return pre_.reduce(x); }
  Vec back(In z) const override { return pre_.postsolve(z); }
  Vec iterate_back(const Vec& z, bool normal_map) const override;
  Vec kink_back(const Vec& z) const override;
  std::vector<lcp::Cell> there(const std::vector<lcp::Cell>& basis) const override;
  /// The cells of all variables: those that stayed as they are, the others by where they ended.
  std::vector<lcp::Cell> back(In x, std::vector<lcp::Cell> basis) const override;
  Vec multipliers_back(const Vec& y) const override;
  Index equation_back(Index i) const override { return pre_.rows()[static_cast<std::size_t>(i)]; }
  bool keeps_residuals() const override { return true; }

 private:
  const Mcp& mcp_;
  const Presolved& pre_;
};

}  // namespace perp::ncp
