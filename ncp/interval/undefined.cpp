// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/undefined.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "ncp/interval/operation_value.hpp"

namespace perp::ncp {
namespace {

using Node = ExpressionGraph::Node;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Does the operation grow beyond all doubles rather than have no value?
bool overflows(Operation operation, double value) {
  using enum Operation;
  return std::isinf(value) && (operation == Add || operation == Subtract || operation == Multiply || operation == Exp ||
                               operation == Sinh || operation == Cosh);
}

/// The derivative with respect to the one operand; only of operations that may have none where they have a value.
double slope_of(Operation operation, double a) {
  switch (operation) {
    case Operation::Sqrt:
      return 0.5 / std::sqrt(a);
    case Operation::Asin:
    case Operation::Acos:
      return 1 / std::sqrt((1 - a) * (1 + a));
    case Operation::Acosh:
      return 1 / std::sqrt((a - 1) * (a + 1));
    case Operation::Log:
    case Operation::Log10:
      return 1 / a;
    default:
      return 0;
  }
}

std::string short_number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
  return {text.data(), end};
}

const char* function_name(Operation operation) {
  static constexpr auto names = [] {
    using enum Operation;
    std::array<const char*, static_cast<std::size_t>(Unknown) + 1> t{};
    const auto set = [&t](Operation o, const char* name) { t[static_cast<std::size_t>(o)] = name; };
    set(Minimum, "min"), set(Maximum, "max"), set(Atan2, "atan2"), set(Absolute, "abs"), set(Floor, "floor");
    set(Ceil, "ceil"), set(Sqrt, "sqrt"), set(Exp, "exp"), set(Log, "log"), set(Log10, "log10"), set(Sin, "sin");
    set(Cos, "cos"), set(Tan, "tan"), set(Asin, "asin"), set(Acos, "acos"), set(Atan, "atan"), set(Sinh, "sinh");
    set(Cosh, "cosh"), set(Tanh, "tanh"), set(Asinh, "asinh"), set(Acosh, "acosh"), set(Atanh, "atanh");
    return t;
  }();
  return names[static_cast<std::size_t>(operation)];
}

class Writer {
 public:
  Writer(const ExpressionGraph& graph, const NameOf& name) : graph_(graph), name_(name) {}

  /// `depth`: so many operations inside of one another are written out; in brackets if it binds less than `binding`.
  std::string text(Node node, int depth, int binding = 0) const {
    const ExpressionGraph::Entry& entry = graph_.entry(node);
    switch (entry.operation) {
      case Operation::Constant:
        return bracketed(short_number(entry.value), entry.value < 0 && binding > sum);
      case Operation::Variable:
        return name_(entry.a);
      case Operation::Unknown:
      case Operation::Either:
        return "...";
      default:
        break;
    }
    if (depth == 0) return "...";
    switch (entry.operation) {
      case Operation::Add:
      case Operation::Subtract:
        return terms(node, depth - 1, binding);
      case Operation::Negate:
        return bracketed(std::string("-").append(text(entry.a, depth - 1, product)), binding > sum);
      case Operation::Multiply:
        if (is_constant(entry.a, 1)) return text(entry.b, depth, binding);
        if (is_constant(entry.a, -1))
          return bracketed(std::string("-").append(text(entry.b, depth - 1, product)), binding > sum);
        [[fallthrough]];
      case Operation::Divide: {
        const bool divides = entry.operation == Operation::Divide;
        const Entry& first = graph_.entry(entry.a);
        const bool negative = first.operation == Operation::Constant && first.value < 0;
        return bracketed(text(entry.a, depth - 1, negative ? sum : product) + (divides ? "/" : "*") +
                             text(entry.b, depth - 1, divides ? power : product),
                         binding > (negative ? sum : product));
      }
      case Operation::Power:
        return bracketed(text(entry.a, depth - 1, power + 1) + "^" + exponent(entry.b, depth - 1), binding > power);
      default: {
        std::string call = std::string(function_name(entry.operation)).append("(").append(text(entry.a, depth - 1));
        if (ExpressionGraph::is_binary(entry.operation)) call.append(", ").append(text(entry.b, depth - 1));
        return call.append(")");
      }
    }
  }

 private:
  using Entry = ExpressionGraph::Entry;
  static constexpr int sum = 1, product = 2, power = 3;  // how strongly they bind

  static std::string bracketed(const std::string& text, bool brackets) {
    return brackets ? std::string("(").append(text).append(")") : text;
  }
  std::string exponent(Node node, int depth) const {
    const ExpressionGraph::Entry& entry = graph_.entry(node);
    return entry.operation == Operation::Constant ? short_number(entry.value) : text(node, depth, power);
  }

  bool is_constant(Node node, double value) const {
    const Entry& entry = graph_.entry(node);
    return entry.operation == Operation::Constant && entry.value == value;
  }

  /// Long sums lean to the left, deeper than recursion may go. Writers of files add 0.
  std::string terms(Node node, int depth, int binding) const {
    constexpr std::size_t shown = 4;
    std::vector<std::pair<bool, Node>> terms;  // minus?
    for (;;) {
      const ExpressionGraph::Entry& entry = graph_.entry(node);
      if (entry.operation != Operation::Add && entry.operation != Operation::Subtract) break;
      terms.emplace_back(entry.operation == Operation::Subtract, entry.b);
      node = entry.a;
    }
    terms.emplace_back(false, node);
    std::ranges::reverse(terms);
    std::erase_if(terms, [&](const auto& term) { return is_constant(term.second, 0); });
    if (terms.empty()) return "0";
    if (terms.size() == 1 && !terms.front().first) return text(terms.front().second, depth, binding);
    std::string written;
    for (std::size_t k = 0; k < terms.size() && (k < shown || terms.size() == shown + 1); ++k) {
      auto [minus, term] = terms[k];
      const Entry& entry = graph_.entry(term);
      if (entry.operation == Operation::Negate) {
        minus = !minus;
        term = entry.a;
      } else if (entry.operation == Operation::Multiply && is_constant(entry.a, -1)) {
        minus = !minus;
        term = entry.b;
      }
      std::string next = text(term, depth, sum + (minus ? 1 : 0));
      if (k > 0 && !minus && next.starts_with('-')) {
        minus = true;
        next.erase(0, 1);
      }
      written += k == 0 ? (minus ? "-" : "") : (minus ? " - " : " + ");
      written += next;
    }
    if (terms.size() > shown + 1) written += " + ...";
    return bracketed(written, binding > sum);
  }

  const ExpressionGraph& graph_;
  const NameOf& name_;
};

}  // namespace

std::string text_of(const ExpressionGraph& graph, ExpressionGraph::Node node, const NameOf& name) {
  constexpr std::size_t longest = 60;
  constexpr int deepest = 8;
  const Writer writer(graph, name);
  std::string text;
  for (int depth = deepest; depth > 0; --depth) {
    text = writer.text(node, depth);
    if (text.size() <= longest) break;
  }
  return text;
}

PointValues::PointValues(const ExpressionGraph& graph, std::span<const double> x)
    : graph_(graph),
      x_(x.begin(), x.end()),
      values_(graph.size(), nan),
      states_(graph.size(), State::Known),
      varies_(graph.size(), 0),
      smooth_(graph.size(), 1),
      visited_(graph.size(), 0) {
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const auto& [operation, a, b, value] = graph.entry(static_cast<Node>(k));
    if (operation == Operation::Constant) {
      values_[k] = value;
    } else if (operation == Operation::Variable) {
      values_[k] = x[static_cast<std::size_t>(a)];
      varies_[k] = 1;
    } else if (operation == Operation::Unknown) {
      states_[k] = State::Unknown;
    } else {
      const Node second = ExpressionGraph::is_binary(operation) ? b : a;
      varies_[k] = varies_[static_cast<std::size_t>(a)] | varies_[static_cast<std::size_t>(second)];
      const auto is = [&](State s) { return state(a) == s || state(second) == s; };
      if (operation == Operation::Either || is(State::Unknown)) {
        states_[k] = State::Unknown;
      } else if (is(State::Undefined) || is(State::Follows)) {
        states_[k] = State::Follows;
      } else {
        values_[k] = value_of<double>(operation, (*this)[a], (*this)[second]).value_or(nan);
        if (!std::isfinite(values_[k])) states_[k] = State::Undefined;
      }
      const auto smooth = [&](Node operand) { return smooth_[static_cast<std::size_t>(operand)] != 0; };
      smooth_[k] = smooth(a) && smooth(second) && states_[k] != State::Undefined &&
                   (states_[k] != State::Known || differentiable(static_cast<Node>(k)));
    }
  }
}

bool PointValues::differentiable(Node node) const {
  const auto& [operation, a, b, value] = graph_.entry(node);
  if (operation >= Operation::Constant || !varies_[static_cast<std::size_t>(node)]) return true;
  const double u = (*this)[a];
  if (!ExpressionGraph::is_binary(operation)) return std::isfinite(slope_of(operation, u));
  const double v = (*this)[b];
  if (operation == Operation::Divide) return std::isfinite(1 / v) && std::isfinite((*this)[node] / v);
  if (operation == Operation::Atan2) return u != 0 || v != 0;
  if (operation != Operation::Power) return true;
  // AMPL's library has no derivative of x^1 at 0 either: it divides by x.
  const bool of_base =
      !varies_[static_cast<std::size_t>(a)] || (u == 0 ? v > 1 : std::isfinite(v * std::pow(u, v - 1)));
  return of_base && (!varies_[static_cast<std::size_t>(b)] || u > 0);
}

std::vector<ExpressionGraph::Node> PointValues::below(Node root, bool conditions) const {
  std::vector<Node> open{root}, found;
  while (!open.empty()) {
    const Node node = open.back();
    open.pop_back();
    if (std::exchange(visited_[static_cast<std::size_t>(node)], 1) != 0) continue;
    found.push_back(node);
    const auto& [operation, a, b, value] = graph_.entry(node);
    if (operation >= Operation::Constant || (operation == Operation::Either && !conditions)) continue;
    open.push_back(a);
    if (ExpressionGraph::is_binary(operation)) open.push_back(b);
  }
  for (const Node node : found) visited_[static_cast<std::size_t>(node)] = 0;
  std::ranges::sort(found);
  return found;
}

std::vector<UndefinedOperation> PointValues::undefined(Node root, bool derivatives, const NameOf& name) const {
  std::vector<UndefinedOperation> found;
  if (smooth_[static_cast<std::size_t>(root)] != 0) return found;
  for (const bool conditions : {false, true}) {
    for (const Node node : below(root, conditions)) {
      const bool without_value = state(node) == State::Undefined;
      if (!without_value && !(derivatives && state(node) == State::Known && !differentiable(node))) continue;
      found.push_back(told(node, x_, name));
      if (!without_value) found.back().operation.insert(0, "the derivative of ");
    }
    if (!found.empty()) break;
  }
  return found;
}

UndefinedOperation PointValues::told(Node node, std::span<const double> x, const NameOf& name) const {
  const auto& [operation, a, b, value] = graph_.entry(node);
  UndefinedOperation out{
      .operation = text_of(graph_, node, name), .argument = {}, .overflow = overflows(operation, (*this)[node])};
  const bool binary = ExpressionGraph::is_binary(operation);
  bool composite = false;
  for (const Node operand : {a, b}) {
    if (operand == b && (!binary || b == a)) break;
    if (binary && operand == a && operation == Operation::Divide) continue;  // the divisor is the cause
    const Operation kind = graph_.entry(operand).operation;
    if (kind == Operation::Constant) continue;
    out.argument +=
        (out.argument.empty() ? "" : ", ") + text_of(graph_, operand, name) + " = " + short_number((*this)[operand]);
    composite |= kind != Operation::Variable;
    for (const Node below_it : below(operand, true))
      if (graph_.entry(below_it).operation == Operation::Variable)
        out.variables.push_back({.index = graph_.entry(below_it).a});
  }
  if (out.argument.empty()) out.argument = text_of(graph_, node, name) + " = " + short_number((*this)[node]);
  std::ranges::sort(out.variables, {}, &BoundedVariable::index);
  out.variables.erase(std::ranges::unique(out.variables, {}, &BoundedVariable::index).begin(), out.variables.end());
  if (!composite) return out;
  constexpr std::size_t shown = 4;
  const std::size_t n = out.variables.size();
  for (std::size_t k = 0; k < std::min(n, shown); ++k) {
    const int j = out.variables[k].index;
    out.where += k == 0 ? ", where " : k + 1 == n ? " and " : ", ";
    out.where += name(j) + " = " + short_number(x[static_cast<std::size_t>(j)]);
  }
  if (n > shown) out.where += ", ...";
  return out;
}

}  // namespace perp::ncp
