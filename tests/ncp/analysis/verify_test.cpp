// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/verify.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include <cmath>
#include <random>

#include "ncp/graph_problem.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

using testing::HasSubstr;

/// An affine problem and its solution, which is exact: M has small integers, x and F multiples of 2^-12, so that q is
/// a double.
struct Known {
  std::unique_ptr<Mcp> problem;
  Vec x;
  double margin = 0;  ///< the least of max(x_i - l_i, |F_i|)
};

Known random_affine(std::mt19937& random, Index n) {
  std::uniform_int_distribution<int> entry(-9, 9), number(0, 1 << 12), kind(0, 4);
  Eigen::MatrixXd M =
      Eigen::MatrixXd::NullaryExpr(n, n, [&](Index, Index) { return kind(random) == 0 ? entry(random) : 0; });
  for (Index i = 0; i < n; ++i) M(i, i) += entry(random);
  Vec x(n), w(n);
  Box box{Vec::Zero(n), Vec::Constant(n, infinity)};
  for (Index i = 0; i < n; ++i) {
    const double size = (1 + number(random)) * 0x1p-12;
    const int which = kind(random);
    if (which == 0) box.lower[i] = -infinity;
    if (which == 1) box.upper[i] = 4;
    x[i] = which <= 2 ? size : which == 3 ? 0 : size;
    w[i] = which == 3 ? (1 + number(random)) * 0x1p-12 : 0;
    if (which == 4) box.upper[i] = x[i], w[i] = -(1 + number(random)) * 0x1p-12;
  }
  return {make_affine_mcp({M.sparseView(), w - M * x, box}, "known"), x, 0x1p-12};
}

bool holds(const Verified& v, const Vec& solution) {
  return ((v.x - solution).cwiseAbs().array() <= v.radius.array()).all();
}

// Solutions that are known exactly, from points near them. Catches a box without its solution, which would be a false
// proof, and a bound so loose that little is proven.
TEST(Verify, HoldsTheSolutionAlways) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise;
  int regular = 0, proven = 0;
  for (int k = 0; k < 2000; ++k) {
    const Known known = random_affine(random, 1 + k % 12);
    Vec near = known.x;
    for (double& x : near) x += 1e-9 * noise(random);
    const Verified v = verify(*known.problem, near);
    if (v.unique) {
      ASSERT_TRUE(holds(v, known.x)) << k;
      EXPECT_LE(v.largest_radius(), 1e-4) << k;
    } else {
      EXPECT_NE(v.why_not, "") << k;
    }
    SpMat J = known.problem->jacobian_pattern();
    ASSERT_TRUE(known.problem->jacobian(known.x, J));
    std::vector<Index> inner;
    for (Index i = 0; i < known.x.size(); ++i)
      if (known.x[i] != known.problem->box().lower[i] && known.x[i] != known.problem->box().upper[i])
        inner.push_back(i);
    const Eigen::MatrixXd block = Eigen::MatrixXd(J)(inner, inner);
    if (inner.empty() || Eigen::JacobiSVD<Eigen::MatrixXd>(block).singularValues().minCoeff() > 1e-7) {
      ++regular;
      proven += v.unique ? 1 : 0;
    }
  }
  EXPECT_GE(proven, regular * 99 / 100) << regular;
}

/// F_i = 2^r_i (sum_j M_ij y_j + a_i y_i^3 + b_i y_i y_k + q_i), y_j = 2^-c_j x_j, with small integers M, a, b and y, F
/// of few bits: no sum rounds, q is a double, and the solution is known to all digits. Rows and columns of very
/// different size give conditions of J up to 10^20 and margins down to 10^-10.
Known random_polynomial(std::mt19937& random, Index n) {
  std::uniform_int_distribution<int> entry(-9, 9), number(1, 1 << 10), kind(0, 4), small(-3, 3), power(-9, 9);
  const bool scaled = kind(random) < 2;
  ExpressionGraph g;
  std::vector<ExpressionGraph::Node> rows, y;
  std::vector<double> unit, value;
  Box box{Vec::Zero(n), Vec::Constant(n, infinity)};
  Vec x(n), w = Vec::Zero(n);
  double margin = infinity;
  for (Index j = 0; j < n; ++j) {
    unit.push_back(scaled ? std::ldexp(1, power(random)) : 1);
    const int which = kind(random);
    value.push_back(which == 0 ? 0 : number(random) * 0x1p-10);
    x[j] = value.back() * unit.back();
    if (which == 1) box.lower[j] = -infinity;
    if (which == 2) box.upper[j] = x[j];
    if (which == 3) box.upper[j] = 2 * unit.back();
    if (which == 0) w[j] = number(random) * 0x1p-10;
    if (which == 2) w[j] = -number(random) * 0x1p-10;
    if (which >= 3) margin = std::min(margin, x[j]);
    if (which == 3) margin = std::min(margin, box.upper[j] - x[j]);
    y.push_back(g.binary(Operation::Multiply, g.constant(1 / unit.back()), g.variable(static_cast<int>(j))));
  }
  for (Index i = 0; i < n; ++i) {
    double q = w[i];
    std::vector<ExpressionGraph::Node> terms;
    const auto add = [&](int c, std::initializer_list<Index> of) {
      auto term = g.constant(c);
      double product = c;
      for (const Index j : of) term = g.binary(Operation::Multiply, term, y[at(j)]), product *= value[at(j)];
      terms.push_back(term);
      q -= product;
    };
    for (Index j = 0; j < n; ++j)
      if (i == j || kind(random) == 0) add(entry(random), {j});
    add(small(random), {i, i, i});
    add(small(random), {i, (i + 1) % n});
    terms.push_back(g.constant(q));
    const double scale = scaled ? std::ldexp(1, power(random)) : 1;
    rows.push_back(g.binary(Operation::Multiply, g.constant(scale), g.sum(terms)));
    if (w[i] != 0) margin = std::min(margin, std::abs(w[i]) * scale);
  }
  return {std::make_unique<GraphProblem>(std::move(g), rows, std::move(box)), x, margin};
}

// Ten thousand problems, of which nearly half are scaled at random, from points near their solutions. Catches a box
// without its solution, and a proof that is not found of a well-conditioned problem with some margin.
TEST(Verify, IsNeverWrongOverTenThousandProblems) {
  std::mt19937 random(29);
  std::normal_distribution<double> noise;
  int fit = 0, proven_fit = 0, proven = 0;
  for (int k = 0; k < 10000; ++k) {
    const Known known = random_polynomial(random, 1 + k % 8);
    Vec near = known.x;
    for (double& x : near) x += 1e-9 * std::abs(x) * noise(random);
    const Verified v = verify(*known.problem, near);
    if (v.unique) {
      ASSERT_TRUE(holds(v, known.x)) << k;
    }
    proven += v.unique ? 1 : 0;
    const Box& box = known.problem->box();
    SpMat J = known.problem->jacobian_pattern();
    ASSERT_TRUE(known.problem->jacobian(known.x, J));
    std::vector<Index> inner;
    for (Index i = 0; i < known.x.size(); ++i)
      if (known.x[i] != box.lower[i] && known.x[i] != box.upper[i]) inner.push_back(i);
    const Eigen::MatrixXd block = Eigen::MatrixXd(J)(inner, inner);
    const Vec singular = inner.empty() ? Vec::Ones(1) : Vec(Eigen::JacobiSVD<Eigen::MatrixXd>(block).singularValues());
    if (!(known.margin >= 1e-6 && singular.maxCoeff() <= 1e8 * singular.minCoeff())) continue;
    ++fit;
    proven_fit += v.unique ? 1 : 0;
  }
  RecordProperty("fit", fit);
  RecordProperty("proven_fit", proven_fit);
  RecordProperty("proven", proven);
  EXPECT_GT(fit, 8000);
  EXPECT_GE(proven_fit, fit * 95 / 100) << "of " << fit;
}

// x^2 - 2 = 0 on [0, 10], whose solution has 50 known digits; rounded to double it is off by at most half an ulp.
TEST(Verify, EnclosesARoot) {
  ExpressionGraph g;
  const auto row =
      g.binary(Operation::Subtract, g.binary(Operation::Multiply, g.variable(0), g.variable(0)), g.constant(2));
  const GraphProblem problem(std::move(g), {row}, Box{Vec{{0}}, Vec{{10}}});
  const Verified v = verify(problem, Vec{{1.41421}});
  ASSERT_TRUE(v.unique) << v.why_not;
  EXPECT_LE(std::abs(v.x[0] - std::sqrt(2.0)), v.radius[0] + 1e-15);
  EXPECT_LE(v.radius[0], 1e-14);
  EXPECT_EQ(v.active, 0);
}

// min(x, x^2) has a double root at 0: F = x^2 at x >= 0, free. Josephy's and others' degenerate solutions: no proof may
// come, and a reason has to.
TEST(Verify, RefusesWhatIsNotRegular) {
  ExpressionGraph g;
  const auto x = g.variable(0);
  const auto row = g.binary(Operation::Multiply, x, x);
  const GraphProblem twice(g, {row}, Box::free(1));
  const Verified v = verify(twice, Vec{{1e-9}});
  EXPECT_FALSE(v.unique);
  EXPECT_THAT(v.why_not, HasSubstr("singular"));

  const auto degenerate = make_affine_mcp({dense_pattern(1), Vec{{0}}, Box::nonnegative(1)}, "degenerate");
  EXPECT_FALSE(verify(*degenerate, Vec{{0}}).unique);
}

// A point far from every solution: x + 1 at x >= 0 has its solution at 0; from 3 it is found, and a box is no proof
// about 3. And one where nothing is near: x^2 + 1 = 0.
TEST(Verify, ProvesNothingWhereNothingIs) {
  ExpressionGraph g;
  const auto x = g.variable(0);
  const auto row = g.binary(Operation::Add, g.binary(Operation::Multiply, x, x), g.constant(1));
  const GraphProblem none(g, {row}, Box::free(1));
  EXPECT_FALSE(verify(none, Vec{{0.3}}).unique);
}

// |x| - 1 is Lipschitz continuous: the kink at 0 is not near its solution 1, and is that of |x| = 0.
TEST(Verify, LooksAtKinks) {
  ExpressionGraph g;
  const auto away = g.binary(Operation::Subtract, g.unary(Operation::Absolute, g.variable(0)), g.constant(1));
  EXPECT_TRUE(verify(GraphProblem(g, {away}, Box::free(1)), Vec{{1.1}}).unique);
  ExpressionGraph h;
  const auto kink = h.unary(Operation::Absolute, h.variable(0));
  EXPECT_FALSE(verify(GraphProblem(h, {kink}, Box::free(1)), Vec{{1e-12}}).unique);
}

// sqrt(x) at its solution 0 is not defined on both sides: F of a variable at its bound has to be defined all around.
TEST(Verify, AsksThatFIsDefined) {
  ExpressionGraph g;
  const auto row = g.binary(Operation::Add, g.unary(Operation::Sqrt, g.variable(0)), g.constant(1));
  const Verified v = verify(GraphProblem(g, {row}, Box::nonnegative(1)), Vec{{0}});
  EXPECT_FALSE(v.unique);
  EXPECT_THAT(v.why_not, HasSubstr("not known to be defined"));
}

// F_1 = exp(x) + 1 - 2000 y with x free, F_2 = 40 (exp(x) - c)^2 - 1/2 at y >= 0, c = exp(-2) - 6e-5. Newton steps
// from (0, 0) lead to where exp(x) overflows, and F_1 = inf there is no reason to take x for a variable at its bound
// -inf, where the signs of F are those of a solution. Catches a proof about a point that is none.
TEST(Verify, DoesNotTakeAnInfiniteBoundForASolution) {
  ExpressionGraph g;
  const auto x = g.variable(0), e = g.unary(Operation::Exp, x);
  const auto F1 = g.binary(Operation::Subtract, g.binary(Operation::Add, e, g.constant(1)),
                           g.binary(Operation::Multiply, g.constant(2000), g.variable(1)));
  const auto away = g.binary(Operation::Subtract, e, g.constant(std::exp(-2) - 6e-5));
  const auto F2 = g.binary(
      Operation::Subtract,
      g.binary(Operation::Multiply, g.constant(40), g.binary(Operation::Power, away, g.constant(2))), g.constant(0.5));
  const GraphProblem problem(std::move(g), {F1, F2}, Box{Vec{{-infinity, 0}}, Vec{{infinity, infinity}}});
  const Verified v = verify(problem, Vec::Zero(2));
  EXPECT_TRUE(v.x.allFinite());
  EXPECT_FALSE(v.unique && !v.x.allFinite());
}

TEST(Verify, RefusesAPointOfAnotherSize) {
  const auto problem = make_affine_mcp({dense_pattern(1), Vec{{1}}, Box::nonnegative(1)}, "one");
  EXPECT_THROW((void)verify(*problem, Vec::Zero(2)), std::invalid_argument);
  EXPECT_THROW((void)verify(*problem, Vec{{std::nan("")}}), std::invalid_argument);
}

// A problem of functions gives no ranges.
TEST(Verify, SaysWhyItCannot) {
  const auto problem = make_mcp({.box = Box::nonnegative(1),
                                 .pattern = dense_pattern(1),
                                 .F =
                                     [](In x, Out F) {
                                       F[0] = x[0];
                                       return true;
                                     },
                                 .J =
                                     [](In, SpMat& J) {
                                       J.coeffRef(0, 0) = 1;
                                       return true;
                                     }});
  EXPECT_THAT(verify(*problem, Vec{{0}}).why_not, HasSubstr("gives no ranges"));
}

}  // namespace
}  // namespace perp::ncp
