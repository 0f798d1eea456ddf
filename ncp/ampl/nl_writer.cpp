// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/nl_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ncp/interval/expression.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::ncp::ampl {
namespace {

using Node = ExpressionGraph::Node;
using Text = std::back_insert_iterator<std::string>;

int opcode(Operation operation) {
  switch (operation) {
    case Operation::Add:
      return 0;
    case Operation::Subtract:
      return 1;
    case Operation::Multiply:
      return 2;
    case Operation::Divide:
      return 3;
    case Operation::Power:
      return 5;
    case Operation::Minimum:
      return 11;
    case Operation::Maximum:
      return 12;
    case Operation::Floor:
      return 13;
    case Operation::Ceil:
      return 14;
    case Operation::Absolute:
      return 15;
    case Operation::Negate:
      return 16;
    case Operation::Tanh:
      return 37;
    case Operation::Tan:
      return 38;
    case Operation::Sqrt:
      return 39;
    case Operation::Sinh:
      return 40;
    case Operation::Sin:
      return 41;
    case Operation::Log10:
      return 42;
    case Operation::Log:
      return 43;
    case Operation::Exp:
      return 44;
    case Operation::Cosh:
      return 45;
    case Operation::Cos:
      return 46;
    case Operation::Atanh:
      return 47;
    case Operation::Atan2:
      return 48;
    case Operation::Atan:
      return 49;
    case Operation::Asinh:
      return 50;
    case Operation::Asin:
      return 51;
    case Operation::Acosh:
      return 52;
    case Operation::Acos:
      return 53;
    default:
      throw std::invalid_argument("an operation that has no place in an .nl file");
  }
}

/// A node after simplification: a number, or a node with what it does.
struct Plain {
  bool is_number = false;
  bool linear = true;  ///< in the variables
  double number = 0;
  Operation operation = Operation::Constant;
  Node a = -1, b = -1;
};

/// The graph without operations on numbers and by 0 and 1, and without a second node for one variable.
class PlainGraph {
 public:
  explicit PlainGraph(const ExpressionGraph& graph) : nodes_(graph.size()), same_(graph.size()) {
    for (Node k = 0; k < static_cast<Node>(graph.size()); ++k) {
      same_[at(k)] = k;
      simplify(k, graph.entry(k));
    }
  }
  /// The node that stands for it.
  Node of(Node k) const { return same_[at(k)]; }
  const Plain& operator[](Node k) const { return nodes_[at(of(k))]; }

 private:
  void becomes(Node k, Node other) { same_[at(k)] = of(other); }
  void number(Node k, double value) { nodes_[at(k)] = {.is_number = true, .number = value}; }
  void simplify(Node k, const ExpressionGraph::Entry& entry);

  std::vector<Plain> nodes_;
  std::vector<Node> same_;
  std::map<int, Node> variables_;
};

void PlainGraph::simplify(Node k, const ExpressionGraph::Entry& entry) {
  if (entry.operation == Operation::Constant) return number(k, entry.value);
  if (entry.operation == Operation::Variable) {
    if (const auto [first, is_new] = variables_.try_emplace(entry.a, k); !is_new) return becomes(k, first->second);
    nodes_[at(k)] = {.operation = entry.operation, .a = entry.a};
    return;
  }
  const Node a = of(entry.a), b = ExpressionGraph::is_binary(entry.operation) ? of(entry.b) : -1;
  const Plain& first = nodes_[at(a)];
  Plain made{.linear = false, .operation = entry.operation, .a = a, .b = b};
  if (b < 0) {
    if (entry.operation == Operation::Negate) {
      if (first.is_number) return number(k, -first.number);
      made.linear = first.linear;
    }
    nodes_[at(k)] = made;
    return;
  }
  const Plain& second = nodes_[at(b)];
  const bool p = first.is_number, q = second.is_number;
  const auto is = [](const Plain& node, double value) { return node.is_number && node.number == value; };
  switch (entry.operation) {
    case Operation::Add:
      if (p && q) return number(k, first.number + second.number);
      if (is(first, 0)) return becomes(k, b);
      if (is(second, 0)) return becomes(k, a);
      made.linear = first.linear && second.linear;
      break;
    case Operation::Subtract:
      if (p && q) return number(k, first.number - second.number);
      if (is(second, 0)) return becomes(k, a);
      made.linear = first.linear && second.linear;
      if (is(first, 0)) made = {.linear = second.linear, .operation = Operation::Negate, .a = b};
      break;
    case Operation::Multiply:
      if (p && q) return number(k, first.number * second.number);
      if (is(first, 0) || is(second, 0)) return number(k, 0);
      if (is(first, 1)) return becomes(k, b);
      if (is(second, 1)) return becomes(k, a);
      made.linear = (p && second.linear) || (q && first.linear);
      break;
    case Operation::Divide:
      if (p && q && second.number != 0) return number(k, first.number / second.number);
      if (is(first, 0)) return number(k, 0);
      if (is(second, 1)) return becomes(k, a);
      made.linear = q && first.linear;
      break;
    default:
      break;
  }
  nodes_[at(k)] = made;
}

struct Term {
  double sign;
  Node node;
};

/// A row: constant + coefficients' x + terms.
struct NlRow {
  double constant = 0;
  std::map<int, double> coefficients{};
  std::vector<Term> terms{};
};

class Writer {
 public:
  Writer(const Mcp& mcp, In x0) : mcp_(mcp), x0_(x0), n_(static_cast<int>(mcp.size())), rows_(at(mcp.size())) {}

  void affine(const lcp::AffineMcp& problem) {
    for (Index j = 0; j < problem.M.cols(); ++j)
      for (SpMat::InnerIterator it(problem.M, j); it; ++it)
        rows_[at(it.row())].coefficients[static_cast<int>(j)] = it.value();
    for (Index i = 0; i < problem.size(); ++i) rows_[at(i)].constant = problem.q[i];
  }
  void expressions(const Expressions& f);
  std::string text();

 private:
  bool free(Index i) const { return mcp_.box().is_free(i); }
  void split(NlRow& row, Node root);
  void define_what_is_shared();
  void header();
  void bodies();
  void bounds();
  void columns();
  void expression(Node root);
  void operation(Node node);
  void sum(const std::vector<Term>& terms, double constant);
  void number(double value) {
    if (!std::isfinite(value)) throw std::invalid_argument(mcp_.name() + ": F has a number that is not finite");
    fmt::format_to(out(), "n{}\n", value);
  }
  Text out() { return Text(text_); }

  const Mcp& mcp_;
  In x0_;
  int n_;
  std::vector<NlRow> rows_;
  std::optional<PlainGraph> graph_{};
  std::vector<Node> defined_{};       // shared nodes, ascending
  std::map<Node, int> definition_{};  // their numbers, after the variables'
  std::string text_{};
};

void Writer::expressions(const Expressions& f) {
  graph_.emplace(f.graph);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    split(rows_[i], f.rows[i]);
  }
  define_what_is_shared();
}

/// Sums and differences are taken apart; linear parts become coefficients.
void Writer::split(NlRow& row, Node root) {
  std::vector<Term> open{{1, graph_->of(root)}};
  while (!open.empty()) {
    const auto [factor, node] = open.back();
    open.pop_back();
    const Plain& plain = (*graph_)[node];
    if (plain.is_number) {
      row.constant += factor * plain.number;
      continue;
    }
    switch (plain.operation) {
      case Operation::Variable:
        row.coefficients[plain.a] += factor;
        continue;
      case Operation::Add:
      case Operation::Subtract:
        if (!plain.linear && std::abs(factor) != 1) break;
        open.push_back({plain.operation == Operation::Add ? factor : -factor, plain.b});
        open.push_back({factor, plain.a});
        continue;
      case Operation::Negate:
        open.push_back({-factor, plain.a});
        continue;
      case Operation::Multiply:
        if (!plain.linear) break;
        if (const Plain& first = (*graph_)[plain.a]; first.is_number)
          open.push_back({factor * first.number, plain.b});
        else
          open.push_back({factor * (*graph_)[plain.b].number, plain.a});
        continue;
      case Operation::Divide:
        if (!plain.linear) break;
        open.push_back({factor / (*graph_)[plain.b].number, plain.a});
        continue;
      default:
        break;
    }
    row.terms.push_back({factor, node});
  }
}

/// Nodes with several parents, but for variables and numbers.
void Writer::define_what_is_shared() {
  std::map<Node, int> parents;
  std::vector<Node> open;
  const auto visit = [&](Node node) {
    if (!(*graph_)[node].is_number && (*graph_)[node].operation != Operation::Variable && parents[node]++ == 0)
      open.push_back(node);
  };
  for (const NlRow& row : rows_)
    for (const Term& term : row.terms) visit(term.node);
  while (!open.empty()) {
    const Plain& plain = (*graph_)[open.back()];
    open.pop_back();
    for (const Node operand : {plain.a, plain.b})
      if (operand >= 0) visit(graph_->of(operand));
  }
  for (const auto& [node, count] : parents)
    if (count > 1) {
      definition_[node] = n_ + static_cast<int>(defined_.size());
      defined_.push_back(node);
    }
  // Every variable of a row has an entry in its J segment.
  std::vector<int> seen(at(n_), -1);
  std::map<Node, int> reached;
  for (int i = 0; i < n_; ++i) {
    NlRow& row = rows_[at(i)];
    for (const Term& term : row.terms) open.push_back(term.node);
    while (!open.empty()) {
      const Node node = open.back();
      open.pop_back();
      const Plain& plain = (*graph_)[node];
      if (plain.is_number) continue;
      if (plain.operation == Operation::Variable) {
        row.coefficients.try_emplace(plain.a, 0.0);
        continue;
      }
      if (const auto [place, is_new] = reached.try_emplace(node, i); !is_new && std::exchange(place->second, i) == i)
        continue;
      for (const Node operand : {plain.a, plain.b})
        if (operand >= 0) open.push_back(graph_->of(operand));
    }
  }
}

void Writer::header() {
  int equations = 0;
  std::size_t nonzeros = 0, nonlinear = graph_ ? at(n_) : 0;
  for (Index i = 0; i < n_; ++i) equations += free(i) ? 1 : 0;
  for (const NlRow& row : rows_) nonzeros += row.coefficients.size();
  const int conditions = n_ - equations;
  fmt::format_to(out(), "g3 1 1 0\n {0} {0} 0 0 {1}\n {2} 0 {3} {4} 0 0\n 0 0\n {2} 0 0\n 0 0 0 1\n 0 0 0 0 0\n", n_,
                 equations, nonlinear, graph_ ? 0 : conditions, graph_ ? conditions : 0);
  fmt::format_to(out(), " {} 0\n 0 0\n 0 {} 0 0 0\n", nonzeros, defined_.size());
}

void Writer::operation(Node node) {
  const Plain& plain = (*graph_)[node];
  if (plain.operation == Operation::Add || plain.operation == Operation::Subtract) {
    // The terms of a long sum, as one: nested, they would be as deep as there are terms.
    std::vector<Term> terms, open{{1, node}};
    while (!open.empty()) {
      const auto [sign, part] = open.back();
      open.pop_back();
      const Plain& inner = (*graph_)[part];
      const bool whole = part != node && (inner.is_number || definition_.contains(part));
      if (!whole && (inner.operation == Operation::Add || inner.operation == Operation::Subtract)) {
        open.push_back({inner.operation == Operation::Add ? sign : -sign, graph_->of(inner.b)});
        open.push_back({sign, graph_->of(inner.a)});
      } else {
        terms.push_back({sign, part});
      }
    }
    return sum(terms, 0);
  }
  fmt::format_to(out(), "o{}\n", opcode(plain.operation));
  if (plain.operation == Operation::Minimum || plain.operation == Operation::Maximum) text_ += "2\n";
  expression(plain.a);
  if (plain.b >= 0) expression(plain.b);
}

void Writer::expression(Node root) {
  const Node node = graph_->of(root);
  const Plain& plain = (*graph_)[node];
  if (plain.is_number) return number(plain.number);
  if (plain.operation == Operation::Variable) {
    fmt::format_to(out(), "v{}\n", plain.a);
  } else if (const auto defined = definition_.find(node); defined != definition_.end()) {
    fmt::format_to(out(), "v{}\n", defined->second);
  } else {
    operation(node);
  }
}

void Writer::sum(const std::vector<Term>& terms, double constant) {
  const std::size_t count = terms.size() + (constant != 0 ? 1 : 0);
  if (count == 0) return number(0);
  if (count == 2) text_ += "o0\n";
  if (count > 2) fmt::format_to(out(), "o54\n{}\n", count);
  for (const auto& [sign, node] : terms) {
    if (sign == -1) text_ += "o16\n";
    if (std::abs(sign) != 1) {
      text_ += "o2\n";
      number(sign);
    }
    expression(node);
  }
  if (constant != 0) number(constant);
}

void Writer::bodies() {
  for (const Node node : defined_) {
    fmt::format_to(out(), "V{} 0 0\n", definition_.at(node));
    operation(node);
  }
  for (int i = 0; i < n_; ++i) {
    const NlRow& row = rows_[at(i)];
    fmt::format_to(out(), "C{}\n", i);
    sum(row.terms, free(i) ? 0 : row.constant);
  }
}

/// "0 l u", "1 u", "2 l", "3" or "4 v", of variables; of rows "5 k i", or the right-hand side of an equation.
void Writer::bounds() {
  const Box& box = mcp_.box();
  text_ += "r\n";
  for (int i = 0; i < n_; ++i) {
    const int finite = (std::isfinite(box.lower[i]) ? 1 : 0) + (std::isfinite(box.upper[i]) ? 2 : 0);
    if (free(i))
      fmt::format_to(out(), "4 {}\n", 0 - rows_[at(i)].constant);
    else
      fmt::format_to(out(), "5 {} {}\n", finite, i + 1);
  }
  text_ += "b\n";
  for (int i = 0; i < n_; ++i) {
    const double lower = box.lower[i], upper = box.upper[i];
    if (lower == upper)
      fmt::format_to(out(), "4 {}\n", lower);
    else if (std::isfinite(lower) && std::isfinite(upper))
      fmt::format_to(out(), "0 {} {}\n", lower, upper);
    else if (std::isfinite(upper))
      fmt::format_to(out(), "1 {}\n", upper);
    else if (std::isfinite(lower))
      fmt::format_to(out(), "2 {}\n", lower);
    else
      text_ += "3\n";
  }
}

void Writer::columns() {
  std::vector<int> counts(at(n_), 0);
  for (const NlRow& row : rows_)
    for (const auto& [j, coefficient] : row.coefficients) ++counts[at(j)];
  fmt::format_to(out(), "k{}\n", n_ - 1);
  int before = 0;
  for (int j = 0; j + 1 < n_; ++j) fmt::format_to(out(), "{}\n", before += counts[at(j)]);
  for (int i = 0; i < n_; ++i) {
    const auto& coefficients = rows_[at(i)].coefficients;
    if (coefficients.empty()) continue;
    fmt::format_to(out(), "J{} {}\n", i, coefficients.size());
    for (const auto& [j, coefficient] : coefficients) fmt::format_to(out(), "{} {}\n", j, coefficient);
  }
}

std::string Writer::text() {
  header();
  bodies();
  fmt::format_to(out(), "x{}\n", n_);
  for (int i = 0; i < n_; ++i) fmt::format_to(out(), "{} {}\n", i, x0_[i]);
  bounds();
  columns();
  return std::move(text_);
}

}  // namespace

std::optional<std::string> nl_text(const Mcp& mcp, In x0) {
  Writer writer(mcp, x0);
  if (const auto problem = affine_part(mcp)) {
    writer.affine(*problem);
  } else {
    const std::optional<Expressions> f = mcp.expressions();
    if (!f) return std::nullopt;
    writer.expressions(*f);
  }
  return writer.text();
}

}  // namespace perp::ncp::ampl
