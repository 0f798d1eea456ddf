// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Block principal pivoting on dense factors, for small problems with a P-matrix M, such as a positive definite one.
/// Begins in the cell in which the variables are at a bound (B) or inside (I), with
///     M_II z_I = -(q_I + M_IB z_B),   F_B = q_B + M_BB z_B + M_BI z_I,
/// all variables exchange their cells that violate a bound or the sign of their F; only the first one does where that
/// has not made them fewer for some rounds (Judice & Pires, Comput. Oper. Res. 21 (1994) 587). P-matrices have positive
/// pivots in every order, so that the LU of M_II needs no search for pivots, and a pivot that is not positive ends the
/// run.
#include <vector>

#include "lcp/judge/cell.hpp"
#include "lcp/judge/dense_judge.hpp"

namespace perp::lcp {

/// Keeps its memory from problem to problem.
class DensePivoting {
 public:
  /// Forgets the factors: M is another one.
  void renew(const Eigen::MatrixXd& M);
  /// Goes from the cell `cells` to one without violated signs, whose point is z(); false if there is none on the way.
  bool run(const DenseMcp& problem, Cells& cells, const Limits& limits);
  /// A step of refinement of z within its cell, F = F(z).
  void correct(In F, Out z);

  const Vec& z() const { return z_; }
  int rounds() const { return rounds_; }                  ///< of the last run
  int factorizations() const { return factorizations_; }  ///< likewise

 private:
  bool solve_cell(const DenseMcp& problem, const Cells& cells);
  bool factor(const Eigen::MatrixXd& M);
  void solve(Vec& x) const;
  void find_violated(const DenseMcp& problem, const Cells& cells);

  int rounds_ = 0, factorizations_ = 0;
  double largest_ = 0;  ///< max |M_ij|
  Vec z_, F_;
  Vec x_;  ///< of M_II x = b
  std::vector<Index> inside_, violated_;
  std::vector<Index> factored_;  ///< I of the factors at hand
  Eigen::MatrixXd lu_;           ///< of M_II in its corner
};

}  // namespace perp::lcp
