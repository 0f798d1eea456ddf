// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/expression_graph.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "ncp/interval/operation_value.hpp"

namespace perp::ncp {
namespace {

using Slopes = std::pair<Interval, Interval>;  // with respect to the first operand and to the second

/// Either and Guarded are of intervals alone.
Interval combined(Operation operation, const Interval& a, const Interval& b) {
  if (operation == Operation::Either) return hull(a, b);
  if (operation == Operation::Guarded) return a;
  return value_of(operation, a, b).value_or(Interval::all());
}

/// f'(A), where f(A) = y.
Interval slope(Operation operation, const Interval& a, const Interval& y) {
  const Interval one(1);
  switch (operation) {
    case Operation::Negate:
      return -1;
    case Operation::Absolute:
      return {a.lower > 0 ? 1.0 : -1.0, a.upper < 0 ? -1.0 : 1.0};
    case Operation::Sqrt:
      return one / (Interval(2) * y);
    case Operation::Exp:
      return y;
    case Operation::Log:
      return one / a;
    case Operation::Log10:
      return one / (a * log(Interval(10)));
    case Operation::Sin:
      return cos(a);
    case Operation::Cos:
      return -sin(a);
    case Operation::Tan:
      return one + square(y);
    case Operation::Asin:
      return one / sqrt(one - square(a));
    case Operation::Acos:
      return -(one / sqrt(one - square(a)));
    case Operation::Atan:
      return one / (one + square(a));
    case Operation::Sinh:
      return cosh(a);
    case Operation::Cosh:
      return sinh(a);
    case Operation::Tanh:
      return one - square(y);
    case Operation::Asinh:
      return one / sqrt(square(a) + one);
    case Operation::Acosh:
      return one / sqrt(square(a) - one);
    case Operation::Atanh:
      return one / (one - square(a));
    default:
      return Interval::all();
  }
}

/// b = a constant: b a^(b - 1). Else also a^b log(a) with respect to b, of which nothing is known for a <= 0: there b
/// is an integer that does not vary.
Slopes slopes_of_power(const Interval& a, const Interval& b, const Interval& y) {
  return {b * power(a, b - Interval(1)), a.upper > 0 ? y * log(a) : Interval::all()};
}

/// Of min (sign 1) and max (sign -1) with respect to the first operand: 1 where it is surely the smaller one.
Slopes slopes_of_minimum(const Interval& a, const Interval& b, bool maximum) {
  const bool first = maximum ? a.lower > b.upper : a.upper < b.lower;
  const bool second = maximum ? b.lower > a.upper : b.upper < a.lower;
  return {first    ? Interval(1)
          : second ? Interval(0)
                   : Interval(0, 1),
          second  ? Interval(1)
          : first ? Interval(0)
                  : Interval(0, 1)};
}

Slopes slopes(Operation operation, const Interval& a, const Interval& b, const Interval& y) {
  switch (operation) {
    case Operation::Add:
      return {1, 1};
    case Operation::Subtract:
      return {1, -1};
    case Operation::Multiply:
      return {b, a};
    case Operation::Divide:
      return {Interval(1) / b, -(y / b)};
    case Operation::Power:
      return slopes_of_power(a, b, y);
    case Operation::Minimum:
      return slopes_of_minimum(a, b, false);
    case Operation::Maximum:
      return slopes_of_minimum(a, b, true);
    case Operation::Atan2: {
      const Interval r2 = square(a) + square(b);
      return {b / r2, -(a / r2)};
    }
    default:
      return {Interval::all(), Interval::all()};
  }
}

/// Is f defined on all of A?
bool defined_on(Operation operation, const Interval& a) {
  switch (operation) {
    case Operation::Sqrt:
      return a.lower >= 0;
    case Operation::Log:
    case Operation::Log10:
      return a.lower > 0;
    case Operation::Asin:
    case Operation::Acos:
      return a.lower >= -1 && a.upper <= 1;
    case Operation::Atanh:
      return a.lower > -1 && a.upper < 1;
    case Operation::Acosh:
      return a.lower >= 1;
    case Operation::Tan:
      return tan(a).bounded();
    default:
      return true;
  }
}

bool defined_on(Operation operation, const Interval& a, const Interval& b) {
  if (operation == Operation::Divide) return !b.contains(0);
  if (operation != Operation::Power || a.lower > 0) return true;
  const bool integer = b.is_point() && b.lower == std::floor(b.lower);
  return b.lower >= 0 ? integer || a.lower >= 0 : integer && !a.contains(0);
}

/// Is f, which is defined on all of A, Lipschitz continuous there?
bool smooth_on(Operation operation, const Interval& a) {
  switch (operation) {
    case Operation::Floor:
    case Operation::Ceil:
      return false;
    case Operation::Sqrt:
      return a.lower > 0;
    case Operation::Asin:
    case Operation::Acos:
      return a.lower > -1 && a.upper < 1;
    case Operation::Acosh:
      return a.lower > 1;
    default:
      return true;
  }
}

bool smooth_on(Operation operation, const Interval& a, const Interval& b) {
  switch (operation) {
    case Operation::Power:
      return a.lower > 0 || (b.is_point() && b.lower >= 1 && (a.lower >= 0 || b.lower == std::floor(b.lower)));
    case Operation::Either:
    case Operation::Guarded:
      return false;
    case Operation::Atan2:
      return b.lower > 0;
    default:
      return true;
  }
}

}  // namespace

ExpressionGraph::Node ExpressionGraph::add(Entry entry) {
  nodes_.push_back(entry);
  return static_cast<Node>(nodes_.size() - 1);
}

ExpressionGraph::Node ExpressionGraph::constant(double value) {
  return add({.operation = Operation::Constant, .value = value});
}
ExpressionGraph::Node ExpressionGraph::variable(int index) {
  return add({.operation = Operation::Variable, .a = index});
}
ExpressionGraph::Node ExpressionGraph::unknown() { return add({}); }
ExpressionGraph::Node ExpressionGraph::unary(Operation operation, Node a) {
  if (is_binary(operation) || operation >= Operation::Constant)
    throw std::invalid_argument("ExpressionGraph: an operation of one operand is asked for");
  return add({.operation = operation, .a = a});
}
ExpressionGraph::Node ExpressionGraph::binary(Operation operation, Node a, Node b) {
  if (!is_binary(operation)) throw std::invalid_argument("ExpressionGraph: an operation of two operands is asked for");
  return add({.operation = operation, .a = a, .b = b});
}
ExpressionGraph::Node ExpressionGraph::sum(std::span<const Node> terms) {
  if (terms.empty()) return constant(0);
  Node total = terms.front();
  for (const Node term : terms.subspan(1)) total = binary(Operation::Add, total, term);
  return total;
}

Interval ExpressionGraph::value(const Entry& entry, std::span<const Interval> values,
                                std::span<const Interval> X) const {
  switch (entry.operation) {
    case Operation::Constant:  // an infinity is no number, and x / inf is 0 for the function itself
      return std::isfinite(entry.value) ? entry.value : Interval::all();
    case Operation::Variable:
      return X[static_cast<std::size_t>(entry.a)];
    case Operation::Unknown:
      return Interval::all();
    default:
      break;
  }
  const Interval& a = values[static_cast<std::size_t>(entry.a)];
  if (!is_binary(entry.operation)) return combined(entry.operation, a, a);
  const Entry& first = nodes_[static_cast<std::size_t>(entry.a)];
  const Entry& second = nodes_[static_cast<std::size_t>(entry.b)];
  const bool same = entry.a == entry.b || (first.operation == Operation::Variable &&
                                           second.operation == Operation::Variable && first.a == second.a);
  if (same && entry.operation == Operation::Multiply) return square(a);
  return combined(entry.operation, a, values[static_cast<std::size_t>(entry.b)]);
}

void ExpressionGraph::add_domain(const Entry& entry, Ranges& ranges) const {
  bool defined = true, smooth = true;
  const auto operand = [&](Node node) -> const Interval& {
    defined = defined && ranges.defined[static_cast<std::size_t>(node)] != 0;
    smooth = smooth && ranges.smooth[static_cast<std::size_t>(node)] != 0;
    return ranges.values[static_cast<std::size_t>(node)];
  };
  if (entry.operation >= Operation::Constant) {
    defined = entry.operation == Operation::Variable ||
              (entry.operation == Operation::Constant && std::isfinite(entry.value));
  } else if (const Interval& a = operand(entry.a); is_binary(entry.operation)) {
    const Interval& b = operand(entry.b);
    defined = defined && defined_on(entry.operation, a, b);
    smooth = smooth && smooth_on(entry.operation, a, b);
  } else {
    defined = defined && defined_on(entry.operation, a);
    smooth = smooth && smooth_on(entry.operation, a);
  }
  ranges.defined.push_back(defined ? 1 : 0);
  ranges.smooth.push_back(defined && smooth ? 1 : 0);
}

ExpressionGraph::Ranges ExpressionGraph::ranges(std::span<const Interval> X) const {
  Ranges ranges;
  ranges.values.reserve(nodes_.size());
  ranges.defined.reserve(nodes_.size());
  ranges.smooth.reserve(nodes_.size());
  for (const Entry& entry : nodes_) {
    ranges.values.push_back(value(entry, ranges.values, X));
    add_domain(entry, ranges);
  }
  return ranges;
}

double ExpressionGraph::work() const {
  constexpr double elementary = 300;  // a function by MPFI
  double sum = 0;
  for (const auto& [operation, a, b, value] : nodes_) {
    const bool cheap = operation <= Operation::Multiply || operation == Operation::Minimum ||
                       operation == Operation::Maximum || operation == Operation::Negate ||
                       operation >= Operation::Constant;
    sum += cheap ? 1 : elementary;
  }
  return sum;
}

std::vector<ExpressionGraph::Node> ExpressionGraph::below(Node root, std::vector<char>& visited) const {
  std::vector<Node> below{root};
  visited[static_cast<std::size_t>(root)] = 1;
  const auto visit = [&](Node node) {
    if (std::exchange(visited[static_cast<std::size_t>(node)], 1) == 0) below.push_back(node);
  };
  for (std::size_t k = 0; k < below.size(); ++k) {
    const Entry& entry = nodes_[static_cast<std::size_t>(below[k])];
    if (entry.operation >= Operation::Constant) continue;
    visit(entry.a);
    if (is_binary(entry.operation)) visit(entry.b);
  }
  std::ranges::sort(below, std::greater{});
  return below;
}

std::vector<ExpressionGraph::Mention> ExpressionGraph::mentions(Node root, std::vector<char>& visited) const {
  constexpr char constant = 1, linear = 2, nonlinear = 4;  // flags: what the node is, and how the root depends on it
  const std::vector<Node> nodes = below(root, visited);
  const auto flags = [&](Node node) -> char& { return visited[static_cast<std::size_t>(node)]; };
  const auto is_constant = [&](Node node) { return (flags(node) & constant) != 0; };
  for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) {
    const Node node = *it;
    const Entry& entry = nodes_[static_cast<std::size_t>(node)];
    const bool leaf = entry.operation >= Operation::Constant;
    const bool same = leaf ? entry.operation == Operation::Constant
                           : is_constant(entry.a) && (!is_binary(entry.operation) || is_constant(entry.b));
    flags(node) = same ? constant : 0;
  }
  flags(root) = static_cast<char>(flags(root) | linear);
  std::vector<Mention> mentions;
  for (const Node node : nodes) {
    const Entry& entry = nodes_[static_cast<std::size_t>(node)];
    const char how = static_cast<char>(std::exchange(flags(node), 0) & (linear | nonlinear));
    if (entry.operation == Operation::Variable) mentions.push_back({.variable = entry.a, .linear = how == linear});
    if (entry.operation >= Operation::Constant) continue;
    const bool binary = is_binary(entry.operation);
    const bool keeps = entry.operation == Operation::Add || entry.operation == Operation::Subtract ||
                       entry.operation == Operation::Negate ||
                       (entry.operation == Operation::Multiply && (is_constant(entry.a) || is_constant(entry.b))) ||
                       (entry.operation == Operation::Divide && is_constant(entry.b));
    for (const Node operand : {entry.a, binary ? entry.b : entry.a})
      flags(operand) = static_cast<char>(flags(operand) | (keeps ? how : nonlinear));
  }
  // A variable may have several nodes.
  std::ranges::sort(mentions, {}, [](const Mention& m) { return std::pair(m.variable, m.linear); });
  // The first one stays: it is not linear if any is.
  const auto same = [](const Mention& a, const Mention& b) { return a.variable == b.variable; };
  mentions.erase(std::unique(mentions.begin(), mentions.end(), same), mentions.end());
  return mentions;
}

void ExpressionGraph::add_derivatives(Node root, const Ranges& ranges, std::span<Interval> derivatives,
                                      std::vector<char>& visited) const {
  const std::vector<Node> nodes = below(root, visited);
  std::vector<Interval> adjoint(nodes.size());
  const auto place = [&](Node node) {
    return static_cast<std::size_t>(std::ranges::lower_bound(nodes, node, std::greater{}) - nodes.begin());
  };
  adjoint.front() = 1;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto node = static_cast<std::size_t>(nodes[k]);
    visited[node] = 0;
    const Entry& entry = nodes_[node];
    if (entry.operation == Operation::Variable) derivatives[static_cast<std::size_t>(entry.a)] += adjoint[k];
    if (entry.operation >= Operation::Constant) continue;
    const Interval& y = ranges.values[node];
    const Interval& a = ranges.values[static_cast<std::size_t>(entry.a)];
    if (!is_binary(entry.operation)) {
      adjoint[place(entry.a)] += adjoint[k] * slope(entry.operation, a, y);
      continue;
    }
    const auto [first, second] = slopes(entry.operation, a, ranges.values[static_cast<std::size_t>(entry.b)], y);
    adjoint[place(entry.a)] += adjoint[k] * first;
    if (nodes_[static_cast<std::size_t>(entry.b)].operation != Operation::Constant)
      adjoint[place(entry.b)] += adjoint[k] * second;
  }
}

}  // namespace perp::ncp
