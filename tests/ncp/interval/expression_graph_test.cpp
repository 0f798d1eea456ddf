// SPDX-License-Identifier: Apache-2.0
/// Random expressions of all operations over random boxes, against their values at points.
#include "ncp/interval/expression_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace perp::ncp {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr int variables = 3;

class RandomGraph {
 public:
  explicit RandomGraph(std::mt19937& random) : random_(random) {
    for (int j = 0; j < variables; ++j) nodes_.push_back(graph.variable(j));
    for (int k = 0; k < 12; ++k) add();
    root = nodes_.back();
  }
  ExpressionGraph graph;
  ExpressionGraph::Node root;

 private:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  /// Recent ones more often.
  ExpressionGraph::Node operand() {
    if (below(4) == 0) {
      constexpr double numbers[] = {0, 1, -1, 2, 3, -2, 0.5, -0.5, 1.5, 0.1, 10, -0.0, 1e-3, 4};
      return graph.constant(numbers[below(std::size(numbers))]);
    }
    const int n = static_cast<int>(nodes_.size());
    return nodes_[static_cast<std::size_t>(below(2) == 0 ? n - 1 - below(std::min(n, 4)) : below(n))];
  }
  void add() {
    using enum Operation;
    constexpr Operation binary[] = {Add, Subtract, Multiply, Divide, Power, Minimum, Maximum, Atan2, Multiply, Add};
    constexpr Operation unary[] = {Negate, Absolute, Floor, Ceil, Sqrt, Exp,  Log,  Log10, Sin,   Cos,
                                   Tan,    Asin,     Acos,  Atan, Sinh, Cosh, Tanh, Asinh, Acosh, Atanh};
    const ExpressionGraph::Node a = operand();
    nodes_.push_back(below(2) == 0 ? graph.binary(binary[below(std::size(binary))], a, operand())
                                   : graph.unary(unary[below(std::size(unary))], a));
  }
  std::mt19937& random_;
  std::vector<ExpressionGraph::Node> nodes_;
};

double end(std::mt19937& random) {
  constexpr double ends[] = {0, -0.0, 1, -1, 2, 0.5, -3, 1e-9, 10};
  std::uniform_real_distribution<double> value(-3, 3);
  return random() % 2 == 0 ? ends[random() % std::size(ends)] : value(random);
}

/// At a point of the box, at times on its border.
std::vector<Interval> point(std::mt19937& random, const std::vector<Interval>& X) {
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Interval> x;
  for (const Interval& range : X) {
    const double low = std::max(range.lower, -1e3), high = std::min(range.upper, 1e3);
    const unsigned which = random() % 4;
    x.emplace_back(which == 0 ? low : which == 1 ? high : std::clamp(low + part(random) * (high - low), low, high));
  }
  return x;
}

// What the range of a box says holds at its points: the value lies in it, and where the expression is smooth, it is
// defined, and the difference of two values is that of the slopes (the mean value theorem, by Clarke's Jacobian).
// Catches a rule that is wrong at the border of a domain, at a kink, at a jump, or at an infinite end.
TEST(ExpressionGraph, RangesHoldOverRandomExpressions) {
  std::mt19937 random(12);
  int smooth = 0, defined = 0;
  for (int k = 0; k < 10000; ++k) {
    RandomGraph f(random);
    const auto root = static_cast<std::size_t>(f.root);
    std::vector<Interval> X;
    for (int j = 0; j < variables; ++j) {
      const double a = end(random), b = end(random);
      const unsigned which = random() % 8;
      X.emplace_back(which == 0 ? -endless : std::min(a, b), which == 1   ? endless
                                                             : which == 2 ? std::min(a, b)
                                                                          : std::max(a, b));
    }
    const auto ranges = f.graph.ranges(X);
    std::vector<Interval> slopes(variables);
    std::vector<char> visited(f.graph.size());
    const bool is_smooth = ranges.smooth[root] != 0;
    if (is_smooth) f.graph.add_derivatives(f.root, ranges, slopes, visited);
    std::vector<Interval> before, value_before;
    for (int t = 0; t < 5; ++t) {
      const std::vector<Interval> x = point(random, X);
      const auto there = f.graph.ranges(x);
      const Interval value = there.values[root];
      if (is_smooth) {
        ASSERT_FALSE(value.is_empty()) << k << ": said to be defined everywhere";
      }
      ASSERT_TRUE(there.defined[root] != 0 || ranges.defined[root] == 0) << k << ": defined on the box, not at a point";
      if (there.defined[root] != 0) {
        ASSERT_FALSE(value.is_empty()) << k << ": defined without a value";
      }
      if (value.is_empty()) continue;
      ++defined;
      // The point's own range may be wide, where it jumps.
      ASSERT_FALSE(intersection(value, ranges.values[root]).is_empty())
          << k << ": [" << value.lower << ", " << value.upper << "] outside of [" << ranges.values[root].lower << ", "
          << ranges.values[root].upper << "]";
      if (!before.empty() && is_smooth && value.bounded() && value_before[0].bounded()) {
        ++smooth;
        Interval change = 0;
        for (std::size_t j = 0; j < variables; ++j) change += slopes[j] * (x[j] - before[j]);
        ASSERT_FALSE(intersection(change, value - value_before[0]).is_empty()) << k << ": slopes";
      }
      before = x;
      value_before = {value};
    }
  }
  EXPECT_GT(defined, 10000);
  EXPECT_GT(smooth, 2000);
}

}  // namespace
}  // namespace perp::ncp
