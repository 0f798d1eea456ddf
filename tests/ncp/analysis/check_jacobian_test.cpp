// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "ncp/problem/mcp.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::nan;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::HasSubstr;

/// J of a problem of support::dense with one entry changed.
Functions with_entry(Functions functions, Index i, Index j, std::function<double(double)> change) {
  functions.J = [J = std::move(functions.J), i, j, change = std::move(change)](In x, SpMat& out) {
    const bool defined = J(x, out);
    out.coeffRef(i, j) = change(out.coeff(i, j));
    return defined;
  };
  return functions;
}

// Central differences with h = 1e-6 are off by h^2 F''' / 6 and eps F / h: 1e-8 at most here. Catches false alarms,
// which would refuse a good problem.
TEST(CheckJacobian, PassesRightDerivatives) {
  Random random(1);
  const auto kojima = make_mcp(support::kojima_shindo());
  const auto nash = make_mcp(support::nash10());
  for (int k = 0; k < 50; ++k) {
    const JacobianCheck polynomial = check_jacobian(*kojima, 3 * random.normals(4));
    EXPECT_TRUE(polynomial.defined);
    EXPECT_EQ(polynomial.columns, 4);
    EXPECT_LT(polynomial.worst, 1e-7);
    const JacobianCheck powers = check_jacobian(*nash, (random.normals(10).cwiseAbs().array() + 0.5).matrix());
    EXPECT_TRUE(powers.defined);
    EXPECT_LT(powers.worst, 1e-7);
    EXPECT_EQ(describe(*nash, powers), "");
  }
}

// Every entry in turn wrong by a percent, or of the wrong sign. Catches rows and columns exchanged in the report.
TEST(CheckJacobian, FindsAndNamesTheWrongEntry) {
  Functions functions = support::nash10();
  const Vec x = Vec::LinSpaced(10, 1, 3);
  for (Index i = 0; i < 10; ++i)
    for (Index j = 0; j < 10; ++j) {
      const auto mcp = make_mcp(with_entry(functions, i, j, [](double v) { return v + 0.01 * std::max(1.0, v); }));
      const JacobianCheck check = check_jacobian(*mcp, x);
      ASSERT_EQ(check.row, i);
      ASSERT_EQ(check.col, j);
      ASSERT_GT(check.worst, 5e-3);
      ASSERT_FALSE(check.outside_pattern);
      ASSERT_GT(check.given, check.difference);
    }
  functions.variable_names = {"q1", "q2", "price", "q4", "q5", "q6", "q7", "q8", "q9", "q10"};
  const auto mcp = make_mcp(with_entry(functions, 4, 2, [](double) { return -77.5; }));
  const JacobianCheck check = check_jacobian(*mcp, x);
  EXPECT_EQ(check.given, -77.5);
  EXPECT_THAT(describe(*mcp, check),
              AllOf(HasSubstr("F[5]"), HasSubstr("price"), HasSubstr("-77.5"), HasSubstr("differences of F say ")));
}

// Catches a check that looks at the entries of the pattern alone.
TEST(CheckJacobian, FindsAnEntryMissingFromThePattern) {
  Functions functions{.box = Box::nonnegative(2),
                      .pattern = support::matrix({{1, 0}, {0, 1}}),
                      .F =
                          [](In x, Out F) {
                            F[0] = 2 * x[0];
                            F[1] = 3 * x[1] + 0.5 * x[0];
                            return true;
                          },
                      .J =
                          [](In, SpMat& J) {
                            J.coeffRef(0, 0) = 2;
                            J.coeffRef(1, 1) = 3;
                            return true;
                          }};
  const auto mcp = make_mcp(functions);
  const JacobianCheck check = check_jacobian(*mcp, vec({1, 1}));
  EXPECT_TRUE(check.outside_pattern);
  EXPECT_EQ(check.row, 1);
  EXPECT_EQ(check.col, 0);
  EXPECT_EQ(check.given, 0);
  EXPECT_NEAR(check.difference, 0.5, 1e-9);
  EXPECT_THAT(describe(*mcp, check),
              AllOf(HasSubstr("missing from the pattern"), HasSubstr("F[2]"), HasSubstr("x[1]"), HasSubstr("0.5")));
}

/// sqrt(x + shift), not defined below -shift.
Functions root(double shift) {
  return support::scalar(
      0, infinity, [shift](double x) { return std::sqrt(x + shift); },
      [shift](double x) { return 0.5 / std::sqrt(x + shift); });
}

// One side of x is outside the domain: the other serves. At 1e-7 from its end sqrt curves so much within h = 1e-6 that
// the quotient is half the derivative. Catches a right J that is refused near the border of the domain, where starts
// of economic models lie.
TEST(CheckJacobian, UsesOneSideAtTheBorderOfTheDomain) {
  for (const double distance : {1e-3, 1e-6, 9e-7, 1e-7, 1e-8}) {
    const auto mcp = make_mcp(root(distance));
    const JacobianCheck check = check_jacobian(*mcp, vec({0}));
    EXPECT_TRUE(check.defined) << distance;
    EXPECT_EQ(check.columns, 1) << distance;
    EXPECT_LT(check.worst, 1e-4) << distance;
    const auto wrong = make_mcp(with_entry(root(distance), 0, 0, [](double v) { return 1.1 * v; }));
    EXPECT_GT(check_jacobian(*wrong, vec({0})).worst, 0.05) << distance;
  }
}

TEST(CheckJacobian, SaysWhereNothingCanBeCompared) {
  const auto nash = make_mcp(support::nash10());
  EXPECT_FALSE(check_jacobian(*nash, Vec::Zero(10)).defined);   // F' is infinite
  EXPECT_FALSE(check_jacobian(*nash, -Vec::Ones(10)).defined);  // F is not defined
  EXPECT_THAT(describe(*nash, check_jacobian(*nash, -Vec::Ones(10))), HasSubstr("not defined"));
  const auto point = make_mcp(support::scalar(
      -1, 1, [](double x) { return x == 0 ? 0 : nan; }, [](double) { return 1; }));
  EXPECT_FALSE(check_jacobian(*point, vec({0})).defined);
  const auto empty = make_mcp(support::affine({.M = SpMat(0, 0), .q = Vec(0), .box = Box::free(0)}));
  EXPECT_TRUE(check_jacobian(*empty, Vec(0)).defined);
}

// max(0, NaN) is 0. Catches a J that says it is defined, holds a NaN, and passes.
TEST(CheckJacobian, ANaNIsNoDerivative) {
  for (const double bad : {nan, infinity}) {
    Functions functions = support::kojima_shindo();
    functions.J = [bad](In, SpMat& J) {
      Eigen::Map<Vec>(J.valuePtr(), J.nonZeros()).setConstant(bad);
      return true;
    };
    const auto mcp = make_mcp(std::move(functions));
    const JacobianCheck check = check_jacobian(*mcp, Vec::Ones(4));
    EXPECT_FALSE(check.defined) << bad;
    EXPECT_NE(describe(*mcp, check), "") << bad;
  }
}

// Scales of x and F over many orders, with right derivatives. Catches steps that are absolute, or errors that are:
// rounding of F = 1e10 + ..., 1e-16 * 1e10 / 1e-6 = 1, is no fault of J.
TEST(CheckJacobian, DoesNotBlameABadlyScaledJacobian) {
  const auto check = [](double x, auto F, auto J) {
    const auto mcp = make_mcp(support::scalar(-infinity, infinity, F, J));
    return check_jacobian(*mcp, vec({x})).worst;
  };
  EXPECT_LT(check(
                3, [](double x) { return 1e12 * x * x; }, [](double x) { return 2e12 * x; }),
            1e-6);
  EXPECT_LT(check(
                3, [](double x) { return 1e-12 * x * x; }, [](double x) { return 2e-12 * x; }),
            1e-6);
  EXPECT_LT(check(
                1e8, [](double x) { return x * x; }, [](double x) { return 2 * x; }),
            1e-6);
  EXPECT_LT(check(
                1e-8, [](double x) { return x * x; }, [](double x) { return 2 * x; }),
            1e-6);
  EXPECT_LT(check(
                2, [](double x) { return 1e10 + x * x; }, [](double x) { return 2 * x; }),
            1e-4);
  EXPECT_LT(check(
                30, [](double x) { return std::exp(x); }, [](double x) { return std::exp(x); }),
            1e-6);
  EXPECT_LT(check(
                700, [](double x) { return std::exp(x); }, [](double x) { return std::exp(x); }),
            1e-4);
  EXPECT_LT(check(
                1, [](double x) { return std::exp(300 * x); }, [](double x) { return 300 * std::exp(300 * x); }),
            1e-4);
}

// Catches a sample that leaves out the last columns, or compares one twice.
TEST(CheckJacobian, ComparesThatManyColumns) {
  const auto mcp = make_mcp(support::obstacle(10));
  EXPECT_EQ(check_jacobian(*mcp, Vec::Zero(100)).columns, 100);
  EXPECT_EQ(check_jacobian(*mcp, Vec::Zero(100), 1e-6, 7).columns, 7);
  EXPECT_EQ(check_jacobian(*mcp, Vec::Zero(100), 1e-6, 1000).columns, 100);
  const auto wrong = make_mcp(with_entry(support::obstacle(10), 90, 90, [](double) { return 5; }));
  EXPECT_EQ(check_jacobian(*wrong, Vec::Zero(100), 1e-6, 10).col, 90);  // 0, 10, ..., 90
}

// Catches values read or written beyond the matrix.
TEST(CheckJacobian, RefusesAJacobianThatLeavesItsPattern) {
  Functions functions = support::kojima_shindo();
  functions.J = [](In, SpMat& J) {
    J = dense_pattern(6);
    return true;
  };
  EXPECT_THROW(check_jacobian(*make_mcp(functions), Vec::Ones(4)), std::invalid_argument);
  EXPECT_THROW(check_jacobian(*make_mcp(support::kojima_shindo()), Vec::Ones(3)), std::invalid_argument);
}

}  // namespace
}  // namespace perp::ncp
