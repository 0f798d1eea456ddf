// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Row and column scaling of an MCP by positive diagonals:  F'(x') = R F(C x'),  l' = C^-1 l,  u' = C^-1 u,
/// x = C x',  J' = R J C. Bounds and signs correspond one to one, and so do the solutions. All factors are powers of
/// two: nothing is rounded, neither in a point nor in a bound nor in J.
///
/// R and C bring the sizes of the entries of J at one point (the start) close together. In turn, every row and every
/// column is divided by the geometric mean of its largest and its smallest |J_ij| (Fulkerson & Wolfe 1962). This
/// approximates the least squares of log |J_ij| (Curtis & Reid 1972). The geometric mean of C is 1, so lengths stay of
/// the same order on average.
#include <optional>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

struct Scaling {
  Vec rows;           ///< R
  Vec columns;        ///< C
  double before = 1;  ///< largest over smallest |J_ij|, see scaling()
  double after = 1;   ///< the same of R J C

  /// Returns whether the scaling brings the entries closer together.
  bool helps() const { return after < before; }
};

/// Computes the factors from J at some point, with the pattern of the problem. Entries that are 0 there are ignored,
/// and so are entries below 1e-8 of the largest in their row and of the largest in their column, which say little about
/// units. Rows and columns of fixed variables are ignored, too; their factors are 1. All factors are 1 if a finite
/// bound would overflow, underflow or coincide with another one. Throws std::invalid_argument if J is not n x n or not
/// finite.
Scaling scaling(const Mcp& mcp, const SpMat& J);

/// The scaled problem. `base` outlives it.
class ScaledMcp final : public Mcp {
 public:
  /// Throws std::invalid_argument if the factors are not n positive finite numbers each.
  ScaledMcp(const Mcp& base, const Scaling& scaling);
  ScaledMcp(Mcp&&, const Scaling&) = delete;

  Vec to_scaled(In x) const { return x.cwiseQuotient(C_); }
  Vec to_original(In x) const { return x.cwiseProduct(C_); }
  /// Returns the tolerance of the scaled problem that guarantees `tol` for the original, at points in the box: tol /
  /// max_i max(C_i, 1 / R_i), because |mid(a, b, c)| <= max(C, 1/R) |mid(a / C, R b, c / C)| for a <= 0 <= c.
  double tolerance(double tol) const;

  const Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return base_.jacobian_pattern(); }
  bool eval(In x, Out F) const override;
  bool jacobian(In x, SpMat& J) const override;
  bool is_affine() const override { return base_.is_affine(); }
  std::vector<bool> linear_entries() const override { return base_.linear_entries(); }
  std::string name() const override { return base_.name(); }
  std::string variable_name(Index i) const override { return base_.variable_name(i); }
  std::string equation_name(Index i) const override { return base_.equation_name(i); }

 private:
  const Mcp& base_;
  Vec R_, C_;
  Box box_;
  mutable Vec x_;  // C x'
};

}  // namespace perp::ncp
