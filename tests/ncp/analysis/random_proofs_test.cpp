// SPDX-License-Identifier: Apache-2.0
/// All that is proven of random functions of one variable, against their values: poles, kinks, jumps, borders of
/// domains, powers, infinite boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <random>
#include <vector>

#include "ncp/analysis/function_classes.hpp"
#include "ncp/analysis/no_solution.hpp"
#include "ncp/analysis/verify.hpp"
#include "ncp/graph_problem.hpp"

namespace perp::ncp {
namespace {

using lcp::Answer;

class RandomFunction {
 public:
  explicit RandomFunction(std::mt19937& random) : random_(random), problem_(make()) {}
  const GraphProblem& problem() const { return problem_; }
  double low() const { return problem_.box().lower[0]; }
  double high() const { return problem_.box().upper[0]; }
  Interval F(double x) const {
    const std::vector<Interval> X{Interval(x)};
    std::vector<Interval> F(1);
    static_cast<const Mcp&>(problem_).enclosure()->values(X, F);
    return F[0];
  }
  /// In the box, and not beyond 50.
  double point() {
    std::uniform_real_distribution<double> part(0, 1);
    const double from = std::max(low(), -50.0), to = std::min(high(), 50.0);
    return std::clamp(from + part(random_) * (to - from), low(), high());
  }

 private:
  int below(std::size_t n) { return static_cast<int>(random_() % n); }
  GraphProblem make() {
    using enum Operation;
    constexpr double numbers[] = {0, 1, -1, 2, 3, -2, .5, -.5, 1.5, .1, 10, 1e-3, 4, 1e-8, 1e8};
    constexpr Operation binary[] = {Add,     Subtract, Multiply, Divide,   Power,   Minimum,
                                    Maximum, Atan2,    Multiply, Subtract, Subtract};
    constexpr Operation unary[] = {Negate, Absolute, Floor, Ceil, Sqrt, Exp,  Log,  Log10, Sin,   Cos,
                                   Tan,    Asin,     Acos,  Atan, Sinh, Cosh, Tanh, Asinh, Acosh, Atanh};
    ExpressionGraph g;
    std::vector<ExpressionGraph::Node> nodes{g.variable(0)};
    const auto operand = [&] {
      if (below(3) == 0) return g.constant(numbers[below(std::size(numbers))]);
      const std::size_t n = nodes.size();
      return below(2) == 0 ? nodes[static_cast<std::size_t>(below(n))]
                           : nodes[n - 1 - static_cast<std::size_t>(below(std::min<std::size_t>(n, 3)))];
    };
    for (int k = below(9); k > -2; --k) {
      const auto a = operand();
      nodes.push_back(below(3) == 0 ? g.unary(unary[below(std::size(unary))], a)
                                    : g.binary(binary[below(std::size(binary))], a, operand()));
    }
    std::uniform_real_distribution<double> value(-3, 3);
    double low = below(3) == 0 ? -infinity : below(2) == 0 ? value(random_) : 0;
    double high = below(2) == 0 ? infinity : value(random_);
    if (low > high) std::swap(low, high);
    const auto root = nodes.back();
    return {std::move(g), {root}, Box{Vec{{low}}, Vec{{high}}}};
  }
  std::mt19937& random_;
  GraphProblem problem_;
};

/// Whether the values about the point allow that exactly one solution is there.
void check(const RandomFunction& f, const Verified& v, int k) {
  const double x = v.x[0], r = v.radius[0];
  ASSERT_TRUE(std::isfinite(x)) << k;
  if (f.low() == f.high()) return;
  int last = 0, changes = 0;
  for (int q = 0; q <= 20; ++q) {
    const double at = std::clamp(x - r + r * q / 10, f.low(), f.high());
    const Interval F = f.F(at);
    ASSERT_FALSE(F.is_empty()) << k << ": not defined at " << at;
    ASSERT_TRUE(x != f.low() || F.upper > 0) << k;
    ASSERT_TRUE(x != f.high() || F.lower < 0) << k;
    const int sign = F.lower > 0 ? 1 : F.upper < 0 ? -1 : 0;
    changes += sign != 0 && last != 0 && sign != last ? 1 : 0;
    if (sign != 0) last = sign;
  }
  if (x == f.low() || x == f.high()) return;
  ASSERT_TRUE(x - r > f.low() && x + r < f.high()) << k;
  ASSERT_LE(changes, 1) << k << ": several zeros";
  const Interval left = f.F(x - r), right = f.F(x + r);
  ASSERT_FALSE((left.lower > 0 && right.lower > 0) || (left.upper < 0 && right.upper < 0)) << k << ": no zero at " << x;
}

// Catches any of the three proofs that says what is false, of functions that nobody thought of.
TEST(RandomProofs, SayNothingFalse) {
  std::mt19937 random(17);
  int verified = 0, refuted = 0, monotone = 0;
  for (int k = 0; k < 2000; ++k) {
    RandomFunction f(random);
    if (const Verified v = verify(f.problem(), Vec{{f.point()}}); v.unique) {
      ++verified;
      check(f, v, k);
    }
    if (no_solution(f.problem(), 1e-6)) {
      ++refuted;
      for (int q = 0; q < 40; ++q) {
        const double x = f.point();
        const Interval F = f.F(x);
        if (!F.bounded()) continue;
        const auto residual = [&](double value) {
          return std::abs(std::max(x - f.high(), std::min(value, x - f.low())));
        };
        ASSERT_GT(std::max(residual(F.lower), residual(F.upper)), 1e-6) << k << " at " << x;
      }
    }
    const FunctionClasses classes = function_classes(f.problem(), Vec{{f.point()}}, {.samples = 0});
    if (classes.monotone.answer != Answer::Yes) continue;
    ++monotone;
    for (int q = 0; q < 20; ++q) {
      const double x = f.point(), y = f.point();
      const Interval product = (Interval(x) - y) * (f.F(x) - f.F(y));
      ASSERT_FALSE(product.is_empty()) << k << ": not defined";
      ASSERT_GE(product.upper, 0) << k << " at " << x << ", " << y;
      if (classes.strongly_monotone.answer == Answer::Yes) {
        ASSERT_GE(product.upper, classes.modulus * (x - y) * (x - y) * (1 - 1e-9)) << k;
      }
    }
  }
  EXPECT_GT(verified, 200);
  EXPECT_GT(refuted, 100);
  EXPECT_GT(monotone, 100);
}

/// F of three variables from random operations, shifted so that x is a solution; nothing where F(x) is not known well.
std::optional<GraphProblem> with_solution(std::mt19937& random, Vec& x) {
  using enum Operation;
  constexpr double numbers[] = {0, 1, -1, 2, 3, .5, -.5, 1.5, .1, -3, 1e-8, 1e8, 1e300, 1e-308};
  constexpr Operation binary[] = {Add, Subtract, Multiply, Divide, Power, Minimum, Maximum, Atan2, Either, Add};
  constexpr Operation unary[] = {Negate, Absolute, Floor, Ceil, Sqrt, Exp, Log, Sin, Tan, Asin, Acosh, Atanh, Tanh};
  const auto one_of = [&](const auto& list) { return list[random() % std::size(list)]; };
  const auto value = [&] { return std::uniform_real_distribution<double>(-3, 3)(random); };
  ExpressionGraph g;
  std::vector<ExpressionGraph::Node> nodes{g.variable(0), g.variable(1), g.variable(2)}, rows;
  const auto operand = [&] { return random() % 4 == 0 ? g.constant(one_of(numbers)) : one_of(nodes); };
  for (int k = 0; k < 10; ++k) {
    const auto a = operand();
    nodes.push_back(random() % 3 == 0 ? g.unary(one_of(unary), a) : g.binary(one_of(binary), a, operand()));
  }
  Box box = Box::free(3);
  for (Index i = 0; i < 3; ++i) {
    x[i] = random() % 3 == 0 ? static_cast<double>(random() % 3) : value();
    if (random() % 2 == 0) box.lower[i] = random() % 4 == 0 ? -1.7e308 : x[i] - std::max(0.0, value());
    if (random() % 2 == 0) box.upper[i] = random() % 4 == 0 ? 1.7e308 : x[i] + std::max(0.0, value());
  }
  const auto at_x = g.ranges(std::vector<Interval>(x.begin(), x.end()));
  for (Index i = 0; i < 3; ++i) {
    const auto row = nodes[nodes.size() - 1 - random() % 5];
    const Interval F = at_x.values[at(row)];
    if (!(F.magnitude() < 1e6 && F.upper - F.lower < 1e-9)) return std::nullopt;
    const double sign = (x[i] == box.lower[i] ? 1 : 0) - (x[i] == box.upper[i] ? 1 : 0);
    rows.push_back(g.binary(Subtract, row, g.constant(F.lower - sign * std::abs(value()))));
  }
  return GraphProblem(std::move(g), rows, std::move(box));
}

// Catches a proof of "no solution" of what has one: by a sign, or in parts, over boxes that end nowhere or near the
// largest double.
TEST(RandomProofs, DoNotRefuteWhatHasASolution) {
  std::mt19937 random(23);
  int problems = 0;
  for (int k = 0; k < 5000; ++k) {
    Vec x(3);
    const auto problem = with_solution(random, x);
    if (!problem) continue;
    ++problems;
    ASSERT_FALSE(no_solution(*problem, 1e-6)) << k;
    ASSERT_EQ(no_solution_in_parts(*problem, 1e-6), 0) << k;
  }
  EXPECT_GT(problems, 2000);
}

}  // namespace
}  // namespace perp::ncp
