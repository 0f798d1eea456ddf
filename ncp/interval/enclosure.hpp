// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ranges of a problem's F and J over boxes, from the expressions behind them.
#include <span>
#include <vector>

#include "ncp/interval/interval.hpp"
#include "ncp/interval/undefined.hpp"

namespace perp::ncp {

class Enclosure {
 public:
  virtual ~Enclosure() = default;
  /// What values() costs, in additions, roughly; 0: little.
  virtual double work() const { return 0; }
  /// F(x) lies in F for every x of the box X where F is defined. A row that is defined nowhere there is empty.
  /// X and F: one interval a variable. `defined`, one flag a row, or none if nobody asks: F_i is defined on all of X.
  /// Throws std::bad_alloc.
  virtual void values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const = 0;
  void values(std::span<const Interval> X, std::span<Interval> F) const { values(X, F, {}); }
  /// J(x) lies in J for every x of the box X, one interval a nonzero of the problem's pattern, in its order; where F is
  /// only Lipschitz continuous, Clarke's Jacobian. `known`, one flag a row: F_i is defined and Lipschitz continuous on
  /// all of X, so that its entries mean something. Throws std::bad_alloc.
  virtual void jacobian(std::span<const Interval> X, std::span<Interval> J, std::span<char> known) const = 0;
  /// The operations that leave rows of F without a value at x, or with `derivatives` rows of J; `name` is that of a
  /// variable. None: none is known.
  virtual std::vector<UndefinedOperation> undefined(std::span<const double> /*x*/, bool /*derivatives*/,
                                                    const NameOf& /*name*/) const {
    return {};
  }
};

}  // namespace perp::ncp
