// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/nl_expression.hpp"

#include <array>
#include <climits>
#include <limits>

namespace perp::ncp::ampl {
namespace {

enum class Shape : unsigned char {
  None,             // no such operator
  Unary,            // numeric
  Binary,           // numeric
  IntegerQuotient,  // div: numeric, without derivative
  Precision,        // (numeric, significant digits), without derivative
  Rounding,         // round, trunc: (numeric, digits after the point), without derivative
  MinMax,           // n >= 1 numeric
  Sum,              // n >= 3 numeric
  Count,            // n logical -> numeric
  NumberOf,         // n numeric -> numeric
  PiecewiseLinear,  // slopes and breakpoints of a variable
  If,               // logical, numeric, numeric -> numeric
  Symbolic,         // has strings for values
  Not,              // logical
  Connective,       // two logical
  Comparison,       // two numeric -> logical
  CountComparison,  // (numeric, Count) -> logical
  Iterated,         // n >= 3 logical
  Implication,      // three logical
  AllDifferent,     // n numeric -> logical
};

// 76 to 78 and 82 are the library's own variants of others, 79 to 81 leaves; they have no place in a file.
Shape shape_of(int op) {
  static constexpr auto table = [] {
    using enum Shape;
    std::array<Shape, 76> t{};
    for (int i : {0, 1, 2, 3, 4, 5, 6, 48}) t[static_cast<std::size_t>(i)] = Binary;
    for (int i : {13, 14, 15, 16, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 49, 50, 51, 52, 53})
      t[static_cast<std::size_t>(i)] = Unary;
    for (int i : {11, 12}) t[static_cast<std::size_t>(i)] = MinMax;
    for (int i : {20, 21, 73}) t[static_cast<std::size_t>(i)] = Connective;
    for (int i : {22, 23, 24, 28, 29, 30}) t[static_cast<std::size_t>(i)] = Comparison;
    for (int i : {57, 58}) t[static_cast<std::size_t>(i)] = Rounding;
    for (int i : {62, 63, 66, 67, 68, 69}) t[static_cast<std::size_t>(i)] = CountComparison;
    for (int i : {61, 65}) t[static_cast<std::size_t>(i)] = Symbolic;
    for (int i : {70, 71}) t[static_cast<std::size_t>(i)] = Iterated;
    for (int i : {74, 75}) t[static_cast<std::size_t>(i)] = AllDifferent;
    t[34] = Not;
    t[35] = If;
    t[54] = Sum;
    t[55] = IntegerQuotient;
    t[56] = Precision;
    t[59] = Count;
    t[60] = NumberOf;
    t[64] = PiecewiseLinear;
    t[72] = Implication;
    return t;
  }();
  return op < static_cast<int>(table.size()) ? table[static_cast<std::size_t>(op)] : Shape::None;
}

bool is_logical(Shape shape) { return shape >= Shape::Not; }

enum class Want : unsigned char { Numeric, Logical, Count, Precision, Digits };

// The library formats the number into buffers of fixed size, and goes astray where digits are negative.
constexpr int max_precision = 17;
constexpr int max_digits = 60;

struct Open {  // an operator whose operands are being read
  int op;
  Shape shape;
  int operand;          // the next one
  int left;             // still to come
  bool derivative;      // does its own count?
  bool varies = false;  // has an operand one that counts?
};

/// The operator with that opcode in the graph.
ExpressionGraph::Node value_of(ExpressionGraph& graph, int op, const std::vector<ExpressionGraph::Node>& nodes) {
  using enum Operation;
  static constexpr auto unary = [] {
    std::array<Operation, 54> t{};
    t.fill(Unknown);
    t[13] = Floor, t[14] = Ceil, t[15] = Absolute, t[16] = Negate, t[37] = Tanh, t[38] = Tan, t[39] = Sqrt;
    t[40] = Sinh, t[41] = Sin, t[42] = Log10, t[43] = Log, t[44] = Exp, t[45] = Cosh, t[46] = Cos, t[47] = Atanh;
    t[49] = Atan, t[50] = Asinh, t[51] = Asin, t[52] = Acosh, t[53] = Acos;
    return t;
  }();
  switch (op) {
    case 0:
      return graph.binary(Add, nodes[0], nodes[1]);
    case 1:
      return graph.binary(Subtract, nodes[0], nodes[1]);
    case 2:
      return graph.binary(Multiply, nodes[0], nodes[1]);
    case 3:
      return graph.binary(Divide, nodes[0], nodes[1]);
    case 5:
      return graph.binary(Power, nodes[0], nodes[1]);
    case 6:  // less: max(a - b, 0)
      return graph.binary(Maximum, graph.binary(Subtract, nodes[0], nodes[1]), graph.constant(0));
    case 11:
    case 12: {
      ExpressionGraph::Node extreme = nodes[0];
      for (std::size_t k = 1; k < nodes.size(); ++k)
        extreme = graph.binary(op == 11 ? Minimum : Maximum, extreme, nodes[k]);
      return extreme;
    }
    case 20:  // or, and, comparisons, "if and only if": of them it matters whether they have a value
    case 21:
    case 22:
    case 23:
    case 24:
    case 28:
    case 29:
    case 30:
    case 73:
      return graph.binary(Either, nodes[0], nodes[1]);
    case 34:  // not
      return nodes[0];
    case 35:
      return graph.binary(Guarded, graph.binary(Either, nodes[1], nodes[2]), nodes[0]);
    case 48:
      return graph.binary(Atan2, nodes[0], nodes[1]);
    case 54:
      return graph.sum(nodes);
    default:
      return nodes.size() == 1 && op < static_cast<int>(unary.size()) && unary[static_cast<std::size_t>(op)] != Unknown
                 ? graph.unary(unary[static_cast<std::size_t>(op)], nodes[0])
                 : graph.unknown();
  }
}

class Walk {
 public:
  Walk(NlTokens& tokens, const NlHeader& header, const DefinedVariables& defined, Reader reader, int self,
       std::vector<Mention>& mentions, NlGraph& graph)
      : tokens_(tokens),
        header_(header),
        defined_(defined),
        reader_(reader),
        self_(self),
        mentions_(mentions),
        graph_(graph) {}

  ExpressionKind run() {
    ExpressionKind kind;
    do {
      node();
      ++kind.nodes;
      for (; !open_.empty() && open_.back().left == 0; open_.pop_back()) {
        found(open_.back());
        join(open_.back());
      }
    } while (!open_.empty());
    kind.root = operands_.back();
    kind.derivative = derivative_;
    kind.branches = branches_;
    return kind;
  }

 private:
  void node();
  void operation(Want want, bool derivative);
  void piecewise_linear(bool derivative);
  void variable(bool derivative);
  static Want wanted(const Open& parent);
  static bool differentiates(const Open& parent);
  /// The value of a node, once it is complete, has or has no derivative.
  void found(const Open& operation);
  void leaf(bool derivative);
  int operands(Shape shape);
  /// Its operands in the graph become its value.
  void join(const Open& operation);

  NlTokens& tokens_;
  const NlHeader& header_;
  const DefinedVariables& defined_;
  Reader reader_;
  int self_;
  std::vector<Mention>& mentions_;
  NlGraph& graph_;
  std::vector<ExpressionGraph::Node> operands_;  // in the graph, of the operators that are open
  std::vector<Open> open_;
  bool derivative_ = false;  // of the outermost node
  bool branches_ = false;
};

Want Walk::wanted(const Open& parent) {
  switch (parent.shape) {
    case Shape::Precision:
      return parent.operand == 0 ? Want::Numeric : Want::Precision;
    case Shape::Rounding:
      return parent.operand == 0 ? Want::Numeric : Want::Digits;
    case Shape::If:
      return parent.operand == 0 ? Want::Logical : Want::Numeric;
    case Shape::CountComparison:
      return parent.operand == 0 ? Want::Numeric : Want::Count;
    case Shape::Count:
    case Shape::Not:
    case Shape::Connective:
    case Shape::Iterated:
    case Shape::Implication:
      return Want::Logical;
    default:
      return Want::Numeric;
  }
}

bool Walk::differentiates(const Open& parent) {
  switch (parent.shape) {
    case Shape::Unary:
    case Shape::Binary:
    case Shape::MinMax:
    case Shape::Sum:
      return parent.derivative;
    case Shape::If:
      return parent.derivative && parent.operand > 0;
    default:
      return false;
  }
}

void Walk::leaf(bool derivative) {
  if (open_.empty())
    derivative_ = derivative;
  else
    open_.back().varies |= derivative;
}

void Walk::found(const Open& operation) {
  const bool varies = operation.varies;
  if (open_.size() == 1)
    derivative_ = varies;
  else
    open_[open_.size() - 2].varies |= varies;
}

void Walk::node() {
  Want want = Want::Numeric;
  bool derivative = true;
  if (!open_.empty()) {
    Open& parent = open_.back();
    want = wanted(parent);
    derivative = differentiates(parent);
    ++parent.operand;
    --parent.left;
  }
  const char kind = tokens_.kind();
  switch (kind) {
    case 'n':
    case 'l':
    case 's': {
      const double value = tokens_.literal(kind, "a number");
      if (want == Want::Count) tokens_.fail("expected a count (o59), found a number");
      const int digits = want == Want::Precision ? max_precision : max_digits;
      if ((want == Want::Precision || want == Want::Digits) && !(value >= 0 && value <= digits))
        tokens_.fail("number of digits is " + number(value) + ", not in 0.." + std::to_string(digits));
      operands_.push_back(graph_.graph.constant(value));
      return;
    }
    case 'v':
      if (want != Want::Numeric) tokens_.fail("unexpected variable: a number or an operator belongs here");
      return variable(derivative);
    case 'o':
      return operation(want, derivative);
    case 'f':
      tokens_.fail("calls imported function f" + std::to_string(tokens_.integer("function", 0, INT_MAX)) +
                   ", which no F segment declares");
    case 'h':
      tokens_.fail("a string: symbolic expressions are not supported");
    default:
      tokens_.fail(std::string("expected an expression (n, v or o), found \"") +
                   (kind > ' ' && kind <= '~' ? kind : '?') + "\"");
  }
}

int Walk::operands(Shape shape) {
  const auto counted = [&](int at_least) {
    tokens_.item();
    const int n = tokens_.integer("number of operands", at_least, INT_MAX);
    tokens_.close();
    return n;
  };
  switch (shape) {
    case Shape::Unary:
    case Shape::Not:
      return 1;
    case Shape::If:
    case Shape::Implication:
      return 3;
    case Shape::MinMax:
    case Shape::AllDifferent:
      return counted(1);
    case Shape::Count:  // the library reads past the end of a list of one
    case Shape::NumberOf:
      return counted(2);
    case Shape::Sum:
    case Shape::Iterated:
      return counted(3);
    default:
      return 2;
  }
}

void Walk::operation(Want want, bool derivative) {
  const int op = tokens_.integer("opcode", 0, INT_MAX);
  tokens_.close();
  const auto refuse = [&](const std::string& why) { tokens_.fail("operator o" + std::to_string(op) + why); };
  const Shape shape = shape_of(op);
  if (shape == Shape::None) refuse(": there is no such operator");
  if (shape == Shape::Symbolic) refuse(": symbolic expressions are not supported");
  if (want == Want::Precision || want == Want::Digits) refuse(": the number of digits has to be a constant");
  if (want == Want::Count && shape != Shape::Count) refuse(": expected a count (o59)");
  if (want == Want::Logical && !is_logical(shape)) refuse(" has a number for its value, expected a condition");
  if (want == Want::Numeric && is_logical(shape)) refuse(" is a condition, expected a number");
  if (shape == Shape::PiecewiseLinear) return piecewise_linear(derivative);
  if (open_.size() >= static_cast<std::size_t>(max_depth))
    tokens_.fail("the expression is nested deeper than " + std::to_string(max_depth) +
                 " levels (write long sums as o54)");
  branches_ |= shape == Shape::If || shape == Shape::MinMax;
  open_.push_back({op, shape, 0, operands(shape), derivative});
}

void Walk::piecewise_linear(bool derivative) {
  tokens_.item();
  const int slopes = tokens_.integer("number of slopes", 2, INT_MAX);
  tokens_.close();
  double last = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < slopes; ++i) {
    tokens_.literal("slope");
    if (i + 1 == slopes) break;
    const double breakpoint = tokens_.literal("breakpoint");
    if (!(breakpoint > last))
      tokens_.fail("breakpoint " + number(breakpoint) + " of a piecewise-linear term does not exceed the one before, " +
                   number(last));
    if (breakpoint < 0)
      tokens_.fail(
          "breakpoint " + number(breakpoint) +
          " of a piecewise-linear term is negative: AMPL's library evaluates such a term wrongly between it and 0");
    last = breakpoint;
  }
  if (tokens_.kind() != 'v') tokens_.fail("the argument of a piecewise-linear term (o64) has to be a variable");
  variable(derivative);
  operands_.back() = graph_.graph.unknown();
}

void Walk::variable(bool derivative) {
  const int index = tokens_.integer("variable", 0, header_.n_var + header_.defined() - 1);
  tokens_.close();
  if (index >= header_.n_var) {
    if (const char* why = defined_.objection(index - header_.n_var, reader_, self_))
      tokens_.fail("defined variable v" + std::to_string(index) + why);
  }
  mentions_.push_back({index, derivative});
  operands_.push_back(index < header_.n_var ? graph_.graph.variable(index)
                                            : graph_.definitions[static_cast<std::size_t>(index - header_.n_var)]);
  leaf(derivative && (index < header_.n_var || defined_.has_derivative(index - header_.n_var)));
}

void Walk::join(const Open& operation) {
  const auto n = static_cast<std::size_t>(operation.operand);
  const std::vector<ExpressionGraph::Node> nodes(operands_.end() - operation.operand, operands_.end());
  operands_.resize(operands_.size() - n);
  operands_.push_back(value_of(graph_.graph, operation.op, nodes));
}

}  // namespace

Reader DefinedVariables::group(int number) const {
  if (number < header_.defined_both) return Reader::Both;
  if (number < header_.defined_both + header_.defined_con) return Reader::Constraint;
  if (number < header_.defined_shared()) return Reader::Objective;
  return number < header_.defined_shared() + header_.defined_con1 ? Reader::Constraint : Reader::Objective;
}

const char* DefinedVariables::objection(int number, Reader reader, int self) const {
  if (self >= 0 && number >= self) return " is used in the definition of one that does not come after it";
  const int seen = seen_[static_cast<std::size_t>(number)];
  if (seen == 0) return " is used before its V segment";
  if (group(number) != Reader::Both && group(number) != reader)
    return group(number) == Reader::Objective ? " is for objectives only" : " is for constraints only";
  if (seen != shared && seen != row_) return " is for another constraint or objective only";
  return nullptr;
}

ExpressionKind check_expression(NlTokens& tokens, const NlHeader& header, const DefinedVariables& defined,
                                Reader reader, int self, std::vector<Mention>& mentions, NlGraph& graph) {
  return Walk(tokens, header, defined, reader, self, mentions, graph).run();
}

}  // namespace perp::ncp::ampl
