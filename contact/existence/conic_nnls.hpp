// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Nonnegative least squares over a cone that is given by its generators, finitely or infinitely many:
///     min |rho|^2,   rho = sum_j x_j c_j + e,   x >= 0,
/// by the active set method of Lawson & Hanson (1974, ch. 23): columns enter one at a time, the caller names them; the
/// columns with x_j > 0 stay linearly independent, so that the supports are small. Ends when no c has c.rho < 0. Their
/// factors C = Q R are changed with them (ch. 24): O(rows columns) for each that enters or leaves.
/// Private to contact/.
#include <vector>

#include "lcp/dense_factors.hpp"
#include "lcp/types.hpp"

namespace perp::contact {

class ConicNnls {
 public:
  struct Column {
    lcp::Index tag = 0;  ///< the caller's
    std::vector<std::pair<lcp::Index, double>> entries{};
    double dot(lcp::In v) const;
  };

  explicit ConicNnls(lcp::Vec e) : e_(std::move(e)), rho_(e_), Q_(e_.size(), 0) {}

  const lcp::Vec& rho() const { return rho_; }
  const std::vector<Column>& columns() const { return columns_; }  ///< those with x > 0
  const lcp::Vec& x() const { return x_; }

  /// Lets the column (of norm 1 or so, with c.rho < 0) enter, and all leave that have to. False: |rho| does not fall,
  /// it depends on the others up to rounding.
  bool enter(Column column);

 private:
  bool least_squares(lcp::Vec& z) const;
  bool append(Column column);
  void drop_zeros();
  void drop(lcp::Index j);
  lcp::Vec residual(const lcp::Vec& x) const;
  lcp::Vec coefficients(const lcp::Vec& v) const;

  lcp::Vec e_;
  lcp::Vec rho_;
  std::vector<Column> columns_;
  lcp::Vec x_;
  Eigen::MatrixXd R_;
  bool keeps_Q_ = true;  // not where it is large: C R^-1 takes its place
  Eigen::MatrixXd Q_;
};

}  // namespace perp::contact
