// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/differences.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using testing::HasSubstr;

/// One variable: J(x) by differences within [lower, upper], and the points at which F was evaluated.
struct OneDifference {
  bool defined = false;
  double J = 0;
  std::vector<double> points{};
};
OneDifference differentiate(const std::function<double(double)>& f, double lower, double upper, double x,
                            const DifferenceFormula& formula = {}) {
  const SpMat pattern = dense_pattern(1);
  ColouredDifferences differences(pattern, formula);
  OneDifference out;
  const auto F = [&](In z, Out value) {
    out.points.push_back(z[0]);
    value[0] = f(z[0]);
    return true;
  };
  out.defined = differences.jacobian(F, {vec({lower}), vec({upper})}, vec({x}), &out.J);
  EXPECT_EQ(differences.F_evals(), static_cast<long>(out.points.size()));
  return out;
}

// Gill, Murray & Wright 1981, section 8.6: the error is of the order sqrt(eps) forward and eps^(2/3) central; x^3 and
// exp by calculus. Catches a step of the wrong length, and a formula of lower order at a bound.
TEST(Differences, HaveTheErrorOfTheirFormula) {
  for (const double x : {0.0, 1.0, -3.0}) {
    const auto f = [](double z) { return std::exp(z) + z * z * z; };
    const double exact = std::exp(x) + 3 * x * x;
    const double scale = 1 + std::abs(x * x * x) + std::abs(6 * x);
    for (const auto& [lower, upper] : {std::pair(-infinity, infinity), {x, infinity}, {-infinity, x}}) {
      EXPECT_NEAR(differentiate(f, lower, upper, x).J, exact, 1e-7 * scale);
      EXPECT_NEAR(differentiate(f, lower, upper, x, {.central = true}).J, exact, 2e-9 * scale) << x << " " << lower;
    }
  }
}

// Forward differences take one evaluation beside F(x), central ones two, and none that is known. Catches costs that the
// statistics would not show.
TEST(Differences, CostWhatTheySay) {
  const auto f = [](double z) { return z * z; };
  EXPECT_EQ(differentiate(f, -infinity, infinity, 1).points.size(), 2U);
  EXPECT_EQ(differentiate(f, -infinity, infinity, 1, {.central = true}).points.size(), 3U);
  int calls = 0;
  const auto mcp = make_mcp({.name = "square", .box = Box::nonnegative(1), .F = [&](In x, Out F) {
                               ++calls;
                               F[0] = x[0] * x[0];
                               return true;
                             }});
  Vec F(1);
  SpMat J = mcp->jacobian_pattern();
  ASSERT_TRUE(mcp->eval(vec({3}), F) && mcp->jacobian(vec({3}), J));
  EXPECT_EQ(calls, 2);
  EXPECT_NEAR(J.coeff(0, 0), 6, 1e-6);
  EXPECT_EQ(mcp->jacobian_work().F_evals, 1);
  ASSERT_TRUE(mcp->jacobian(vec({2}), J));  // another point: F there is not known
  EXPECT_EQ(calls, 4);
}

// Both formulas at both bounds of boxes of many widths. Catches steps out of the box, where F need not be defined, and
// steps to a bound that end beyond it by a rounding.
TEST(Differences, StayInTheBox) {
  for (const double width : {1e-8, 1e-5, 1e-4, 0.1, 10.0})
    for (const bool central : {false, true})
      for (const double share : {0.0, 0.3, 1.0}) {
        const double lower = 0.3, upper = lower + width;
        const double x = share == 1 ? upper : lower + share * width;
        if (width < (central ? 1e-6 : 1e-9)) continue;
        const auto found = differentiate([](double z) { return std::sin(z); }, lower, upper, x, {.central = central});
        ASSERT_TRUE(found.defined);
        EXPECT_NEAR(found.J, std::cos(x), width < 1e-6 ? 1e-6 : 1e-7) << width << " " << central << " " << share;
        for (const double point : found.points) EXPECT_TRUE(point >= lower && point <= upper) << width;
      }
}

// A fixed variable has no room: its step leaves the box. Catches a division by a step of 0.
TEST(Differences, OfFixedVariablesLeaveTheBox) {
  const auto found = differentiate([](double z) { return z * z; }, 2, 2, 2);
  EXPECT_TRUE(found.defined);
  EXPECT_NEAR(found.J, 4, 1e-6);
}

// log is not defined to the left of 0, its mirror image not to the right; free variables give no hint. At 0 itself F is
// not defined. Catches a NaN in J, and an evaluation refused that has a good side.
TEST(Differences, TryTheOtherSideWhereFIsNotDefined) {
  for (const bool central : {false, true}) {
    const auto right =
        differentiate([](double z) { return std::sqrt(1 - z); }, -infinity, infinity, 1 - 1e-9, {.central = central});
    EXPECT_TRUE(right.defined);
    EXPECT_LT(right.J, 0);
    const auto left = differentiate([](double z) { return z < 1 ? std::nan("") : z * z; }, -infinity, infinity, 1,
                                    {.central = central});
    EXPECT_TRUE(left.defined);
    EXPECT_NEAR(left.J, 2, 1e-6);
    EXPECT_FALSE(differentiate([](double z) { return std::log(z); }, 0, infinity, 0).defined);
    EXPECT_FALSE(
        differentiate([](double z) { return z == 1 ? 1 : std::nan(""); }, -infinity, infinity, 1, {.central = central})
            .defined);
  }
}

// Two columns of one group that need different sides, of an F that does not tell which row is undefined. Catches a
// group given up as a whole.
TEST(Differences, TryColumnsOfAGroupByThemselves) {
  SpMat pattern(2, 2);
  pattern.setIdentity();
  ColouredDifferences differences(pattern);
  ASSERT_EQ(differences.colours(), 1);
  const auto F = [](In x, Out value) {
    value = x.cwiseProduct(x);
    return x[0] <= 1 && x[1] >= 1;
  };
  double J[2] = {0, 0};
  ASSERT_TRUE(differences.jacobian(F, {vec({-infinity, -infinity}), vec({infinity, infinity})}, vec({1, 1}), J));
  EXPECT_NEAR(J[0], 2, 1e-6);
  EXPECT_NEAR(J[1], 2, 1e-6);
}

// Values with six digits: noise = 1e-6 makes the step long enough. Catches a noise that is not used: sqrt(eps) would
// divide the sixth digit by 1.5e-8.
TEST(Differences, TakeLongerStepsOfNoisyFunctions) {
  const auto rounded = [](double z) { return std::round(std::exp(z) * 1e6) / 1e6; };
  EXPECT_NEAR(differentiate(rounded, -infinity, infinity, 1, {.noise = 1e-6}).J, std::exp(1.0), 1e-2);
  EXPECT_NEAR(differentiate(rounded, -infinity, infinity, 1, {.central = true, .noise = 1e-6}).J, std::exp(1.0), 1e-3);
}

Functions tridiagonal(Index n) {
  SpMat pattern(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = std::max<Index>(0, j - 1); i <= std::min(n - 1, j + 1); ++i) pattern.insert(i, j) = 1;
  return {.name = "tridiagonal", .box = Box::nonnegative(n), .pattern = pattern, .F = [n](In x, Out F) {
            for (Index i = 0; i < n; ++i)
              F[i] = 2 * x[i] + 0.1 * std::pow(x[i], 3) - 1 - (i > 0 ? x[i - 1] : 0) - (i + 1 < n ? x[i + 1] : 0);
            return true;
          }};
}

// A tridiagonal J has 3 colours whatever n. Catches statistics of another problem, of the check before the solve or of
// one evaluation a column.
TEST(Differences, AreCountedInTheStatistics) {
  const auto mcp = make_mcp(tridiagonal(50));
  const Result result = solve(*mcp, Vec::Zero(50), path());
  ASSERT_TRUE(result.solved()) << result.message;
  EXPECT_EQ(result.stats.J_colours, 3);
  EXPECT_GE(result.stats.J_F_evals, 3 * (result.stats.J_evals - 1));
  EXPECT_LE(result.stats.J_F_evals, 4 * result.stats.J_evals);
  EXPECT_EQ(solve(*make_mcp(support::kojima_shindo()), Vec::Ones(4), path()).stats.J_colours, 0);
}

// Differences agree with differences, unless the pattern lacks an entry. Catches a check that says nothing where J is
// by differences, or blames a J that nobody wrote.
TEST(Differences, AreCheckedAsDerivativesAre) {
  const auto good = make_mcp(tridiagonal(10));
  EXPECT_EQ(describe(*good, check_jacobian(*good, Vec::Ones(10))), "");
  Functions functions = tridiagonal(10);
  functions.pattern = SpMat(10, 10);
  functions.pattern.setIdentity();
  const auto bad = make_mcp(functions);
  const JacobianCheck check = check_jacobian(*bad, Vec::Ones(10));
  EXPECT_TRUE(check.worst > 0.1);
  EXPECT_THAT(describe(*bad, check), HasSubstr("taken by differences"));
}

}  // namespace
}  // namespace perp::ncp
