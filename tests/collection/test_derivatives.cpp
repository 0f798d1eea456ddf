// SPDX-License-Identifier: Apache-2.0
// J against central differences, at every start, near it and near every solution.
#include <gtest/gtest.h>

#include <random>

#include "collection/base/dual.hpp"
#include "each_entry.hpp"

namespace perp::ncp::collection {
namespace {

void expect_jacobian(const Mcp& mcp, const Vec& x) {
  const JacobianCheck check = check_jacobian(mcp, x, 1e-6, 200);
  EXPECT_TRUE(check.defined) << x.transpose();
  EXPECT_FALSE(check.outside_pattern) << describe(mcp, check);
  EXPECT_LT(check.worst, 2e-6) << describe(mcp, check, 0) << "\nat " << x.transpose();
}

class EachJacobian : public EachEntry {};
INSTANTIATE_TEST_SUITE_P(Collection, EachJacobian, each_name(), test_name);

// Catches: a wrong derivative by hand, an entry missing from the pattern, a wrong chunk of forward differentiation.
TEST_P(EachJacobian, AgreesWithDifferencesAtStarts) {
  const Problem problem = entry.make();
  for (const Vec& start : problem.starts) expect_jacobian(*problem.mcp, start);
}

// Catches: what the special values of the starts (0, 1, equal components) hide.
TEST_P(EachJacobian, AgreesWithDifferencesAtRandomPoints) {
  const Problem problem = entry.make();
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(0.01, 0.1);
  std::vector<Vec> centres = problem.starts;
  for (const KnownSolution& solution : problem.solutions) centres.push_back(solution.x);
  for (Vec x : centres) {
    for (Index i = 0; i < x.size(); ++i) {
      const double upper = problem.mcp->box().upper[i];
      const double moved = x[i] + uniform(engine) * (0.1 + std::abs(x[i]));  // upwards: q = 0 leaves its kink
      x[i] = moved > upper && x[i] < upper ? 0.5 * (x[i] + upper) : moved;   // no further: poles behind bounds
    }
    expect_jacobian(*problem.mcp, x);
  }
}

// d/dx at x = 2 of each operation against calculus. Catches: an operator with a wrong rule, in particular those with a
// number on one side.
TEST(Dual, FollowsTheRulesOfCalculus) {
  Dual x(2);
  x.d[3] = 1;
  const auto expect = [](const Dual& result, double value, double slope) {
    EXPECT_DOUBLE_EQ(result.v, value);
    EXPECT_DOUBLE_EQ(result.d[3], slope);
    EXPECT_EQ(result.d[2], 0);
  };
  expect(x + x, 4, 2);
  expect(x + 1, 3, 1);
  expect(1 + x, 3, 1);
  expect(x - x * x, -2, -3);
  expect(x - 1, 1, 1);
  expect(1 - x, -1, -1);
  expect(-x, -2, -1);
  expect(x * x * x, 8, 12);
  expect(3 * x, 6, 3);
  expect(x * 3, 6, 3);
  expect(x / 4, 0.5, 0.25);
  expect(1 / x, 0.5, -0.25);
  expect((x + 1) / (x * x), 0.75, -0.5);
  expect(exp(x), std::exp(2), std::exp(2));
  Dual y = x;
  y += x * x;
  y -= 1;
  y *= x;  // x^2 + x^3 - x
  expect(y, 10, 15);
  y *= y;
  expect(y, 100, 300);
}

}  // namespace
}  // namespace perp::ncp::collection
