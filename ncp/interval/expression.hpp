// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A scalar whose arithmetic is written down as an expression graph: a function templated on its scalar type, run once
/// on these, tells which variables each result depends on, where it is linear, and its ranges over boxes.
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "ncp/interval/expression_graph.hpp"

namespace perp::ncp {

class Expression {
 public:
  /// Thrown by comparisons of what is no number: which way a branch goes is not known before there are values.
  struct Compared {};

  Expression() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): numbers are expressions
  Expression(double number) : number_(number) {}
  /// Variable j in a graph, which outlives all expressions of it.
  static Expression variable(ExpressionGraph& graph, int j);
  /// Its node in the graph; a new one if it is a number.
  ExpressionGraph::Node node(ExpressionGraph& graph) const;

  Expression& operator+=(const Expression& b) { return *this = *this + b; }
  Expression& operator-=(const Expression& b) { return *this = *this - b; }
  Expression& operator*=(const Expression& b) { return *this = *this * b; }
  Expression& operator/=(const Expression& b) { return *this = *this / b; }
  friend Expression operator+(const Expression& a) { return a; }
  friend Expression operator-(const Expression& a) { return unary(Operation::Negate, a); }
  friend Expression operator+(const Expression& a, const Expression& b) { return binary(Operation::Add, a, b); }
  friend Expression operator-(const Expression& a, const Expression& b) { return binary(Operation::Subtract, a, b); }
  friend Expression operator*(const Expression& a, const Expression& b) { return binary(Operation::Multiply, a, b); }
  friend Expression operator/(const Expression& a, const Expression& b) { return binary(Operation::Divide, a, b); }

  friend Expression pow(const Expression& a, const Expression& b) { return binary(Operation::Power, a, b); }
  friend Expression min(const Expression& a, const Expression& b) { return binary(Operation::Minimum, a, b); }
  friend Expression max(const Expression& a, const Expression& b) { return binary(Operation::Maximum, a, b); }
  friend Expression atan2(const Expression& a, const Expression& b) { return binary(Operation::Atan2, a, b); }
  friend Expression abs(const Expression& a) { return unary(Operation::Absolute, a); }
  friend Expression fabs(const Expression& a) { return unary(Operation::Absolute, a); }
  friend Expression floor(const Expression& a) { return unary(Operation::Floor, a); }
  friend Expression ceil(const Expression& a) { return unary(Operation::Ceil, a); }
  friend Expression sqrt(const Expression& a) { return unary(Operation::Sqrt, a); }
  friend Expression exp(const Expression& a) { return unary(Operation::Exp, a); }
  friend Expression expm1(const Expression& a) { return exp(a) - 1; }
  friend Expression log(const Expression& a) { return unary(Operation::Log, a); }
  friend Expression log1p(const Expression& a) { return log(1 + a); }
  friend Expression log10(const Expression& a) { return unary(Operation::Log10, a); }
  friend Expression sin(const Expression& a) { return unary(Operation::Sin, a); }
  friend Expression cos(const Expression& a) { return unary(Operation::Cos, a); }
  friend Expression tan(const Expression& a) { return unary(Operation::Tan, a); }
  friend Expression asin(const Expression& a) { return unary(Operation::Asin, a); }
  friend Expression acos(const Expression& a) { return unary(Operation::Acos, a); }
  friend Expression atan(const Expression& a) { return unary(Operation::Atan, a); }
  friend Expression sinh(const Expression& a) { return unary(Operation::Sinh, a); }
  friend Expression cosh(const Expression& a) { return unary(Operation::Cosh, a); }
  friend Expression tanh(const Expression& a) { return unary(Operation::Tanh, a); }
  friend Expression asinh(const Expression& a) { return unary(Operation::Asinh, a); }
  friend Expression acosh(const Expression& a) { return unary(Operation::Acosh, a); }
  friend Expression atanh(const Expression& a) { return unary(Operation::Atanh, a); }

  friend bool operator<(const Expression& a, const Expression& b) { return numbers(a, b), a.number_ < b.number_; }
  friend bool operator>(const Expression& a, const Expression& b) { return b < a; }
  friend bool operator<=(const Expression& a, const Expression& b) { return numbers(a, b), a.number_ <= b.number_; }
  friend bool operator>=(const Expression& a, const Expression& b) { return b <= a; }
  friend bool operator==(const Expression& a, const Expression& b) { return numbers(a, b), a.number_ == b.number_; }

 private:
  static Expression unary(Operation operation, const Expression& a);
  static Expression binary(Operation operation, const Expression& a, const Expression& b);
  /// Throws Compared if one of them is none.
  static void numbers(const Expression& a, const Expression& b);

  ExpressionGraph* graph_ = nullptr;  // null: a number
  ExpressionGraph::Node node_ = -1;
  double number_ = 0;
};

/// A function R^n -> R^n, written down.
struct Expressions {
  ExpressionGraph graph{};
  std::vector<ExpressionGraph::Node> rows{};
};

/// f, run once on variables; F comes in with zeros. Nothing, if f compares, or answers that it is not defined.
std::optional<Expressions> written_down(
    const std::function<bool(std::span<const Expression> x, std::span<Expression> F)>& f, int n);

}  // namespace perp::ncp
