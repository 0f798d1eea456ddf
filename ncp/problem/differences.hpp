// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Jacobians by differences of F, one step for each group of columns that share no row (ncp/problem/colouring.hpp).
///   Forward:  J_ij = (F_i(x + a_j e_j) - F_i(x)) / a_j,        |a_j| = sqrt(noise) max(1, |x_j|),  error O(a)
///   Central:  J_ij = (F_i(x + a_j e_j) - F_i(x - a_j e_j)) / 2 a_j,  a_j = noise^(1/3) max(1, |x_j|),  error O(a^2)
/// These lengths balance the curvature that a quotient leaves out against the rounding of F that it magnifies (Gill,
/// Murray & Wright, Practical Optimization, 1981, section 8.6).
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "lcp/box.hpp"

namespace perp::ncp {

struct DifferenceFormula {
  bool central = false;  ///< two evaluations of F a group in place of one
  /// Relative error of the values of F, within 0 and 1: larger than a rounding where F comes of an iteration or a
  /// table.
  double noise = std::numeric_limits<double>::epsilon();
};

/// Of one problem; used by one thread at a time.
class ColouredDifferences {
 public:
  /// F(x, F), with n rows: false where it is not defined.
  using Function = std::function<bool(lcp::In x, lcp::Out F)>;

  /// `pattern`: n x n, compressed; it outlives this object. Throws std::invalid_argument if the noise is not in (0, 1).
  explicit ColouredDifferences(const lcp::SpMat& pattern, const DifferenceFormula& formula = {});
  lcp::Index colours() const { return static_cast<lcp::Index>(groups_.size()); }
  /// By jacobian() so far.
  long F_evals() const { return F_evals_; }

  /// F at x is known: jacobian() at the same x does not evaluate it again.
  void keep(lcp::In x, lcp::In F);
  /// Fills in the values of J at x, in the pattern's order. Steps stay in the box: they lead to the other side where a
  /// bound is near, and get as short as the box (but not below 1/64) where it is narrow; only of fixed variables, and
  /// of those in narrower boxes, F is evaluated outside of it. Where F is not defined after a step, the other side
  /// counts, then each column of the group by itself. False if that does not help, or if F is not defined at x.
  bool jacobian(const Function& function, const lcp::Box& box, lcp::In x, double* value);

 private:
  struct Steps {
    double first = 0;
    double second = 0;  ///< of three points
  };
  std::optional<Steps> steps(const lcp::Box& box, lcp::Index j, int attempt) const;
  int attempts() const { return formula_.central ? 3 : 2; }
  bool evaluate(const Function& function, lcp::In x, lcp::Vec& F);
  bool group(const Function& function, const lcp::Box& box, const std::vector<int>& columns, double* value);
  std::vector<int> quotients(const Function& function, const lcp::Box& box, const std::vector<int>& columns,
                             int attempt, double* value);
  bool column(int j, const lcp::Vec& first, const lcp::Vec& second, double* value) const;

  const lcp::SpMat& pattern_;
  DifferenceFormula formula_;
  std::vector<std::vector<int>> groups_;
  long F_evals_ = 0;
  bool known_ = false;
  lcp::Vec x_{}, F_{};                  // F at x, if known
  lcp::Vec moved_[2]{}, F_moved_[2]{};  // x and F after the steps
};

}  // namespace perp::ncp
