// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Points of { (z, w) : w = M z + q, bounds on every z_i and w_i }, dense, for small systems whose bounds change a few
/// at a time. Some n of the 2n variables are basic, x_B = T x_N + const; the nonbasic ones keep their bounds, and
/// violated bounds of basic ones are repaired by pivoting (Dutertre & de Moura 2006). Private to lcp/.
#include <Eigen/Core>
#include <vector>

#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

class BoundedRows {
 public:
  enum class Feasibility { Feasible, Empty, Undecided };

  /// Variables z_0 .. z_{n-1}, w_0 .. w_{n-1}. z has the box's bounds, w none.
  BoundedRows(const Eigen::MatrixXd& M, const Vec& q, const Box& box, double tol);

  Index z(Index i) const { return i; }
  Index w(Index i) const { return size() + i; }
  Index size() const { return T_.rows(); }
  double value(Index x) const { return value_[x]; }

  void set_bounds(Index x, double lower, double upper);
  /// A point within all bounds (but for tol (1 + |bound|)), or a row of T, that says there is none. Ends by Bland's
  /// rule; Undecided if rounding keeps it from ending.
  Feasibility repair();
  /// After Empty: y with sup y'(M z + q - w) < 0 over the bounds, but for the rounding of T: the row in the data.
  Vec multipliers() const;
  Box z_bounds() const { return {lower_.head(size()), upper_.head(size())}; }
  Box w_bounds() const { return {lower_.tail(size()), upper_.tail(size())}; }
  void set_tolerance(double tol) { tol_ = tol; }
  /// From a feasible point: moves x up (direction 1) or down (-1) within the bounds until it is beyond `target`; false
  /// if it cannot be.
  bool push(Index x, double direction, double target);

 private:
  bool below(Index x) const { return value_[x] < lower_[x] - tol_ * (1 + std::abs(lower_[x])); }
  bool above(Index x) const { return value_[x] > upper_[x] + tol_ * (1 + std::abs(upper_[x])); }
  Index violated_row(bool bland) const;
  Index entering(Index row, double direction, bool bland) const;
  double ratio_test(Index column, double direction, Index& blocking) const;
  void move(Index column, double step);
  void pivot(Index row, Index column);

  Eigen::MatrixXd T_;
  Vec value_;
  Vec lower_;
  Vec upper_;
  std::vector<Index> basic_;     ///< of a row
  std::vector<Index> nonbasic_;  ///< of a column
  std::vector<Index> place_;     ///< of a variable: row, or -1 - column
  Index empty_row_ = -1;
  double tol_;
};

}  // namespace perp::lcp
