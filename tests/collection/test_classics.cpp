// SPDX-License-Identifier: Apache-2.0
// Further problems of the literature and small LCPs: published solutions, and the phenomenon each is there for.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "collection/collection.hpp"
#include "lcp/dense_factors.hpp"
#include "model_checks.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp::collection {
namespace {

// As printed by Murphy, Sherali & Soyster 1982 (and by Harker 1984); F at q = 5, where (q / 5)^(1 / beta) = 1 and Q
// = 25.
TEST(Classics, Nash5) {
  const Problem problem = find("nash5")->make();
  const double printed[] = {36.9325, 41.8181, 43.7066, 42.6592, 39.1790};
  for (Index i = 0; i < 5; ++i) EXPECT_NEAR(problem.solutions.at(0).x[i], printed[i], 1e-4);
  const double price = std::pow(200, 1 / 1.1);
  const Vec F = test::values(*problem.mcp, Vec::Constant(5, 5));
  for (Index i = 0; i < 5; ++i) EXPECT_NEAR(F[i], 11 - 2 * static_cast<double>(i) - price * (1 - 0.2 / 1.1), 1e-11);
  Vec value(5);
  EXPECT_FALSE(problem.mcp->eval(Vec::Zero(5), value));
  EXPECT_FALSE(problem.mcp->eval(Vec({{1, 1, -1e-9, 1, 1}}), value));
}

// Prices scale. Catches: parameters of another of the three economies.
TEST(Classics, MathiesensFurtherEconomies) {
  for (const double s : {0.01, 1.0, 300.0}) {
    EXPECT_LT(residual(*find("mathiesen-2-own")->make().mcp, Vec({{0.5, 3 * s, s, 2 * s}})).natural, 1e-13);
    EXPECT_LT(residual(*find("mathiesen-3-own")->make().mcp, Vec({{0.75, s, s, 0}})).natural, 1e-13);
  }
  EXPECT_EQ(test::values(*find("mathiesen-2-own")->make().mcp, Vec::Ones(4)), Vec({{1, -0.125, -0.375, -0.5}}));
  EXPECT_EQ(test::values(*find("mathiesen-3-own")->make().mcp, Vec::Ones(4)), Vec({{1, -1.25, -0.75, 1}}));
}

// Newton's steps on min(z, M z + q): z_i = 0 outside of the set, F_i = 0 in it, the next set where z_i > F_i. Catches:
// a matrix on which they end.
TEST(Classics, NewtonStepsCycle) {
  const Problem problem = find("cyclic3-own")->make();
  SpMat J = problem.mcp->jacobian_pattern();
  ASSERT_TRUE(problem.mcp->jacobian(Vec::Zero(3), J));
  const Eigen::Matrix3d M = J;
  using Set = std::array<bool, 3>;
  const std::array<Set, 4> expected{
      {{true, false, true}, {false, true, true}, {true, true, false}, {true, false, true}}};
  Set set = expected[0];
  for (std::size_t step = 1; step < 4; ++step) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 3; ++i)
      if (set[i]) {
        A.row(static_cast<Index>(i)) = M.row(static_cast<Index>(i));
        b[static_cast<Index>(i)] = 1;
      }
    const Vec z = A.inverse() * b;
    const Vec F = test::values(*problem.mcp, z);
    for (std::size_t i = 0; i < 3; ++i) set[i] = z[static_cast<Index>(i)] > F[static_cast<Index>(i)];
    EXPECT_EQ(set, expected[step]);
  }
}

TEST(Classics, EveryVertexOfTheCube) {
  const Problem problem = find("cube-vertices-own")->make();
  EXPECT_EQ(problem.solutions.size(), 16u);
  EXPECT_GT(residual(*problem.mcp, Vec({{1, 0, 0.5, 1}})).natural, 0.4);
}

TEST(Classics, EveryPointOfTheSimplex) {
  const Problem problem = find("simplex-own")->make();
  EXPECT_LT(residual(*problem.mcp, Vec({{0.5, 0, 0.25, 0.25, 0}})).natural, 1e-15);
  EXPECT_GT(residual(*problem.mcp, Vec({{0.5, 0, 0.25, 0.2, 0}})).natural, 0.04);
}

// Feasible, and yet every residual is at least 1/2. Catches: a data set with a certificate of infeasibility.
TEST(Classics, FeasibleWithoutSolution) {
  const Problem problem = find("feasible-unsolvable-own")->make();
  EXPECT_GE(test::values(*problem.mcp, Vec({{0, 1}})).minCoeff(), 0);
  for (const double a : {0.0, 0.3, 2.0})
    for (const double b : {0.0, 0.25, 0.5, 0.75, 1.0, 3.0})
      EXPECT_GE(residual(*problem.mcp, Vec({{a, b}})).natural, 0.5) << a << ' ' << b;
}

// Catches: an n at which the matrix is well conditioned.
TEST(Classics, HilbertIsIllConditioned) {
  SpMat J = find("hilbert-own")->make().mcp->jacobian_pattern();
  ASSERT_TRUE(find("hilbert-own")->make().mcp->jacobian(Vec::Zero(8), J));
  const Eigen::VectorXd values = Eigen::MatrixXd(J).selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(values.minCoeff(), 0);
  EXPECT_GT(values.maxCoeff() / values.minCoeff(), 1e10);
}

}  // namespace
}  // namespace perp::ncp::collection
