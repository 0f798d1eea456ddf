// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Problems made of expressions, with their ranges: F is evaluated as the middle of its range at a point.
#include <memory>
#include <utility>
#include <vector>

#include "ncp/interval/enclosure.hpp"
#include "ncp/interval/expression_graph.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

class GraphProblem final : public Mcp, private Enclosure {
 public:
  GraphProblem(ExpressionGraph graph, std::vector<ExpressionGraph::Node> rows, Box box)
      : graph_(std::move(graph)), rows_(std::move(rows)), box_(std::move(box)), pattern_(dense_pattern(box_.size())) {}

  const Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  const Enclosure* enclosure() const override { return this; }
  bool eval(In x, Out F) const override {
    std::vector<Interval> range(at(size()));
    values(points(x), range);
    for (Index i = 0; i < size(); ++i) F[i] = middle(range[at(i)]);
    return F.allFinite();
  }
  bool jacobian(In x, SpMat& J) const override {
    std::vector<Interval> range(at(J.nonZeros()));
    std::vector<char> known(at(size()));
    jacobian(points(x), range, known);
    for (Index k = 0; k < J.nonZeros(); ++k) J.valuePtr()[k] = middle(range[at(k)]);
    return J.coeffs().allFinite();
  }

 private:
  static double middle(const Interval& a) { return a.lower + (a.upper - a.lower) / 2; }
  static std::vector<Interval> points(In x) { return {x.begin(), x.end()}; }
  using Enclosure::values;
  void values(std::span<const Interval> X, std::span<Interval> F, std::span<char> defined) const override {
    const auto ranges = graph_.ranges(X);
    for (std::size_t i = 0; i < rows_.size(); ++i) F[i] = ranges.values[at(rows_[i])];
    for (std::size_t i = 0; i < defined.size(); ++i) defined[i] = ranges.defined[at(rows_[i])];
  }
  void jacobian(std::span<const Interval> X, std::span<Interval> J, std::span<char> known) const override {
    const auto ranges = graph_.ranges(X);
    const std::size_t n = rows_.size();
    std::vector<char> visited(graph_.size());
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Interval> row(n);
      known[i] = ranges.smooth[at(rows_[i])];
      if (known[i] != 0) graph_.add_derivatives(rows_[i], ranges, row, visited);
      for (std::size_t j = 0; j < n; ++j) J[j * n + i] = row[j];
    }
  }

  ExpressionGraph graph_;
  std::vector<ExpressionGraph::Node> rows_;
  Box box_;
  SpMat pattern_;
};

}  // namespace perp::ncp
