// SPDX-License-Identifier: Apache-2.0
/// Bertsekas & Gafni's traffic on a ring: the links' flows of the collection against the model as netlib's
/// ampl/models/compl/bertsek.mod writes it, and its equilibrium against their projection method.
#include <gtest/gtest.h>

#include <random>

#include "collection/collection.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::ncp::collection {
namespace {

constexpr int n = 5;
constexpr double coupling = 0.5;

/// x of the node `steps` after i.
double next(const Vec& x, int i, int steps = 1) { return x[(i + steps) % n]; }

double square(double t) { return 1 + t + t * t; }

/// Row delay_o of bertsek.mod, with its delay coefficients, all 1, left out.
double delay_outside(const Vec& x, int i) {
  return square(x[i]) + coupling * square(next(x, i, 3) + next(x, i, 4)) +
         10 * square(x[i] + next(x, i, 3) + next(x, i, 4)) + 2 * coupling * square(next(x, i, 3)) +
         square(x[i] + next(x, i, 4)) + 10 * square(x[i] + next(x, i) + next(x, i, 4)) +
         2 * coupling * square(next(x, i, 4)) + square(x[i] + next(x, i)) +
         10 * square(x[i] + next(x, i) + next(x, i, 2)) + 2 * coupling * square(x[i]) + square(x[i]);
}

/// Row delay_i.
double delay_inside(const Vec& z, int i) {
  return square(z[i]) + coupling * square(next(z, i)) + 10 * square(z[i] + next(z, i)) +
         2 * coupling * square(next(z, i)) + square(z[i]) + 10 * square(z[i] + next(z, i, 4)) +
         2 * coupling * square(z[i]) + square(z[i]);
}

const Vec demand = (Vec(n) << 0.1, 0.2, 0.3, 0.4, 0.5).finished();

Vec value(const Problem& problem, const Vec& x) {
  Vec F(problem.mcp->size());
  EXPECT_TRUE(problem.mcp->eval(x, F));
  return F;
}

/// A wrong link, coefficient or sign in any row.
TEST(Ring, DelaysAreThoseOfTheModelAsWritten) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> flow(0, 3);
  for (int round = 0; round < 20; ++round) {
    const Vec all = Vec::NullaryExpr(3 * n, [&] { return flow(random); });
    const Vec x = all.head(n);
    const Vec z = all.segment(n, n);
    for (const char* name : {"bertsekas", "freebert"}) {
      const Vec F = value(find(name)->make(), all);
      for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(F[i], delay_outside(x, i) - all[2 * n + i], 1e-11) << name;
        EXPECT_NEAR(F[n + i], delay_inside(z, i) - all[2 * n + i], 1e-11) << name;
        EXPECT_NEAR(F[2 * n + i], x[i] + z[i] - demand[i], 1e-14) << name;
      }
    }
    const Vec F = value(find("gafni")->make(), x);
    for (int i = 0; i < n; ++i) EXPECT_NEAR(F[i], delay_outside(x, i) - delay_inside(demand - x, i), 1e-11);
  }
}

/// On the empty road 1 + 30 + 2 + 1 outside and 1 + 20 + 1 + 1 inside, with the coupling for each of the streams that
/// merge; one unit from node 1 meets itself on three links of the highway.
TEST(Ring, DelaysByHand) {
  const Problem problem = find("bertsekas")->make();
  Vec all = Vec::Zero(3 * n);
  EXPECT_DOUBLE_EQ(value(problem, all)[0], 34 + 7 * coupling);
  EXPECT_DOUBLE_EQ(value(problem, all)[n], 23 + 5 * coupling);
  all[0] = 1;
  EXPECT_DOUBLE_EQ(value(problem, all)[0], 3 + 90 + 6 + 3 + coupling * (1 + 2 * (1 + 1 + 3)));
}

/// bertsek.run's.
TEST(Ring, StartsAreTheRecordedOnes) {
  for (const char* name : {"bertsekas", "freebert"}) {
    const Problem problem = find(name)->make();
    ASSERT_EQ(problem.starts.size(), 5u);
    EXPECT_TRUE(problem.starts[0].isZero(0));
    EXPECT_TRUE(problem.starts[1].isConstant(0.5));
    EXPECT_TRUE(problem.starts[2].isConstant(100));
    for (const auto& [start, y] : {std::pair(3, 100.0), {4, 1.0}}) {
      EXPECT_TRUE(problem.starts[static_cast<std::size_t>(start)].head(2 * n).isZero(0));
      EXPECT_TRUE(problem.starts[static_cast<std::size_t>(start)].tail(n).isConstant(y));
    }
  }
}

/// The three forms say the same, and so do projections on 0 <= x <= demand with short steps (Bertsekas & Gafni 1982),
/// which know neither J nor complementarity.
TEST(Ring, EquilibriumIsThatOfProjections) {
  const Problem gafni = find("gafni")->make();
  Vec x = Vec::Zero(n);
  for (int step = 0; step < 3000; ++step) x = Vec(x - 0.005 * value(gafni, x)).cwiseMax(0).cwiseMin(demand);
  EXPECT_LT((x - gafni.solutions.at(0).x).cwiseAbs().maxCoeff(), 1e-13);
  for (const char* name : {"bertsekas", "freebert"}) {
    const Vec all = find(name)->make().solutions.at(0).x;
    EXPECT_LT((all.head(n) - x).cwiseAbs().maxCoeff(), 1e-13) << name;
    EXPECT_LT((all.head(n) + all.segment(n, n) - demand).cwiseAbs().maxCoeff(), 1e-15) << name;
    for (int i = 0; i < n; ++i)
      EXPECT_NEAR(all[2 * n + i], std::min(delay_outside(x, i), delay_inside(demand - x, i)), 1e-11) << name;
  }
}

/// That there is one equilibrium only rests on this: J, affine in x, is positive definite at each corner of the box.
TEST(Ring, IsStronglyMonotone) {
  const Problem gafni = find("gafni")->make();
  for (unsigned corner = 0; corner < 1U << n; ++corner) {
    const Vec x = Vec::NullaryExpr(n, [&](Index i) { return (corner >> i & 1) == 1 ? demand[i] : 0; });
    SpMat J = gafni.mcp->jacobian_pattern();
    ASSERT_TRUE(gafni.mcp->jacobian(x, J));
    const Eigen::MatrixXd S = (Eigen::MatrixXd(J) + Eigen::MatrixXd(J).transpose()) / 2;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S).eigenvalues()[0], 1) << x.transpose();
  }
}

}  // namespace
}  // namespace perp::ncp::collection
