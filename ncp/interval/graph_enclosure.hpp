// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ranges of a function that is written down as expressions.
#include <vector>

#include "lcp/types.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/interval/expression.hpp"

namespace perp::ncp {

class GraphEnclosure final : public Enclosure {
 public:
  /// The ranges of J come in the order of a compressed pattern. A row that mentions a variable beside it is not known.
  GraphEnclosure(Expressions f, const lcp::SpMat& pattern);
  const Expressions& written() const { return f_; }
  double work() const override { return f_.graph.work(); }
  using Enclosure::values;
  void values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const override;
  void jacobian(std::span<const Interval> X, std::span<Interval> J, std::span<char> known) const override;
  std::vector<UndefinedOperation> undefined(std::span<const double> x, bool derivatives,
                                            const NameOf& name) const override;

 private:
  Expressions f_;
  struct Place {
    int variable;
    std::size_t nonzero;
  };
  std::vector<std::vector<Place>> rows_;  ///< of the pattern
  std::vector<char> complete_;            ///< whether the pattern has all that the row mentions
};

}  // namespace perp::ncp
