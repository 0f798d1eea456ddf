// SPDX-License-Identifier: Apache-2.0
// Equilibria on networks: values by hand, laws of conservation, monotony, what is unique and what is not.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "collection/collection.hpp"
#include "collection/scalable/generators.hpp"
#include "model_checks.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;

/// By name: nothing here relies on an order of unknowns.
std::map<std::string, double> named(const Mcp& mcp, const Vec& values) {
  std::map<std::string, double> found;
  for (Index i = 0; i < values.size(); ++i) found[mcp.variable_name(i)] = values[i];
  return found;
}

// With p = p0 and all else 0 every row is its constant. Catches: a cost in another's place.
TEST(Pies, CostsAndDemandsWhereNothingIsMade) {
  const Problem problem = find("pies")->make();
  auto F = named(*problem.mcp, test::values(*problem.mcp, problem.starts[1]));
  EXPECT_EQ(F["c[1,3]"], 8);
  EXPECT_EQ(F["c[2,1]"], 4);
  EXPECT_EQ(F["o[2,1]"], 1.25);
  EXPECT_EQ(F["ct[2,1]"], 0.75 - 12);
  EXPECT_EQ(F["ot[1,2]"], 3 + 5);
  EXPECT_EQ(F["ot[2,1]"], 4 + 6.5);
  EXPECT_EQ(F["lt[2,2]"], 1.5 - 16);
  EXPECT_EQ(F["ht[1,2]"], 1.2 - 12);
  EXPECT_EQ(F["p[L,2]"], -1200);
  EXPECT_EQ(F["p[H,1]"], -1000);
  EXPECT_EQ(F["lv[2]"], 0);
  EXPECT_EQ(F["mu[capital]"], 35000);
  EXPECT_EQ(F["mu[steel]"], 12000);
}

// All unknowns 1, but p = 2 p0: demands q0 2^(sum of the row of esub). Catches: uses, yields and signs.
TEST(Pies, CoefficientsAtOnes) {
  const Problem problem = find("pies")->make();
  Vec z = Vec::Ones(42);
  for (Index i = 0; i < 42; ++i)
    if (problem.mcp->variable_name(i)[0] == 'p') z[i] = 2 * problem.starts[1][i];
  auto F = named(*problem.mcp, test::values(*problem.mcp, z));
  EXPECT_DOUBLE_EQ(F["c[1,3]"], 8 + 10 + 3 - 1);
  EXPECT_DOUBLE_EQ(F["c[2,2]"], 5 + 5 + 4 - 1);
  EXPECT_DOUBLE_EQ(F["o[1,1]"], 1 - 1);
  EXPECT_DOUBLE_EQ(F["o[2,2]"], 1.5 + 15 + 2 - 1);
  EXPECT_DOUBLE_EQ(F["ct[1,2]"], 2.5 + 1 - 24);
  EXPECT_DOUBLE_EQ(F["ot[2,2]"], 2 + 5 + 1 - 1);
  EXPECT_DOUBLE_EQ(F["ht[2,2]"], 1.5 + 1 - 24);
  EXPECT_DOUBLE_EQ(F["p[C,1]"], 2 - 1000 * std::pow(2, -0.45));
  EXPECT_DOUBLE_EQ(F["p[L,1]"], 2 - 1200 * std::pow(2, -0.2));
  EXPECT_DOUBLE_EQ(F["cv[2]"], 3 - 2);
  EXPECT_DOUBLE_EQ(F["ov[1]"], 2 - 2);
  EXPECT_NEAR(F["lv[1]"], 2 * 0.6 - 2, 1e-15);
  EXPECT_NEAR(F["hv[1]"], 2 * 0.4 - 2, 1e-15);
  EXPECT_DOUBLE_EQ(F["mu[capital]"], 35000 - (1 + 5 + 10 + 1 + 5 + 6) - (10 + 15));
  EXPECT_DOUBLE_EQ(F["mu[steel]"], 12000 - (1 + 2 + 3 + 1 + 4 + 5) - (4 + 2));
}

// The recorded start is the equilibrium in few digits (its idle mine apart). Catches: a solution of another model.
TEST(Pies, EquilibriumIsNearTheRecordedStart) {
  const Problem problem = find("pies")->make();
  auto start = named(*problem.mcp, problem.starts[0]);
  for (const auto& [name, value] : named(*problem.mcp, problem.solutions.at(0).x)) {
    const bool shipment = name[1] == 't';
    const bool price = name[0] == 'p';
    EXPECT_NEAR(value, start[name], shipment ? 1 : price ? 0.03 : infinity) << name;
  }
  Vec z = problem.starts[0];
  for (Index i = 0; i < 42; ++i)
    if (problem.mcp->variable_name(i) == "p[C,1]") z[i] = 0;
  Vec F(42);
  EXPECT_FALSE(problem.mcp->eval(z, F));  // 0^-0.75
}

// Catches: shapes, a last row of the grid left incomplete, seeds for which the planted point is none.
TEST(SpatialPrice, PlantsSolutionsForAllShapesAndSeeds) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const Index regions : {2, 3, 4, 5, 12, 50}) {
      const Problem problem = spatial_price_own(regions, seed);
      EXPECT_LT(residual(*problem.mcp, problem.solutions.at(0).x).natural, 1e-12) << regions << ' ' << seed;
      const JacobianCheck check = check_jacobian(*problem.mcp, problem.starts[0]);
      EXPECT_FALSE(check.outside_pattern);
      EXPECT_LT(check.worst, 1e-6) << describe(*problem.mcp, check, 0);
    }
  EXPECT_LT(residual(*spatial_price_own(20'000, 3).mcp, spatial_price_own(20'000, 3).solutions[0].x).natural, 1e-12);
}

// What leaves a region arrives in another: the sum of the markets does not depend on the shipments. Catches: an arc
// that loses or makes goods.
TEST(SpatialPrice, ShipmentsAreConserved) {
  constexpr Index regions = 30;
  const Problem problem = spatial_price_own(regions, 2);
  const Index arcs = problem.mcp->size() - regions;
  std::mt19937 engine(1);
  Vec z = test::random_point(problem.mcp->size(), engine, 0, 5);
  const double before = test::values(*problem.mcp, z).tail(regions).sum();
  z.head(arcs) = test::random_point(arcs, engine, 0, 5);
  EXPECT_NEAR(test::values(*problem.mcp, z).tail(regions).sum(), before, 1e-10);
}

// Catches: a transport of goods and prices that is not skew; costs or demands that fall; a problem where everything or
// nothing is shipped, or without degeneracy.
TEST(SpatialPrice, IsMonotoneAndDegenerate) {
  const Problem problem = spatial_price_own(100, 4);
  test::expect_monotone(*problem.mcp, 20, 1e-12);
  test::expect_constant_entries(*problem.mcp);
  const Index arcs = problem.mcp->size() - 100;
  const Vec x = problem.solutions[0].x.head(arcs), F = test::values(*problem.mcp, problem.solutions[0].x).head(arcs);
  const Index used = (x.array() > 0).count();
  const Index degenerate = (x.array() == 0 && F.array().abs() < 1e-12).count();
  EXPECT_GT(used, arcs / 5);
  EXPECT_LT(used, arcs / 2);
  EXPECT_GT(degenerate, arcs / 50);
  EXPECT_LT(degenerate, arcs / 8);
}

TEST(Traffic, PlantsSolutionsForAllShapesAndSeeds) {
  for (unsigned seed = 0; seed < 8; ++seed)
    for (const auto& [M, N] : {std::pair<Index, Index>{2, 2}, {2, 7}, {5, 3}, {9, 9}}) {
      const Problem problem = traffic_own(M, N, seed);
      const Index arcs = 2 * (M * (N - 1) + N * (M - 1));
      ASSERT_EQ(problem.mcp->size(), 4 * (arcs + M * N - 1));
      EXPECT_LT(residual(*problem.mcp, problem.solutions.at(0).x).natural, 1e-12) << M << 'x' << N << ' ' << seed;
      const JacobianCheck check = check_jacobian(*problem.mcp, problem.starts[0], 1e-6, 100);
      EXPECT_FALSE(check.outside_pattern);
      EXPECT_LT(check.worst, 1e-6) << describe(*problem.mcp, check, 0);
    }
}

// Planted point and first start carry every trip to its destination: the balances vanish. And they carry something.
// Catches: trips lost at a node, potentials that are no times.
TEST(Traffic, FlowIsConserved) {
  const Problem problem = traffic_own(7, 6, 3);
  const Index flows = problem.mcp->size() - 4 * 41;
  for (const Vec& z : {problem.starts[0], problem.solutions[0].x}) {
    EXPECT_LT(test::values(*problem.mcp, z).tail(4 * 41).lpNorm<Eigen::Infinity>(), 1e-13);
    EXPECT_GT(z.head(flows).maxCoeff(), 1);
    EXPECT_GE(z.minCoeff(), 0);
  }
  // Each destination's balances add up to what reaches it less its trips, whatever the flows: only arcs at the
  // destination count.
  std::mt19937 engine(2);
  Vec z = test::random_point(problem.mcp->size(), engine, 0, 1);
  const double before = test::values(*problem.mcp, z).segment(flows, 41).sum();
  for (Index i = 0; i < flows; i += 4) {  // destination 1's flows not at its node
    const std::string name = problem.mcp->variable_name(i);
    Vec moved = z;
    moved[i] += 1;
    const double change = test::values(*problem.mcp, moved).segment(flows, 41).sum() - before;
    EXPECT_TRUE(std::abs(change) < 1e-12 || std::abs(std::abs(change) - 1) < 1e-12) << name;
  }
}

// Catches: balances and detours whose couplings are not skew; a problem without ties, whose shortest ways are single.
TEST(Traffic, IsMonotoneWithTies) {
  const Problem problem = traffic_own(10, 10, 1);
  test::expect_monotone(*problem.mcp, 3);
  test::expect_constant_entries(*problem.mcp);
  const Index flows = problem.mcp->size() - 4 * 99;
  const Vec v = problem.solutions[0].x.head(flows), F = test::values(*problem.mcp, problem.solutions[0].x).head(flows);
  EXPECT_GT((v.array() > 0).count(), 4 * 99 + 40);  // more than trees
  EXPECT_GT((v.array() == 0 && F.array().abs() < 1e-12).count(), 20);
}

// From other starts other flows by destination, the same total flows and times. Catches: a claim of uniqueness that
// fails, in either direction.
TEST(Traffic, TotalFlowsAndTimesAreUnique) {
  const Problem problem = traffic_own(8, 8, 1);
  const Vec& planted = problem.solutions[0].x;
  const Index times = 4 * 63, flows = problem.mcp->size() - times;
  const auto totals = [&](const Vec& z) { return Vec(z.head(flows).reshaped(4, flows / 4).colwise().sum()); };
  double apart = 0;
  for (const Vec& start : {problem.starts[0], problem.starts[1]}) {
    const Result result = solve(*problem.mcp, start, path());
    ASSERT_TRUE(result.solved()) << result.message;
    EXPECT_LT((totals(result.x) - totals(planted)).lpNorm<Eigen::Infinity>(), 1e-5);
    EXPECT_LT((result.x - planted).tail(times).lpNorm<Eigen::Infinity>(), 1e-5);
    apart = std::max(apart, (result.x - planted).lpNorm<Eigen::Infinity>());
  }
  EXPECT_GT(apart, 0.1);
}

// Catches: data that depend on more than sizes and seed.
TEST(Networks, AreReproducibleBySeed) {
  EXPECT_EQ(traffic_own(5, 4, 9).solutions[0].x, traffic_own(5, 4, 9).solutions[0].x);
  EXPECT_NE(traffic_own(5, 4, 9).solutions[0].x, traffic_own(5, 4, 8).solutions[0].x);
  EXPECT_EQ(spatial_price_own(30, 9).solutions[0].x, spatial_price_own(30, 9).solutions[0].x);
  EXPECT_NE(spatial_price_own(30, 9).solutions[0].x, spatial_price_own(30, 8).solutions[0].x);
  const Vec z = Vec::Ones(traffic_own(5, 4, 9).mcp->size());
  EXPECT_EQ(test::values(*traffic_own(5, 4, 9).mcp, z), test::values(*traffic_own(5, 4, 9).mcp, z));
}

TEST(Networks, RefuseSizesWithoutAProblem) {
  EXPECT_THROW(spatial_price_own(1, 1), std::invalid_argument);
  EXPECT_THROW(traffic_own(1, 5, 1), std::invalid_argument);
  EXPECT_THROW(traffic_own(5, 1, 1), std::invalid_argument);
  EXPECT_THROW(traffic_own(4'001, 2, 1), std::invalid_argument);
}

TEST(Networks, NamesSayFromWhereToWhere) {
  const Problem traffic = traffic_own(2, 3, 1);
  EXPECT_EQ(traffic.mcp->variable_name(0), "v[1,1-1,2;1]");
  EXPECT_EQ(traffic.mcp->equation_name(5), "detour[1,1-2,1;2]");
  const Problem trade = spatial_price_own(4, 1);
  EXPECT_EQ(trade.mcp->variable_name(0), "x[1,2]");
  EXPECT_EQ(trade.mcp->variable_name(8), "p[1]");
}

}  // namespace
