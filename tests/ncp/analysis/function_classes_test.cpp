// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/function_classes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "ncp/graph_problem.hpp"
#include "ncp/problem/affine.hpp"
#include "support/matrices.hpp"

namespace perp::ncp {
namespace {

using lcp::Answer;
using support::matrix;

std::string answers(const FunctionClasses& classes) {
  std::string text;
  for (const auto& [name, property] : classes.all())
    text += property->answer == Answer::Yes ? '+' : property->answer == Answer::No ? '-' : '?';
  return text;
}

std::string of_matrix(const SpMat& M, Box box) {
  const Vec zero = Vec::Zero(M.rows());
  return answers(function_classes(*make_affine_mcp({M, zero, std::move(box)}, "M"), zero));
}

// Affine functions, whose classes are those of the matrix (Cottle, Pang & Stone 1992, chapter 3). In order: monotone,
// strictly, strongly, P0, P, uniform P. Catches an implication that goes the wrong way.
TEST(FunctionClasses, OfMatrices) {
  const Box plane = Box::free(2);
  EXPECT_EQ(of_matrix(matrix({{2, -1}, {0, 2}}), plane), "++++++");
  EXPECT_EQ(of_matrix(matrix({{0, -1}, {1, 0}}), plane), "+--+--");  // a rotation: (1, 0) has d'D = 0
  EXPECT_EQ(of_matrix(matrix({{1, 4}, {0, 1}}), plane), "---+++");   // P, and not monotone along (1, -1)
  EXPECT_EQ(of_matrix(matrix({{1, -1}, {-1, 1}}), plane), "+--+--");
  EXPECT_EQ(of_matrix(matrix({{-1, 0}, {0, 1}}), plane), "------");
  EXPECT_EQ(of_matrix(matrix({{1, 2}, {2, 1}}), plane), "------");  // its determinant is negative
}

// Least eigenvalues of M + M' that rounding hides: -2^-51 is no reason to say "monotone", and a singular matrix that is
// semidefinite is proven to be so, exactly. Catches "to rounding" that passes for a proof.
TEST(FunctionClasses, AreNotProvenByRounding) {
  const Box plane = Box::free(2);
  const double more = std::nextafter(1.0, 2);
  EXPECT_NE(of_matrix(matrix({{1, more}, {more, 1}}), plane).front(), '+');
  EXPECT_EQ(of_matrix(matrix({{1, -2}, {-2, 4}}), plane), "+--+--");
  // aa' with a = (1, 1/3, 3) in doubles, whose products round: its form at some v is negative.
  const Vec a{{1, 1. / 3, 3}};
  SpMat rounded = (a * a.transpose()).sparseView();
  rounded.coeffRef(1, 1) = std::nextafter(rounded.coeff(1, 1), 0);
  EXPECT_NE(of_matrix(rounded, Box::free(3)).front(), '+');
  // 40 blocks of (1, 2; 2, 4): semidefinite, though not dominant, and too large for the exact test as one.
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < 80; k += 2)
    for (const auto& [i, j, value] : {std::tuple(0, 0, 1.0), {0, 1, 2.0}, {1, 0, 2.0}, {1, 1, 4.0}})
      entries.emplace_back(k + i, k + j, value);
  SpMat blocks(80, 80);
  blocks.setFromTriplets(entries.begin(), entries.end());
  EXPECT_EQ(of_matrix(blocks, Box::free(80)).front(), '+');
}

// The form of (1, 0; c, 0) is negative at (1, -2 / c). Catches c + c that overflows, and a test in floating point that
// takes what comes of infinity for a yes.
TEST(FunctionClasses, OfTheLargestAndTheSmallestEntries) {
  for (const double c : {1e-320, 1e-300, 1e-160, 1e160, 1e300, 1e308}) {
    EXPECT_NE(of_matrix(matrix({{1, 0}, {c, 0}}), Box::free(2)).front(), '+') << c;
    EXPECT_NE(of_matrix(matrix({{c / 4, 0}, {c, c / 4}}), Box::free(2)).front(), '+') << c;
  }
}

// Matrices that are singular but for their rounding, which makes some of them indefinite. Catches a bound of rounding
// that is made from squares of the entries, and vanishes where they do.
TEST(FunctionClasses, OfSmallEntriesAreNotProvenByRounding) {
  for (const double c : {1.0, 1e-160, 1e-165, 1e-171, 1e-200, 1e-300})
    for (const Vec& a : {Vec{{0.3, 0.7}}, Vec{{1. / 3, 0.7}}, Vec{{0.1, -0.4}}, Vec{{-2. / 3, 0.7}}}) {
      const SpMat M = (c * a * a.transpose()).sparseView(0, 0);
      const FunctionClasses classes = function_classes(*make_affine_mcp({M, Vec::Zero(2), Box::free(2)}, "M"), a);
      EXPECT_NE(classes.strongly_monotone.answer, Answer::Yes) << c << ": " << classes.strongly_monotone.reason;
      EXPECT_EQ(classes.modulus, 0) << c;
    }
}

// A variable that is fixed takes part in nothing. Catches a witness that moves it.
TEST(FunctionClasses, LeaveFixedVariablesOut) {
  EXPECT_EQ(of_matrix(matrix({{-1, 5}, {5, 2}}), Box{Vec{{0, 0}}, Vec{{0, 1}}}), "++++++");
}

struct Scalar {
  ExpressionGraph g;
  ExpressionGraph::Node x = g.variable(0);
  FunctionClasses classes(ExpressionGraph::Node row, double lower, double upper) {
    return function_classes(GraphProblem(g, {row}, Box{Vec{{lower}}, Vec{{upper}}}), Vec{{std::max(lower, 0.5)}});
  }
};

// x + x^3 has F' >= 1; exp x has F' > 0 and no more on R, and F' >= 1 on x >= 0; x^2 is monotone for x >= 0 alone.
// Catches a box that is not looked at.
TEST(FunctionClasses, OfFunctionsDependOnTheBox) {
  Scalar s;
  const auto cube = s.g.binary(Operation::Power, s.x, s.g.constant(3));
  const FunctionClasses strong = s.classes(s.g.binary(Operation::Add, s.x, cube), -infinity, infinity);
  EXPECT_EQ(answers(strong), "++++++");
  EXPECT_NEAR(strong.modulus, 1, 1e-12);
  EXPECT_LE(strong.modulus, 1);

  const auto exponential = s.g.unary(Operation::Exp, s.x);
  EXPECT_EQ(answers(s.classes(exponential, -infinity, infinity)), "+??+??");
  EXPECT_EQ(answers(s.classes(exponential, 0, infinity)), "++++++");

  const auto square = s.g.binary(Operation::Multiply, s.x, s.x);
  EXPECT_EQ(answers(s.classes(square, -infinity, infinity)), "------");
  EXPECT_EQ(answers(s.classes(square, 1, infinity)), "++++++");
}

// log x is not known to be smooth at 0: nothing is proven, and nothing refuted.
TEST(FunctionClasses, AskForSmoothness) {
  Scalar s;
  const FunctionClasses c = s.classes(s.g.unary(Operation::Log, s.x), 0, infinity);
  EXPECT_EQ(answers(c), "??????");
  EXPECT_NE(c.monotone.reason.find("not known to be smooth"), std::string::npos);
}

// Functions that increase strictly where they are defined, which is not everywhere in the box; the rest of each is
// defined everywhere, so that its range hides the gap. Catches a witness where F has no value.
TEST(FunctionClasses, RefuteByPointsOfTheDomain) {
  using enum Operation;
  Scalar s;
  const auto zero = s.g.constant(0), five = s.g.constant(5);
  const auto log = s.g.unary(Log, s.x), root = s.g.unary(Sqrt, s.x);
  const auto square = s.g.binary(Multiply, s.x, s.x);
  const auto pole = s.g.unary(Negate, s.g.binary(Divide, s.g.constant(1), root));
  const std::pair<const char*, ExpressionGraph::Node> rows[] = {
      {"if x >= 0 then x^2 else log(x)", s.g.binary(Either, square, log)},
      {"x^2 + 0 log(x)", s.g.binary(Add, square, s.g.binary(Multiply, zero, log))},
      {"atan(-1 / sqrt(x))", s.g.unary(Atan, pole)},
      {"x^2 + min(sqrt(x), 0)", s.g.binary(Add, square, s.g.binary(Minimum, root, zero))},
      {"x^2 + max(log(x), 5) - 5", s.g.binary(Add, square, s.g.binary(Subtract, s.g.binary(Maximum, log, five), five))},
      {"x^1.5", s.g.binary(Power, s.x, s.g.constant(1.5))},
      {"acosh(x)", s.g.unary(Acosh, s.x)},
      {"atanh(x)", s.g.unary(Atanh, s.x)}};
  for (const auto& [what, row] : rows) {
    const FunctionClasses c = s.classes(row, -3, 4);
    for (const auto& [name, property] : c.all()) EXPECT_NE(property->answer, Answer::No) << what << " " << name;
  }
  // A row that is defined nowhere near the witnesses of the other one.
  const auto y = s.g.variable(1);
  const auto falls = s.g.unary(Negate, s.x);
  const GraphProblem problem(s.g, {falls, s.g.unary(Log, y)}, Box{Vec{{-1, -2}}, Vec{{1, -1}}});
  EXPECT_EQ(answers(function_classes(problem, Vec{{0, -1}})), "??????");
}

// y = 2 is fixed, its row log(1 - y) + x has no value there: F is no function on the box. Catches a class of the other
// rows alone; with log(y) in its place everything holds.
TEST(FunctionClasses, HoldForTheRowsOfFixedVariables) {
  using enum Operation;
  for (const bool defined : {false, true}) {
    ExpressionGraph g;
    const auto x = g.variable(0), y = g.variable(1);
    const auto argument = defined ? y : g.binary(Subtract, g.constant(1), y);
    const auto row = g.binary(Add, g.unary(Log, argument), x);
    const GraphProblem problem(std::move(g), {x, row}, Box{Vec{{-1, 2}}, Vec{{1, 2}}});
    const FunctionClasses c = function_classes(problem, Vec{{0, 2}});
    EXPECT_EQ(answers(c), defined ? "++++++" : "??????");
    EXPECT_EQ(c.monotone.reason.find("not known to be defined") != std::string::npos, !defined) << c.monotone.reason;
  }
}

// F_i = a_i x_i + sum of b_ij sin(x_j): what is proven holds at random pairs, and two points refute what they say
// they do. Would catch a proof by the wrong end of a range.
TEST(FunctionClasses, AreRight) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> entry(-1, 1);
  int proven = 0, refuted = 0;
  for (int k = 0; k < 300; ++k) {
    const Index n = 1 + k % 4;
    ExpressionGraph g;
    std::vector<ExpressionGraph::Node> rows;
    for (Index i = 0; i < n; ++i) {
      std::vector<ExpressionGraph::Node> terms{
          g.binary(Operation::Multiply, g.constant(2 * entry(random) + 1), g.variable(static_cast<int>(i)))};
      for (Index j = 0; j < n; ++j)
        terms.push_back(g.binary(Operation::Multiply, g.constant(entry(random)),
                                 g.unary(Operation::Sin, g.variable(static_cast<int>(j)))));
      rows.push_back(g.sum(terms));
    }
    const GraphProblem problem(std::move(g), rows, Box{Vec::Constant(n, -2), Vec::Constant(n, 2)});
    const FunctionClasses c = function_classes(problem, Vec::Zero(n), {.samples = 5});
    const auto products = [&](const Vec& x, const Vec& y) {
      Vec Fx(n), Fy(n);
      EXPECT_TRUE(problem.eval(x, Fx) && problem.eval(y, Fy));
      return Vec((x - y).cwiseProduct(Fx - Fy));
    };
    for (int pair = 0; pair < 30; ++pair) {
      const Vec x = Vec::NullaryExpr(n, [&](Index) { return 2 * entry(random); });
      const Vec y = Vec::NullaryExpr(n, [&](Index) { return 2 * entry(random); });
      const Vec p = products(x, y);
      if (c.monotone.answer == Answer::Yes) {
        EXPECT_GE(p.sum(), -1e-12) << k;
      }
      if (c.strongly_monotone.answer == Answer::Yes) {
        EXPECT_GE(p.sum(), c.modulus * (x - y).squaredNorm() - 1e-12) << k;
      }
      if (c.p.answer == Answer::Yes) {
        EXPECT_GT(p.maxCoeff(), 0) << k;
      }
    }
    if (c.monotone.answer == Answer::No) {
      EXPECT_LT(products(c.monotone.x, c.monotone.y).sum(), 1e-12) << k;
    }
    if (c.p.answer == Answer::No) {
      EXPECT_LE(products(c.p.x, c.p.y).maxCoeff(), 1e-12) << k;
    }
    proven += c.p.answer == Answer::Yes ? 1 : 0;
    refuted += c.p.answer == Answer::No ? 1 : 0;
  }
  EXPECT_GT(proven, 50);
  EXPECT_GT(refuted, 50);
}

}  // namespace
}  // namespace perp::ncp
