// SPDX-License-Identifier: Apache-2.0
// Problems of any size: planted solutions for many sizes and seeds, arguments, reproducibility.
#include "collection/scalable/generators.hpp"

#include <gmock/gmock.h>

#include "collection/base/random.hpp"
#include "ncp/problem/residual.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;
using ::testing::HasSubstr;

void expect_planted(const Problem& problem, Index size) {
  ASSERT_EQ(problem.mcp->size(), size);
  ASSERT_EQ(problem.solutions.size(), 1u);
  EXPECT_LT(residual(*problem.mcp, problem.solutions[0].x).natural, 1e-11);
  const JacobianCheck check = check_jacobian(*problem.mcp, problem.starts.back(), 1e-6, 50);
  EXPECT_TRUE(check.defined);
  EXPECT_FALSE(check.outside_pattern);
  EXPECT_LT(check.worst, 1e-5) << describe(*problem.mcp, check, 0);
}

// Catches: an equilibrium that is none for shapes or seeds other than the default's.
TEST(Generators, PlantSolutionsForAllShapesAndSeeds) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    expect_planted(nash_own(10 + seed, seed), 10 + seed);
    expect_planted(bimatrix_own(1 + seed, 21 - seed, seed), 22);
    expect_planted(walras_own(4 + seed, 1 + seed, 1 + 2 * seed, seed), 6 + 4 * seed);
    expect_planted(walras_own(30, 5, 1 + seed, seed), 36 + seed);
  }
  expect_planted(walras_own(1200, 900, 900, 7), 3000);
}

TEST(Generators, CoverTheSmallestLcps) {
  for (Index n : {1, 2, 3, 40})
    for (const auto make : {murty, murty_lower, fathi, ahn, geiger_kanzow}) expect_planted(make(n), n);
}

// Households spend what they have on goods that exist: p'F_p + h'... Walras' law: along F_h = 0 and any y,
// sum_g p_g F_p(g) + sum_s y_s F_y(s) = 0. Catches: shares that do not sum to 1.
TEST(Generators, WalrasLawHolds) {
  const Index goods = 40, sectors = 30, households = 30;
  const Problem problem = walras_own(goods, sectors, households, 3);
  Random random(11);
  Vec z(100), F(100);
  for (double& value : z) value = random.uniform(0.5, 2);
  ASSERT_TRUE(problem.mcp->eval(z, F));
  z.tail(households) -= F.tail(households);  // F_h = h - e'p: now h = e'p
  ASSERT_TRUE(problem.mcp->eval(z, F));
  EXPECT_LT(F.tail(households).lpNorm<Eigen::Infinity>(), 1e-14);
  EXPECT_GT(F.segment(sectors, goods).lpNorm<Eigen::Infinity>(), 0.1);
  EXPECT_NEAR(z.segment(sectors, goods).dot(F.segment(sectors, goods)) + z.head(sectors).dot(F.head(sectors)), 0,
              1e-11);
}

// Catches: a "sparse" economy that fills up with its size.
TEST(Generators, WalrasStaysSparse) {
  const Problem problem = walras_own(1200, 900, 900, 1);
  EXPECT_LT(problem.mcp->jacobian_pattern().nonZeros(), 10 * 3000);
}

// Catches: data that differ between platforms, standard libraries or versions. mt19937_64's 10000th number is fixed by
// the C++ standard; the mapping to doubles is ours.
TEST(Generators, RandomNumbersAreReproducible) {
  Random random(5489);  // the engine's default seed
  for (int k = 1; k < 10000; ++k) (void)random.uniform(0, 1);
  EXPECT_DOUBLE_EQ(random.uniform(0, 1), std::ldexp(9981545732273789042., -64));
  const std::vector<Index> order = Random(1).order(50);
  std::vector<Index> sorted = order;
  std::ranges::sort(sorted);
  for (Index i = 0; i < 50; ++i) EXPECT_EQ(sorted[static_cast<std::size_t>(i)], i);
  EXPECT_NE(order, sorted);
  EXPECT_EQ(nash_own(20, 5).solutions[0].x, nash_own(20, 5).solutions[0].x);
  EXPECT_NE(nash_own(20, 5).solutions[0].x, nash_own(20, 6).solutions[0].x);
}

template <class Make>
void expect_refused(Make make, const std::string& words) {
  try {
    make();
    FAIL() << "accepted: " << words;
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

// Catches: sizes without a problem running into an assertion of Eigen or an endless loop.
TEST(Generators, RefuseSizesWithoutAProblem) {
  expect_refused([] { nash_own(9, 1); }, "nash-own: firms is 9; it must be at least 10");
  expect_refused([] { bimatrix_own(0, 3, 1); }, "bimatrix-own: m is 0");
  expect_refused([] { bimatrix_own(3, -1, 1); }, "bimatrix-own: n is -1");
  expect_refused([] { walras_own(3, 1, 1, 1); }, "walras-own: goods is 3");
  expect_refused([] { walras_own(5, 0, 1, 1); }, "walras-own: sectors is 0");
  expect_refused([] { walras_own(5, 5, 1, 1); }, "walras-own: goods - sectors is 0");
  expect_refused([] { walras_own(5, 1, 0, 1); }, "walras-own: households is 0");
  expect_refused([] { murty(0); }, "murty: n is 0");
  expect_refused([] { murty_lower(0); }, "murty-lower: n is 0");
  expect_refused([] { fathi(-2); }, "fathi: n is -2");
  expect_refused([] { ahn(0); }, "ahn: n is 0");
  expect_refused([] { geiger_kanzow(0); }, "geiger-kanzow: n is 0");
}

}  // namespace
