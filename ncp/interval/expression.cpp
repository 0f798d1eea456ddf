// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/expression.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace perp::ncp {
namespace {

/// Of numbers, as the function's own double would have it.
double folded(Operation operation, double a) {
  switch (operation) {
    case Operation::Negate:
      return -a;
    case Operation::Floor:
      return std::floor(a);
    case Operation::Ceil:
      return std::ceil(a);
    case Operation::Absolute:
      return std::abs(a);
    case Operation::Sqrt:
      return std::sqrt(a);
    case Operation::Exp:
      return std::exp(a);
    case Operation::Log:
      return std::log(a);
    case Operation::Log10:
      return std::log10(a);
    case Operation::Sin:
      return std::sin(a);
    case Operation::Cos:
      return std::cos(a);
    case Operation::Tan:
      return std::tan(a);
    case Operation::Asin:
      return std::asin(a);
    case Operation::Acos:
      return std::acos(a);
    case Operation::Atan:
      return std::atan(a);
    case Operation::Sinh:
      return std::sinh(a);
    case Operation::Cosh:
      return std::cosh(a);
    case Operation::Tanh:
      return std::tanh(a);
    case Operation::Asinh:
      return std::asinh(a);
    case Operation::Acosh:
      return std::acosh(a);
    case Operation::Atanh:
      return std::atanh(a);
    default:
      throw std::invalid_argument("Expression: no operation of one number");
  }
}

double folded(Operation operation, double a, double b) {
  switch (operation) {
    case Operation::Add:
      return a + b;
    case Operation::Subtract:
      return a - b;
    case Operation::Multiply:
      return a * b;
    case Operation::Divide:
      return a / b;
    case Operation::Power:
      return std::pow(a, b);
    case Operation::Minimum:
      return std::min(a, b);
    case Operation::Maximum:
      return std::max(a, b);
    case Operation::Atan2:
      return std::atan2(a, b);
    default:
      throw std::invalid_argument("Expression: no operation of two numbers");
  }
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
  if (a.graph_ == nullptr) return folded(operation, a.number_);
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
