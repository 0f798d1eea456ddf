// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Why an expression has no value, or no derivative, at a point, in the words of the model: "log(price)" where
/// "price = 0". Evaluates in doubles, so that it finds what the problem's own function finds.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ncp/interval/expression_graph.hpp"

namespace perp::ncp {

using NameOf = std::function<std::string(int)>;

/// A variable, and where its model lets it be: bounds that the problem's box has or has in a row of their own.
struct BoundedVariable {
  int index = 0;
  Interval bounds = Interval::all();
};

struct UndefinedOperation {
  int row = -1;
  std::string operation;  ///< "log(price)", or "the derivative of sqrt(price)"
  std::string argument;   ///< "price = 0", or "a - b = 0"
  std::string where{};    ///< ", where a = 1 and b = 1" if the argument is not a variable; else empty
  bool overflow = false;  ///< the operation has a value, which is too large for a double
  std::vector<BoundedVariable> variables{};  ///< which the arguments depend on, ascending
};

/// A graph's values at one point.
class PointValues {
 public:
  /// x: one number a variable. The graph outlives the object.
  PointValues(const ExpressionGraph& graph, std::span<const double> x);

  /// The value of the node; NaN where it has none, or none is known.
  double operator[](ExpressionGraph::Node node) const { return values_[static_cast<std::size_t>(node)]; }
  /// The operations below the root without a value although their operands have one. With `derivatives` also those
  /// without finite derivatives. An operation that a condition may leave out counts only if there is no other.
  std::vector<UndefinedOperation> undefined(ExpressionGraph::Node root, bool derivatives, const NameOf& name) const;

 private:
  using Node = ExpressionGraph::Node;
  enum class State : char { Known, Unknown, Undefined, Follows };
  State state(Node node) const { return states_[static_cast<std::size_t>(node)]; }
  bool differentiable(Node node) const;
  std::vector<Node> below(Node root, bool conditions) const;
  UndefinedOperation told(Node node, std::span<const double> x, const NameOf& name) const;

  const ExpressionGraph& graph_;
  std::vector<double> x_;
  std::vector<double> values_;
  std::vector<State> states_;
  std::vector<char> varies_;  ///< the node depends on a variable
  std::vector<char> smooth_;  ///< nothing below lacks a value or a derivative
  mutable std::vector<char> visited_;
};

/// The node in the notation of AMPL, with inner parts left out ("...") where it would be longer than a line's half.
std::string text_of(const ExpressionGraph& graph, ExpressionGraph::Node node, const NameOf& name);

}  // namespace perp::ncp
