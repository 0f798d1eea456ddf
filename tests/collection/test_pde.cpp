// SPDX-License-Identifier: Apache-2.0
// Discretized obstacle-type problems: values by hand, objectives and prices from the literature, what follows from the
// maximum principle.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "collection/scalable/generators.hpp"
#include "lcp/solve/solve.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;
using ::testing::HasSubstr;

Vec F_at(const Problem& problem, const Vec& v) {
  Vec F(v.size());
  EXPECT_TRUE(problem.mcp->eval(v, F));
  return F;
}

SpMat J_at(const Problem& problem, const Vec& v) {
  SpMat J = problem.mcp->jacobian_pattern();
  EXPECT_TRUE(problem.mcp->jacobian(v, J));
  return J;
}

Vec solution(const Problem& problem) {
  const auto affine = affine_part(*problem.mcp);
  if (affine) return perp::lcp::solve(*affine, problem.starts[0]).z;
  const Result result = solve(*problem.mcp, problem.starts[0], SemismoothNewton{.stop = {.tol = 1e-12}});
  EXPECT_TRUE(result.solved()) << result;
  return result.x;
}

/// 1/2 v'A v + q'v of F = A v + q.
double objective(const Problem& problem, const Vec& v) {
  return 0.5 * v.dot(F_at(problem, v) + F_at(problem, Vec::Zero(v.size())));
}

// One point in the middle, by hand from the formulas. Catches: a factor h^2, a sign, a bound.
TEST(Pde, OnePointGrids) {
  const Vec one = Vec::Ones(1);
  EXPECT_NEAR(F_at(obstacle(1, 1), one)[0], 4 - 0.25, 1e-15);
  const double s = std::sin(4.6) * std::sin(4.65);
  const Problem membrane = obstacle(1, 1);
  EXPECT_NEAR(membrane.mcp->box().lower[0], s * s * s, 1e-15);
  EXPECT_NEAR(membrane.mcp->box().upper[0], s * s + 0.2, 1e-15);
  EXPECT_NEAR(F_at(bratu_own(1, 1), one)[0], 4 - 1.5 * std::numbers::e, 1e-14);
  EXPECT_NEAR(F_at(torsion(1, 1), one)[0], 4 - 1.25, 1e-15);
  EXPECT_EQ(torsion(1, 1).mcp->box().upper[0], 0.5);
  const double wx = 0.5 * (std::pow(1.1, 3) + std::pow(0.9, 3)) * 10 / std::numbers::pi;
  const double wy = (2 * std::pow(1.1, 3) + 4 * std::pow(0.9, 3)) / 6 * std::numbers::pi / 10;
  EXPECT_NEAR(F_at(journal_bearing(1, 1), one)[0], 2 * wx + 2 * wy, 1e-13);
  // dt = h = 1: 1 + sigma^2 + r.
  EXPECT_NEAR(F_at(american_put_own(1, 1), one)[0], 1.1, 1e-14);
}

// Uneven grids, an asymmetric point: F_k of v = e_k' is the coupling. Catches: dx and dy exchanged.
TEST(Pde, CouplingsOnUnevenGrids) {
  const Problem problem = obstacle(2, 4);  // dx = 1/5, dy = 1/3
  const SpMat J = J_at(problem, Vec::Zero(8));
  EXPECT_NEAR(J.coeff(0, 1), -5.0 / 3, 1e-15);
  EXPECT_NEAR(J.coeff(0, 4), -3.0 / 5, 1e-15);
  EXPECT_NEAR(J.coeff(0, 0), 2 * (5.0 / 3 + 3.0 / 5), 1e-15);
  EXPECT_EQ(J.coeff(3, 4), 0);  // the end of a row and the begin of the next
  EXPECT_EQ(problem.mcp->variable_name(4), "v[1,2]");
}

// COPS 3.0 (Dolan, More & Munson 2004), elastic-plastic torsion with 50 x 50 interior points: -4.18087e-1. The journal
// bearing of 8 x 12 points in the tests of PETSc's TAO (jbearing2 -mx 8 -my 12): -0.183437. Catches: another problem
// under the name.
TEST(Pde, ObjectivesOfTheLiterature) {
  const Problem bar = torsion(50, 50);
  EXPECT_NEAR(objective(bar, solution(bar)), -0.418087, 1e-6);
  const Problem bearing = journal_bearing(12, 8);
  EXPECT_NEAR(objective(bearing, solution(bearing)), -0.183437, 1e-6);
}

// Longstaff & Schwartz, Rev. Financial Studies 14 (2001) 113, table 1 (finite differences): strike 40, sigma 0.2, one
// year, r = 0.06. Catches: a drift or a time step of the wrong sign or size.
TEST(Pde, AmericanPutHasTheMarketPrice) {
  constexpr Index steps = 100;
  constexpr Index prices = 399;  // h = 1/200
  const Vec v = solution(american_put_own(steps, prices));
  const Vec today = v.tail(prices);
  for (const auto& [stock, price] : {std::pair{36.0, 4.478}, {38, 3.250}, {40, 2.314}, {42, 1.617}, {44, 1.110}}) {
    const double place = (std::log(stock / 40) + 1) * 200 - 1;
    const auto i = static_cast<Index>(place);
    const double part = place - static_cast<double>(i);
    EXPECT_NEAR(40 * ((1 - part) * today[i] + part * today[i + 1]), price, 0.006) << stock;
  }
}

// Catches: a stencil that is not symmetric, or not monotone, which the multilevel methods rely on.
TEST(Pde, MatricesAreMMatricesAndSymmetricWhereSaid) {
  for (const auto make : {obstacle, bratu_own, journal_bearing, torsion, american_put_own}) {
    const Problem problem = make(7, 9);
    const SpMat J = J_at(problem, problem.starts[0]);
    const bool put = problem.mcp->name() == "american-put-own";
    EXPECT_EQ((SpMat(J.transpose()) - J).norm() < 1e-14, !put) << problem.mcp->name();
    for (Index j = 0; j < J.cols(); ++j)
      for (SpMat::InnerIterator it(J, j); it; ++it)
        EXPECT_EQ(it.value() > 0, it.row() == j) << problem.mcp->name() << ' ' << it.row() << ' ' << j;
  }
}

// The problems are unchanged by reflections (torsion: by exchanging x and y, too), and so are their only solutions.
// Catches: a point of the grid at the wrong place.
TEST(Pde, SolutionsAreSymmetric) {
  constexpr Index n = 20;
  const Vec bar = solution(torsion(n, n));
  const Eigen::Map<const Eigen::MatrixXd> V(bar.data(), n, n);
  EXPECT_LT((V - V.transpose()).norm(), 1e-12);
  EXPECT_LT((V - V.rowwise().reverse()).norm(), 1e-12);
  const Vec bearing = solution(journal_bearing(n, n));
  const Eigen::Map<const Eigen::MatrixXd> P(bearing.data(), n, n);
  EXPECT_LT((P - P.rowwise().reverse()).norm(), 1e-12);
  EXPECT_GT((P - P.colwise().reverse()).norm(), 0.01);
}

// Both regions of each free boundary problem are there; the heated body of Bratu's equation is warmer than that with
// the source 6, by the maximum principle, and no bound is active. Catches: a problem without contact, hence trivial.
TEST(Pde, SolutionsTouchTheirBounds) {
  const auto at = [](const Vec& v, const Vec& bound) { return (v.array() == bound.array()).count(); };
  const Problem membrane = obstacle(50, 50);
  const Vec v = solution(membrane);
  EXPECT_GT(at(v, membrane.mcp->box().lower), 100);
  EXPECT_GT(at(v, membrane.mcp->box().upper), 10);
  const Problem bar = torsion(30, 30);
  const Vec stress = solution(bar);
  EXPECT_GT(at(stress, bar.mcp->box().upper), 100);
  EXPECT_LT(at(stress, bar.mcp->box().upper), 800);
  EXPECT_EQ(at(stress, bar.mcp->box().lower), 0);
  const Problem put = american_put_own(20, 40);
  const Vec price = solution(put);
  EXPECT_GT(at(price, put.mcp->box().lower), 100);
  const Problem body = bratu_own(30, 30);
  const Vec heat = solution(body);
  const double source = 6.0 / (31 * 31);
  const Vec plain = perp::lcp::solve({J_at(body, Vec::Zero(900)) + SpMat(source * Vec::Ones(900).asDiagonal()),
                                      Vec::Constant(900, -source), Box::nonnegative(900)},
                                     Vec::Zero(900))
                        .z;
  EXPECT_TRUE((heat.array() > plain.array()).all());
  EXPECT_LT(heat.maxCoeff(), 1);
  EXPECT_GT(heat.minCoeff(), 0);
}

// Catches: flags that presolve would rely on wrongly.
TEST(Pde, OnlyBratusDiagonalIsNotLinear) {
  EXPECT_TRUE(torsion(3, 3).mcp->is_affine());
  const Problem problem = bratu_own(3, 3);
  EXPECT_FALSE(problem.mcp->is_affine());
  const std::vector<bool> linear = problem.mcp->linear_entries();
  const SpMat& pattern = problem.mcp->jacobian_pattern();
  ASSERT_EQ(static_cast<Index>(linear.size()), pattern.nonZeros());
  std::size_t k = 0;
  for (Index j = 0; j < 9; ++j)
    for (SpMat::InnerIterator it(pattern, j); it; ++it) EXPECT_EQ(linear[k++], it.row() != j);
  const JacobianCheck check = check_jacobian(*problem.mcp, Vec::Constant(9, 0.7));
  EXPECT_LT(check.worst, 1e-8);
}

TEST(Pde, GridsHaveLimits) {
  for (const auto make : {obstacle, bratu_own, journal_bearing, torsion, american_put_own}) {
    EXPECT_THROW(make(0, 5), std::invalid_argument);
    EXPECT_THROW(make(5, 20'001), std::invalid_argument);
  }
}

}  // namespace
