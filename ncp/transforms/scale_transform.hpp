// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scaling by rows and columns as a transform. Private to ncp/.
#include <algorithm>
#include <optional>
#include <utility>

#include "ncp/run/transform.hpp"
#include "ncp/transforms/scaling.hpp"

namespace perp::ncp {

class ScaleTransform final : public Transform {
 public:
  /// `mcp` outlives the transform. With `tol` that is asked of the scaled problem, in its units.
  ScaleTransform(const Mcp& mcp, Scaling factors, std::optional<double> tol = {})
      : mcp_(mcp), factors_(std::move(factors)), scaled_(mcp, factors_), tol_(tol) {}
  const Mcp& problem() const override { return scaled_; }
  Vec there(In x) const override { return scaled_.to_scaled(x); }
  Vec back(In z) const override { return lcp::project(mcp_.box(), scaled_.to_original(z)); }
  Vec iterate_back(const Vec& z, bool normal_map) const override {
    return normal_map ? kink_back(z) : scaled_.to_original(z);
  }
  /// z = C z' in the box, and beyond it (x' - z') / R, as F.
  Vec kink_back(const Vec& x) const override {
    const Vec z = lcp::project(scaled_.box(), x);
    return scaled_.to_original(z) + (x - z).cwiseQuotient(factors_.rows);
  }
  std::vector<lcp::Cell> there(const std::vector<lcp::Cell>& basis) const override { return basis; }
  std::vector<lcp::Cell> back(In, std::vector<lcp::Cell> basis) const override { return basis; }
  Vec multipliers_back(const Vec& y) const override {
    return y.size() == factors_.rows.size() ? Vec(y.cwiseProduct(factors_.rows)) : Vec();
  }
  double tolerance(double tol) const override {
    return tol_ ? *tol_ : std::max(least_tolerance, scaled_.tolerance(tol));
  }
  bool keeps_residuals() const override { return false; }

 private:
  /// What is demanded of the scaled residual where less could not be reached in double precision.
  static constexpr double least_tolerance = 1e-13;

  const Mcp& mcp_;
  Scaling factors_;
  ScaledMcp scaled_;
  std::optional<double> tol_;
};

}  // namespace perp::ncp
