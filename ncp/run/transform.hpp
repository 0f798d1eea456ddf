// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A problem made from a problem, and the way there and back: presolved, scaled. Private to ncp/.
#include <optional>
#include <vector>

#include "lcp/judge/refutation.hpp"
#include "lcp/pivoting/lemke.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

class Transform {
 public:
  virtual ~Transform() = default;
  /// The problem that is made; it evaluates the one it is made from.
  virtual const Mcp& problem() const = 0;
  /// Of points of the box, into the box.
  virtual Vec there(In x) const = 0;
  virtual Vec back(In z) const = 0;
  /// Of points of R^n, for observers: iterates, which may be of the normal map, and kinks of its paths.
  virtual Vec iterate_back(const Vec& z, bool normal_map) const = 0;
  virtual Vec kink_back(const Vec& z) const = 0;
  virtual std::vector<lcp::Cell> there(const std::vector<lcp::Cell>& basis) const = 0;
  /// `x` is the point that belongs to the basis, back() already.
  virtual std::vector<lcp::Cell> back(In x, std::vector<lcp::Cell> basis) const = 0;
  /// Returns the multipliers of the rows here, for those of the rows there; empty where that is not known.
  virtual Vec multipliers_back(const Vec&) const { return {}; }
  /// Returns the certificate of the problem here, for that of the problem there; nothing where that is not known.
  virtual std::optional<lcp::Refutation> refutation_back(const lcp::Refutation&) const { return {}; }
  virtual Index equation_back(Index i) const { return i; }
  /// What is asked of the natural residual there, for `tol` here.
  virtual double tolerance(double tol) const { return tol; }
  /// Whether a natural residual there is one here too.
  virtual bool keeps_residuals() const = 0;
};

}  // namespace perp::ncp
