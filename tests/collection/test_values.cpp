// SPDX-License-Identifier: Apache-2.0
// F at simple points, evaluated by hand from the formulas of the sources, and where F is not defined. Catches: wrong
// coefficients, which a solution at which many terms vanish does not show.
#include <gtest/gtest.h>

#include <cmath>

#include "collection/collection.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;

void expect_F(std::string_view name, const Vec& x, const Vec& expected) {
  const Problem problem = find(name)->make();
  Vec F(x.size());
  ASSERT_TRUE(problem.mcp->eval(x, F)) << name;
  for (Index i = 0; i < F.size(); ++i)
    EXPECT_NEAR(F[i], expected[i], 1e-13 * (1 + std::abs(expected[i]))) << problem.mcp->equation_name(i);
}

bool F_defined(std::string_view name, const Vec& x) {
  Vec F(x.size());
  return find(name)->make().mcp->eval(x, F);
}

bool J_defined(std::string_view name, const Vec& x) {
  const Problem problem = find(name)->make();
  SpMat J = problem.mcp->jacobian_pattern();
  return problem.mcp->jacobian(x, J);
}

TEST(Values, Tiny) {
  expect_F("kojshin", Vec({{1, 2, 3, 4}}), Vec({{24, 43, 46, 28}}));
  expect_F("josephy", Vec({{1, 2, 3, 4}}), Vec({{24, 22, 30, 28}}));
  expect_F("munson1", Vec({{1, 2, 3}}), Vec({{13, 0, 6}}));
  expect_F("billups", Vec::Constant(1, 3), Vec::Constant(1, 2.99));
  expect_F("watson4", Vec::Zero(5), 2 * std::exp(15) * Vec({{1, 0, -1, -2, -3}}));
}

TEST(Values, KktSystems) {
  expect_F("hs34-kkt", Vec({{0, 0, 0, 1, 2}}), Vec({{0, 1, -2, -1, -1}}));
  expect_F("hs35-kkt", Vec({{1, 2, 3, 4}}), Vec({{10, 8, 12, -6}}));
  expect_F("hs76-kkt", Vec({{1, 2, 3, 4, 5, 6, 7}}), Vec({{21, 8, -1, 5, -7, -3, 12.5}}));
}

// x = e5, lambda = 0; y = e1, x = e5, w = e5; y = e1, x = e5, w = 0.
TEST(Values, Colville) {
  const Vec slack({{40, 4, .25, 3, 1.2, 1, 39, 59, 0, 0}});
  const Vec b({{-40, -2, -.25, -4, -4, -1, -40, -60, 5, 1}});
  Vec z = Vec::Zero(15), F(15);
  z[4] = 1;
  F << -35, 37, -56, -58, 54, slack;
  expect_F("colvnlp", z, F);

  z = Vec::Zero(20);
  F.resize(20);
  z[0] = z[14] = z[19] = 1;
  F << slack, Vec::Zero(5), -19, 35, -56, -59, 54;
  expect_F("colvdual", z, F);
  z[19] = 0;
  F << -b, -20, 64, -20, -40, 72, -19, 35, -56, -59, 54;
  expect_F("colvdual", z, F);
}

TEST(Values, Mathiesen) {
  expect_F("mathiesen", Vec::Ones(4), Vec({{1, -6.2, 3.2, 2}}));
  expect_F("mathiesen", Vec({{2, 4, 2, 1}}), Vec({{-1, -0.925, 2.35, 1}}));
}

// Mathiesen's economy scales with its prices. Catches: a ray of solutions that is none.
TEST(Values, MathiesensSolutionsFormARay) {
  for (const double s : {0.01, 2.0, 500.0}) expect_F("mathiesen", Vec({{3, 6 * s, s, 5 * s}}), Vec::Zero(4));
}

TEST(Values, Kehoe) {
  expect_F("kehoe", Vec({{0, 0, 1, 1, 1, 1, 5, 5, 40, 40}}), Vec({{0, 0, -24.3, -15.5, 27.7, 12.1, 0, 0, 0, 0}}));
  expect_F("kehoe", Vec({{1, 2, 1, 2, 4, 5, 1, 2, 3, 4}}),
           Vec({{17, 4, 5.02, 8.9, 33.754375, 36.4325, -4, -8, -157, -196}}));
}

// q = 1/2: Q = 5, p = 1000^(5/6) = 10^2.5, L q = 5, so F_i = c_i + 5^(1/beta_i) - 11/12 p.
TEST(Values, Nash10) {
  const double revenue = std::pow(10, 2.5) * 11 / 12;
  const Vec c({{5, 3, 8, 5, 1, 3, 7, 4, 6, 3}}), beta({{1.2, 1, 0.9, 0.6, 1.5, 1, 0.7, 1.1, 0.95, 0.75}});
  Vec F(10);
  for (Index i = 0; i < 10; ++i) F[i] = c[i] + std::pow(5, 1 / beta[i]) - revenue;
  EXPECT_NEAR(F[3], -270.2553634910, 1e-9);
  expect_F("nash10", Vec::Constant(10, 0.5), F);
}

TEST(Values, Lcps) {
  expect_F("cottle4", Vec({{1, 2, 3, 4}}), Vec({{-5, -3, -5, 9}}));
  Vec z = Vec::Zero(128), F = -Vec::Ones(128);
  z[1] = 1;
  F.head(3) << -3, 3, 0;
  expect_F("ahn", z, F);
  F.head(3) << -2, 3, -2;
  expect_F("geiger-kanzow", z, F);
  z = Vec::Zero(16), F = -Vec::Ones(16);
  z[1] = 1;
  F.head(2) << 1, 0;
  expect_F("murty", z, F);
  F.setOnes();
  F.head(2) << -1, 0;
  expect_F("murty-lower", z, F);
  expect_F("cottle2", Vec({{1, 2}}), Vec({{-1, -1}}));
  expect_F("infeasible-own", Vec({{3, 1}}), Vec({{1, -1.5}}));
  expect_F("infeasible-ncp-own", Vec({{2, 0}}), Vec({{-1, 5}}));
  // q of murty-exp: -2^16, -(2^16 + 2^15), ..., -(2^17 - 2).
  F = Vec::Zero(16);
  ASSERT_TRUE(find("murty-exp")->make().mcp->eval(Vec::Zero(16), F));
  EXPECT_EQ(F[0], -65536);
  EXPECT_EQ(F[1], -98304);
  EXPECT_EQ(F[15], -131070);
}

// Corner, edge and middle of the membrane at v = 1, and the obstacle's top: 4 - 2, 4 - 3, 4 - 4 neighbours, psi at the
// centre 0.1 but for the grid's missing midpoint.
TEST(Values, ObstacleBump) {
  const Problem problem = find("obstacle-bump-own")->make();
  Vec F(900);
  ASSERT_TRUE(problem.mcp->eval(Vec::Ones(900), F));
  const double load = 1e-6 / (31.0 * 31.0);
  EXPECT_NEAR(F[0], 2 + load, 1e-15);
  EXPECT_NEAR(F[1], 1 + load, 1e-15);
  EXPECT_NEAR(F[31], load, 1e-16);
  EXPECT_NEAR(problem.mcp->box().lower.maxCoeff(), 0.1 - 2 * std::pow(0.5 / 31, 2), 1e-15);
  EXPECT_NEAR(problem.mcp->box().lower[0], 0.1 - 2 * std::pow(0.5 - 1.0 / 31, 2), 1e-15);
  EXPECT_GE(problem.starts[0].minCoeff(), 0);
}

// Fathi's matrix is L L', L = I + 2 (strict lower triangle). Catches: a wrong closed form of its entries.
TEST(Values, FathiIsAProductOfTriangles) {
  const Problem problem = find("fathi")->make();
  const Index n = problem.mcp->size();
  SpMat J = problem.mcp->jacobian_pattern();
  ASSERT_TRUE(problem.mcp->jacobian(Vec::Zero(n), J));
  Eigen::MatrixXd L = Eigen::MatrixXd::Identity(n, n);
  L.triangularView<Eigen::StrictlyLower>() = Eigen::MatrixXd::Constant(n, n, 2);
  EXPECT_EQ(Eigen::MatrixXd(J), L * L.transpose());
}

// Catches: NaN or an exception where a method has to be told to shorten its step.
TEST(Domain, NashNeedsOutputs) {
  Vec q = Vec::Ones(10);
  q[3] = -1e-9;
  EXPECT_FALSE(F_defined("nash10", q));
  EXPECT_FALSE(J_defined("nash10", q));
  EXPECT_FALSE(F_defined("nash10", Vec::Zero(10)));
  q[3] = 0;  // beta = 0.6: the slope is 0
  EXPECT_TRUE(F_defined("nash10", q));
  EXPECT_TRUE(J_defined("nash10", q));
  q[0] = 0;  // beta = 1.2: the slope is infinite
  EXPECT_TRUE(F_defined("nash10", q));
  EXPECT_FALSE(J_defined("nash10", q));
}

TEST(Domain, Watson4Overflows) {
  EXPECT_TRUE(F_defined("watson4", Vec::Constant(5, 10)));
  EXPECT_FALSE(F_defined("watson4", Vec::Constant(5, 100)));
  EXPECT_FALSE(J_defined("watson4", Vec::Constant(5, 100)));
}

TEST(Domain, PricesMustBePositive) {
  for (const double price : {0.0, -1.0}) {
    EXPECT_FALSE(F_defined("mathiesen", Vec({{1, price, 1, 1}})));
    EXPECT_FALSE(J_defined("mathiesen", Vec({{1, 1, price, 1}})));
    EXPECT_TRUE(F_defined("mathiesen", Vec({{1, 1, 1, price}})));
    EXPECT_FALSE(F_defined("kehoe", Vec({{0, 0, 1, 1, price, 1, 5, 5, 40, 40}})));
    Vec z = find("walras-own")->make().starts[1];
    z[45] = price;
    EXPECT_FALSE(F_defined("walras-own", z));
    EXPECT_FALSE(J_defined("walras-own", z));
  }
}

// A temperature below the pole -c of Antoine's equation.
TEST(Domain, DistillationNeedsTemperaturesAboveThePole) {
  Vec z = find("hydroc06")->make().starts[0];
  z[18] = -215.31;  // c_3 of hydroc06
  EXPECT_FALSE(F_defined("hydroc06", z));
  z[18] = -215;
  EXPECT_TRUE(F_defined("hydroc06", z));
}

// The reason why a small residual alone proves little for choi. Catches: the note beside the problem being wrong.
TEST(Values, ChoiFadesAtHighPrices) {
  Vec F(14);
  ASSERT_TRUE(find("choi")->make().mcp->eval(Vec::Constant(14, 10), F));
  EXPECT_LT(F.head(7).lpNorm<Eigen::Infinity>(), 1e-8);
  EXPECT_GT(F.head(7).lpNorm<Eigen::Infinity>(), 0);
}

// Prices at which exp(w_i p_j + DU_ij) itself overflows or all of them underflow. Catches: an unnormalised logit.
TEST(Domain, ChoiIsDefinedAtAnyPrice) {
  for (const double price : {-1000.0, 1000.0}) {
    EXPECT_TRUE(F_defined("choi", Vec::Constant(14, price)));
    EXPECT_TRUE(J_defined("choi", Vec::Constant(14, price)));
  }
}

}  // namespace
