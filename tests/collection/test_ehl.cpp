// SPDX-License-Identifier: Apache-2.0
// Elastohydrodynamic lubrication: F against its formula as printed, what physics says of the solution.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "collection/scalable/generators.hpp"
#include "model_checks.hpp"
#include "ncp/strategy/solve.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;

/// The formula term by term, with p[0] = p[N + 1] = 0 and h by its own sum.
Vec as_printed(Index N, const Vec& z) {
  const double dx = 5.0 / static_cast<double>(N), alpha = 2.832, lambda = 6.057, pi = std::numbers::pi;
  Vec p = Vec::Zero(N + 2);
  p.segment(1, N) = z.tail(N);
  const auto w = [&](Index i) { return i == 0 || i == N ? 0.5 : 1.0; };
  const auto h = [&](Index j) {
    const double y = -3 + (static_cast<double>(j) + 0.5) * dx;
    double sum = 0;
    for (Index i = 0; i <= N; ++i) {
      const double d = static_cast<double>(i) - static_cast<double>(j) - 0.5;
      sum += w(i) * d * dx * std::log(std::abs(d) * dx) * ((i < N ? p[i + 1] : 0) - (i > 1 ? p[i - 1] : 0));
    }
    return y * y + z[0] + 1 + sum / pi;
  };
  Vec F(N + 1);
  F[0] = 1;
  for (Index i = 1; i <= N; ++i) F[0] -= 2 * dx / pi * w(i) * p[i];
  for (Index i = 1; i <= N; ++i)
    F[i] = lambda / dx * (h(i) - h(i - 1)) -
           1 / (dx * dx) *
               (std::pow(h(i), 3) * (p[i + 1] - p[i]) / std::exp(alpha * (p[i + 1] + p[i]) / 2) -
                std::pow(h(i - 1), 3) * (p[i] - p[i - 1]) / std::exp(alpha * (p[i] + p[i - 1]) / 2));
  return F;
}

// Catches: an index of the kernel shifted by one, an end weight, a sign, lost in the matrix form of the gap.
TEST(Ehl, AgreesWithTheFormulaAsPrinted) {
  std::mt19937 engine(5);
  for (const Index N : {3, 4, 7, 20}) {
    const Problem problem = ehl_kost(N);
    for (const Vec& z : {problem.starts[0], problem.starts[1], test::random_point(N + 1, engine, 0, 1)}) {
      const Vec expected = as_printed(N, z);
      EXPECT_LT((test::values(*problem.mcp, z) - expected).lpNorm<Eigen::Infinity>(), 1e-12 * (1 + expected.norm()))
          << N;
    }
  }
  EXPECT_EQ(ehl_kost(20).starts[0][12], 1 - std::abs(-3 + 1 + 12 * 0.25) / 2);
}

// The pressures carry the load, are positive on one stretch that begins at the inlet and ends before the outlet (a free
// boundary, where the film cavitates), near the dry contact's ellipse in the middle; k converges with the grid.
// Catches: another root, or a formula that solves and means nothing.
TEST(Ehl, SolutionCarriesTheLoadOnOneStretch) {
  double coarse = 0;
  for (const Index N : {50, 100}) {
    const Problem problem = ehl_kost(N);
    const Result result = solve(*problem.mcp, problem.starts[0], path());
    ASSERT_TRUE(result.solved()) << result.message;
    const Vec p = result.x.tail(N);
    const double dx = 5.0 / static_cast<double>(N);
    EXPECT_NEAR(dx * (p.sum() - p[N - 1] / 2), std::numbers::pi / 2, 1e-7);
    Index edges = 0;
    for (Index i = 1; i < N; ++i) edges += (p[i] > 1e-9) != (p[i - 1] > 1e-9);
    EXPECT_EQ(edges, 1);
    EXPECT_GT(p[0], 1e-9);
    EXPECT_LE(p[N - 1], 1e-9);
    EXPECT_NEAR(p[3 * N / 5 - 1], 1, 0.15);  // x = 0
    if (coarse != 0) {
      EXPECT_NEAR(result.x[0], coarse, 0.1);
    }
    coarse = result.x[0];
  }
}

TEST(Ehl, RefusesSizesWithoutAProblem) {
  EXPECT_THROW(ehl_kost(2), std::invalid_argument);
  EXPECT_THROW(ehl_kost(10'001), std::invalid_argument);
}

}  // namespace
