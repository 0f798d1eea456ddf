#pragma once
/// Jacobians by differences of F, a step for each group of columns that share no row (Curtis, Powell & Reid, IMA J.
/// Appl. Math. 13 (1974) 117): as many evaluations of F as there are groups, n of them for a dense pattern.
#include <functional>
#include <vector>

#include "lcp/box.hpp"

namespace perp::python {

class Differences {
 public:
  /// F(x, F): false where it is not defined.
  using F = std::function<bool(lcp::In x, lcp::Vec& F)>;

  explicit Differences(const lcp::SpMat& pattern);
  lcp::Index groups() const { return static_cast<lcp::Index>(groups_.size()); }

  /// value := (F(x + h e_j) - F(x)) / h in the pattern's order, with h_j = sqrt(eps) max(1, |x_j|). Steps lead into the
  /// box; where F is not defined there, the other way. False if F is not defined at x or at either side of it.
  bool jacobian(const F& function, const lcp::Box& box, lcp::In x, double* value) const;

 private:
  bool group(const std::vector<int>& columns, const F& function, lcp::In x, const lcp::Vec& F0, const lcp::Vec& step,
             double* value) const;

  const lcp::SpMat& pattern_;
  std::vector<std::vector<int>> groups_;
};

}  // namespace perp::python
