// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/expression.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ncp/interval/operation_value.hpp"

namespace perp::ncp {
namespace {

/// Of numbers, as the function's own double would have it.
double folded(Operation operation, double a, double b) {
  const std::optional<double> value = value_of(operation, a, b);
  if (!value) throw std::invalid_argument("Expression: no operation of numbers");
  return *value;
}

}  // namespace

Expression Expression::variable(ExpressionGraph& graph, int j) {
  Expression x;
  x.graph_ = &graph;
  x.node_ = graph.variable(j);
  return x;
}

ExpressionGraph::Node Expression::node(ExpressionGraph& graph) const {
  return graph_ == nullptr ? graph.constant(number_) : node_;
}

void Expression::numbers(const Expression& a, const Expression& b) {
  if (a.graph_ != nullptr || b.graph_ != nullptr) throw Compared{};
}

Expression Expression::unary(Operation operation, const Expression& a) {
  if (a.graph_ == nullptr) return folded(operation, a.number_, 0);
  Expression y;
  y.graph_ = a.graph_;
  y.node_ = a.graph_->unary(operation, a.node_);
  return y;
}

Expression Expression::binary(Operation operation, const Expression& a, const Expression& b) {
  if (a.graph_ == nullptr && b.graph_ == nullptr) return folded(operation, a.number_, b.number_);
  Expression y;
  y.graph_ = a.graph_ != nullptr ? a.graph_ : b.graph_;
  const ExpressionGraph::Node first = a.node(*y.graph_);
  y.node_ = y.graph_->binary(operation, first, b.node(*y.graph_));
  return y;
}

std::optional<Expressions> written_down(
    const std::function<bool(std::span<const Expression> x, std::span<Expression> F)>& f, int n) {
  Expressions written;
  std::vector<Expression> x;
  for (int j = 0; j < n; ++j) x.push_back(Expression::variable(written.graph, j));
  std::vector<Expression> F(static_cast<std::size_t>(n));
  try {
    if (!f(x, F)) return std::nullopt;
  } catch (const Expression::Compared&) {
    return std::nullopt;
  }
  for (const Expression& row : F) written.rows.push_back(row.node(written.graph));
  return written;
}

}  // namespace perp::ncp
