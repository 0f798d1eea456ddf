// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/graph_enclosure.hpp"

#include <algorithm>
#include <utility>

namespace perp::ncp {

GraphEnclosure::GraphEnclosure(Expressions f, const lcp::SpMat& pattern) : f_(std::move(f)), rows_(f_.rows.size()) {
  std::size_t nonzero = 0;
  for (lcp::Index j = 0; j < pattern.cols(); ++j)
    for (lcp::SpMat::InnerIterator it(pattern, j); it; ++it)
      rows_[static_cast<std::size_t>(it.row())].push_back({static_cast<int>(j), nonzero++});
  std::vector<char> visited(f_.graph.size(), 0);
  for (std::size_t i = 0; i < f_.rows.size(); ++i)  // both ascend
    complete_.push_back(std::ranges::includes(rows_[i], f_.graph.mentions(f_.rows[i], visited), {}, &Place::variable,
                                              &ExpressionGraph::Mention::variable)
                            ? 1
                            : 0);
}

void GraphEnclosure::values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const {
  const auto ranges = f_.graph.ranges(X);
  for (std::size_t i = 0; i < F.size(); ++i) F[i] = ranges.values[static_cast<std::size_t>(f_.rows[i])];
  for (std::size_t i = 0; i < defined.size(); ++i) defined[i] = ranges.defined[static_cast<std::size_t>(f_.rows[i])];
}

void GraphEnclosure::jacobian(std::span<const Interval> X, std::span<Interval> J, std::span<char> known) const {
  const auto ranges = f_.graph.ranges(X);
  std::vector<Interval> derivatives(X.size());
  std::vector<char> visited(f_.graph.size(), 0);
  for (std::size_t i = 0; i < known.size(); ++i) {
    known[i] = complete_[i] != 0 ? ranges.smooth[static_cast<std::size_t>(f_.rows[i])] : char{0};
    if (known[i] != 0) f_.graph.add_derivatives(f_.rows[i], ranges, derivatives, visited);
    for (const Place& place : rows_[i]) {
      Interval& derivative = derivatives[static_cast<std::size_t>(place.variable)];
      J[place.nonzero] = known[i] != 0 ? derivative : Interval::all();
      derivative = 0;
    }
  }
}

std::vector<UndefinedOperation> GraphEnclosure::undefined(std::span<const double> x, bool derivatives,
                                                          const NameOf& name) const {
  const PointValues values(f_.graph, x);
  std::vector<UndefinedOperation> found;
  for (std::size_t i = 0; i < f_.rows.size(); ++i)
    for (UndefinedOperation& operation : values.undefined(f_.rows[i], derivatives, name)) {
      operation.row = static_cast<int>(i);
      found.push_back(std::move(operation));
    }
  return found;
}

}  // namespace perp::ncp
