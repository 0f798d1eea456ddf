// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An Mcp as equations and complementarity on the orthant, for solvers that know no boxes:
///     G_e(z) = 0, z_e free (n1 of them),    0 <= z_c _|_ G_c(z) >= 0 (n2).
/// With s the sign and o the origin of x_i = o_i + s_i z_k:
///     free           z = x,      G = F_i
///     l <= x         z = x - l,  G = F_i
///     x <= u         z = u - x,  G = -F_i
///     l <= x <= u    z = x - l,  G = F_i + v,  with one more v >= 0 _|_ u - x >= 0, which takes up F_i < 0 at u
///     l = u          no unknown
/// The solutions are those of the Mcp, v = max(0, -F_i). An Mcp of free unknowns and of those with bounds on one side
/// keeps its size.
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::bench {

class Orthant {
 public:
  /// Refers to the Mcp.
  explicit Orthant(const ncp::Mcp& mcp);
  ncp::Index equations() const { return equations_; }
  ncp::Index size() const { return size_; }
  ncp::Index multipliers() const { return size_ - static_cast<ncp::Index>(unknowns_.size()); }

  /// z of x, the part on the orthant projected on it; multipliers 0.
  ncp::Vec from(ncp::In x) const;
  ncp::Vec point(ncp::In z) const;  ///< x of z
  /// G(z), size() entries; false: not defined.
  bool eval(ncp::In z, ncp::Out G) const;
  /// G'(z), dense; false: not defined.
  bool jacobian(ncp::In z, Eigen::Ref<Eigen::MatrixXd> J);

 private:
  struct Unknown {
    ncp::Index i = 0;  ///< of the Mcp
    double sign = 1;
    double origin = 0;
    ncp::Index multiplier = -1;  ///< its place in z
  };

  const ncp::Mcp& mcp_;
  std::vector<Unknown> unknowns_{};  ///< of the places 0, 1, ... in z
  std::vector<ncp::Index> place_;    ///< of x_i in z; -1: fixed
  ncp::Index equations_ = 0;
  ncp::Index size_ = 0;
  ncp::SpMat J_;
};

}  // namespace perp::bench
