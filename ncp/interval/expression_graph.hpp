// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Expressions of n variables as an acyclic graph, of which subexpressions that are used several times are part once;
/// their ranges over a box, and those of their derivatives.
#include <cstdint>
#include <span>
#include <vector>

#include "ncp/interval/interval.hpp"

namespace perp::ncp {

/// Operations; those of two operands stand first.
enum class Operation : std::uint8_t {
  Add,
  Subtract,
  Multiply,
  Divide,
  Power,
  Minimum,
  Maximum,
  Either,   ///< one of two values, nobody knows which: conditions are not decided
  Guarded,  ///< the first, where the second has a value: what a condition compares
  Atan2,
  Negate,
  Absolute,
  Floor,
  Ceil,
  Sqrt,
  Exp,
  Log,
  Log10,
  Sin,
  Cos,
  Tan,
  Asin,
  Acos,
  Atan,
  Sinh,
  Cosh,
  Tanh,
  Asinh,
  Acosh,
  Atanh,
  Constant,
  Variable,
  Unknown,  ///< any number
};

class ExpressionGraph {
 public:
  using Node = int;

  Node constant(double value);
  Node variable(int index);
  Node unknown();
  Node unary(Operation operation, Node a);
  Node binary(Operation operation, Node a, Node b);
  /// The sum of all; 0 if there are none.
  Node sum(std::span<const Node> terms);

  std::size_t size() const { return nodes_.size(); }
  /// Operands come before what they are operands of: a, b < node.
  struct Entry {
    Operation operation = Operation::Unknown;
    Node a = -1, b = -1;  ///< operands; of a variable, a is its index
    double value = 0;     ///< of a constant
  };
  const Entry& entry(Node node) const { return nodes_[static_cast<std::size_t>(node)]; }
  static bool is_binary(Operation operation) { return operation <= Operation::Atan2; }

  /// A variable that a node's expression has.
  struct Mention {
    int variable = 0;
    bool linear = false;  ///< the node is c x_j + terms without x_j, with one number c
  };
  /// Of the root, by ascending variables. A variable that cancels is mentioned, too. `visited`: one 0 a node, which it
  /// is again afterwards. Pre: nothing below is unknown.
  std::vector<Mention> mentions(Node root, std::vector<char>& visited) const;

  /// The range of every node over the box X, one interval a variable; or a larger one. Empty: defined nowhere there.
  struct Ranges {
    std::vector<Interval> values;
    /// Is the node defined throughout? (What it depends on included, also in conditions and in both their branches.)
    std::vector<char> defined;
    /// And Lipschitz continuous near every point?
    std::vector<char> smooth;
  };
  Ranges ranges(std::span<const Interval> X) const;
  /// What ranges() costs, in additions, roughly.
  double work() const;

  /// Adds the range of the derivatives of `root` with respect to variable j to derivatives[j], for all j: where the
  /// node has none, as |x| at 0, of Clarke's. By the chain rule from the root down. Pre: the root is smooth.
  /// `visited`: one 0 a node, which it is again afterwards.
  void add_derivatives(Node root, const Ranges& ranges, std::span<Interval> derivatives,
                       std::vector<char>& visited) const;

 private:
  Node add(Entry entry);
  /// The root and all that it depends on, from the root down: a node after all that it is an operand of.
  std::vector<Node> below(Node root, std::vector<char>& visited) const;
  Interval value(const Entry& entry, std::span<const Interval> values, std::span<const Interval> X) const;
  /// Of the next node: whether it is defined and smooth.
  void add_domain(const Entry& entry, Ranges& ranges) const;

  std::vector<Entry> nodes_;  ///< operands before what they are operands of
};

}  // namespace perp::ncp
