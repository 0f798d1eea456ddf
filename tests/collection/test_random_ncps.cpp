// SPDX-License-Identifier: Apache-2.0
// Random NCPs: the class each function promises, the planted solution, the same numbers everywhere.
#include "collection/random/random_ncps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp::collection {
namespace {

struct NcpFamily {
  std::string name;
  Problem (*make)(Index, unsigned);
  Index least;
  bool monotone;
};

const std::vector<NcpFamily>& ncp_families() {
  static const std::vector<NcpFamily> all{
      {"monotone", random_monotone_ncp_own, 2, true},     {"P0", random_p0_ncp_own, 4, false},
      {"degenerate", random_degenerate_ncp_own, 2, true}, {"ill-conditioned", random_ill_conditioned_ncp_own, 2, true},
      {"boxed", random_boxed_ncp_own, 2, true},           {"exponential", random_exponential_ncp_own, 2, true}};
  return all;
}

Vec random_point(Index n, unsigned seed, double low, double high) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(low, high);
  Vec x(n);
  for (double& value : x) value = uniform(engine);
  return x;
}

bool defined(const Problem& problem, const Vec& x) {
  Vec F(x.size());
  return problem.mcp->eval(x, F);
}

Eigen::MatrixXd jacobian(const Mcp& mcp, const Vec& x) {
  SpMat J = mcp.jacobian_pattern();
  EXPECT_TRUE(mcp.jacobian(x, J));
  return J;
}

// The smallest eigenvalue of J + J' where x is sampled. Catches: a family that is not strictly monotone.
TEST(RandomNcps, MonotoneOnesAreStrictlyMonotone) {
  for (const NcpFamily& family : ncp_families())
    for (unsigned seed = 1; family.monotone && seed <= 8; ++seed) {
      const Problem problem = family.make(family.least + 7, seed);
      const Eigen::MatrixXd J = jacobian(*problem.mcp, random_point(problem.mcp->size(), seed, -2, 2));
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(J + J.transpose());
      EXPECT_GT(eigen.eigenvalues()[0], 0) << family.name << ' ' << seed;
    }
}

// All principal minors of J at n = 6, and a direction of negative curvature. Catches: a P0 family that is monotone, or
// not P0.
TEST(RandomNcps, P0OnesAreP0AndNotMonotone) {
  constexpr Index n = 6;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Problem problem = random_p0_ncp_own(n, seed);
    const Eigen::MatrixXd J = jacobian(*problem.mcp, random_point(n, seed, 0, 2));
    for (unsigned set = 1; set < 1U << n; ++set) {
      std::vector<Index> rows;
      for (Index i = 0; i < n; ++i)
        if ((set >> i & 1U) != 0) rows.push_back(i);
      const Eigen::MatrixXd principal = J(rows, rows);
      EXPECT_GE(principal.determinant(), -1e-10 * std::pow(J.norm(), static_cast<double>(rows.size()))) << seed;
    }
    const Eigen::MatrixXd at0 = jacobian(*problem.mcp, Vec::Zero(n));
    Vec v = Vec::Zero(n);
    v.head(2) << -1, 2;
    EXPECT_NEAR(v.dot(at0 * v), -7, 1e-12);
  }
}

// Catches: a planted point that is no solution, matrices that fill up, starts where F is not defined.
TEST(RandomNcps, PlantedSolutions) {
  for (const NcpFamily& family : ncp_families())
    for (const Index n : {family.least, Index{7}, Index{60}, Index{5000}}) {
      const Problem problem = family.make(n, 3);
      EXPECT_EQ(problem.mcp->size(), n);
      const Vec& x = problem.solutions.at(0).x;
      EXPECT_LE(residual(*problem.mcp, x).natural, family.name == "exponential" ? 1e-10 : 1e-12) << family.name << n;
      EXPECT_LE(problem.mcp->jacobian_pattern().nonZeros(), 14 * n + 10) << family.name;
      for (const Vec& start : problem.starts) EXPECT_TRUE(defined(problem, start)) << family.name;
    }
}

// Catches: flags of linear entries that stand for curved ones.
TEST(RandomNcps, LinearEntriesAreConstant) {
  for (const NcpFamily& family : ncp_families()) {
    const Problem problem = family.make(20, 2);
    const std::vector<bool> linear = problem.mcp->linear_entries();
    SpMat one = problem.mcp->jacobian_pattern(), two = one;
    ASSERT_TRUE(problem.mcp->jacobian(random_point(20, 1, 0, 1), one));
    ASSERT_TRUE(problem.mcp->jacobian(random_point(20, 2, 0, 1), two));
    ASSERT_EQ(static_cast<Index>(linear.size()), one.nonZeros());
    for (Index k = 0; k < one.nonZeros(); ++k)
      EXPECT_EQ(one.valuePtr()[k] == two.valuePtr()[k], linear[static_cast<std::size_t>(k)]) << family.name << ' ' << k;
  }
}

// x = F = 0 at about half of the indices. Catches: a "degenerate" family that is not.
TEST(RandomNcps, DegenerateIsDegenerate) {
  const Problem problem = random_degenerate_ncp_own(1000, 1);
  const Vec& x = problem.solutions.at(0).x;
  Vec F(1000);
  ASSERT_TRUE(problem.mcp->eval(x, F));
  Index both = 0;
  for (Index i = 0; i < 1000; ++i) both += x[i] == 0 && std::abs(F[i]) < 1e-13;
  EXPECT_GT(both, 400);
  EXPECT_LT(both, 600);
}

// Every kind of bound is there and, at the solution, active somewhere and inactive elsewhere. Catches: a box without a
// part that it promises.
TEST(RandomNcps, BoxedHasEveryKindOfBound) {
  const Problem problem = random_boxed_ncp_own(200, 1);
  const Box& box = problem.mcp->box();
  const Vec& x = problem.solutions.at(0).x;
  int free = 0, fixed = 0, both = 0, at_lower = 0, at_upper = 0, inside = 0;
  for (Index i = 0; i < 200; ++i) {
    free += box.lower[i] == -infinity && box.upper[i] == infinity;
    fixed += box.lower[i] == box.upper[i];
    both += box.lower[i] > -infinity && box.upper[i] < infinity;
    at_lower += x[i] == box.lower[i] && x[i] < box.upper[i];
    at_upper += x[i] == box.upper[i] && x[i] > box.lower[i];
    inside += x[i] > box.lower[i] && x[i] < box.upper[i];
  }
  for (const int count : {free, fixed, both, at_lower, at_upper, inside}) EXPECT_GE(count, 20);
}

// Entries over eight orders of magnitude. Catches: scales that are not what they say.
TEST(RandomNcps, IllConditionedIsIllConditioned) {
  const Problem problem = random_ill_conditioned_ncp_own(50, 1);
  const Vec diagonal = jacobian(*problem.mcp, Vec::Zero(50)).diagonal();
  EXPECT_GT(diagonal.maxCoeff() / diagonal.minCoeff(), 1e7);
  const Vec& x = problem.solutions.at(0).x;
  EXPECT_GT(x.maxCoeff(), 10);
}

// exp overflows. Catches: an infinity handed to the method as a value.
TEST(RandomNcps, ExponentialIsNotDefinedFarAway) {
  const Problem problem = random_exponential_ncp_own(50, 1);
  EXPECT_FALSE(defined(problem, Vec::Constant(50, 150)));
  SpMat J = problem.mcp->jacobian_pattern();
  EXPECT_FALSE(problem.mcp->jacobian(Vec::Constant(50, 150), J));
  EXPECT_TRUE(defined(problem, Vec::Constant(50, 100)));
}

// Catches: other numbers on another platform or version.
TEST(RandomNcps, AreReproducible) {
  for (const NcpFamily& family : ncp_families()) {
    const Problem one = family.make(30, 5), two = family.make(30, 5), other = family.make(30, 6);
    Vec F1(30), F2(30), F3(30);
    one.mcp->eval(Vec::Ones(30), F1);
    two.mcp->eval(Vec::Ones(30), F2);
    other.mcp->eval(Vec::Ones(30), F3);
    EXPECT_EQ(F1, F2) << family.name;
    EXPECT_NE(F1, F3) << family.name;
    EXPECT_EQ(one.solutions[0].x, two.solutions[0].x) << family.name;
  }
}

TEST(RandomNcps, RefuseSizesWithoutAProblem) {
  for (const NcpFamily& family : ncp_families())
    EXPECT_THROW(family.make(family.least - 1, 1), std::invalid_argument) << family.name;
}

}  // namespace
}  // namespace perp::ncp::collection
