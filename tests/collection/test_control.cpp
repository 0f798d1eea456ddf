// SPDX-License-Identifier: Apache-2.0
// Optimal control: closed forms, the optimization problems behind the complementarity problems, structure.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collection/scalable/generators.hpp"
#include "model_checks.hpp"
#include "ncp/problem/residual.hpp"

namespace {

using namespace perp::ncp;
using namespace perp::ncp::collection;
using Eigen::Vector2d;

constexpr Index width = 5;

Vec controls(const Vec& z) {
  Vec u(z.size() / width);
  for (Index t = 0; t < u.size(); ++t) u[t] = z[width * t + 2];
  return u;
}

/// sum_t (x_t'x_t + 0.05 u_t^2) / 2 under the controls u.
double regulator_cost(const Vec& u) {
  Vector2d x(1, 0.5);
  double cost = 0;
  for (const double control : u) {
    x = Vector2d(x[0] + 0.1 * x[1], -0.2 * x[0] + 0.95 * x[1] + 0.1 * control);
    cost += (x.squaredNorm() + 0.05 * control * control) / 2;
  }
  return cost;
}

// One stage: u = -B'A x_0 / (0.05 + B'B) = -0.0275 / 0.06 is below -0.3; x = A x_0 - 0.3 B, l = x. Catches: a sign of
// the adjoints, the first stage's initial value.
TEST(Control, OneStageByHand) {
  const Problem problem = lq_control_own(1);
  ASSERT_EQ(problem.solutions.size(), 1u);
  EXPECT_LT((problem.solutions[0].x - Vec({{1.05, 0.245, -0.3, 1.05, 0.245}})).norm(), 1e-15);
  EXPECT_TRUE(problem.solutions_complete);
}

// The controls minimise the cost over the box, found here by coordinate descent on simulated costs alone (each step
// exact, as the cost is quadratic). Catches: a Riccati recursion, adjoints or costs that belong to another program.
TEST(Control, RegulatorMinimisesTheCost) {
  constexpr Index T = 12;
  const Problem problem = lq_control_own(T);
  Vec u = Vec::Zero(T);
  for (int sweep = 0; sweep < 400; ++sweep)
    for (Index t = 0; t < T; ++t) {
      const auto at = [&](double value) {
        u[t] = value;
        return regulator_cost(u);
      };
      const double down = at(-1), middle = at(0), up = at(1);
      u[t] = std::clamp((down - up) / (2 * (up + down - 2 * middle)), -0.3, 0.3);
    }
  ASSERT_EQ(problem.solutions.size(), 1u);
  EXPECT_LT((controls(problem.solutions[0].x) - u).lpNorm<Eigen::Infinity>(), 1e-9);
}

// Catches: a recursion that loses accuracy over many stages; a box that is never, or always, active.
TEST(Control, RegulatorAtEverySize) {
  for (const Index T : {1, 2, 3, 5, 20, 333, 3'000}) {
    const Problem problem = lq_control_own(T);
    ASSERT_EQ(problem.solutions.size(), 1u) << T;
    EXPECT_LT(residual(*problem.mcp, problem.solutions[0].x).natural, 1e-13) << T;
  }
  const Vec u = controls(lq_control_own(200).solutions[0].x);
  const Index bound = (u.array().abs() == 0.3).count();
  EXPECT_GT(bound, 10);
  EXPECT_LT(bound, 190);
}

// J + J' is diagonal: 2 for the states, 0.1 for the controls, 0 for the adjoints: positive semidefinite. Catches: a
// coupling of states and adjoints that is not skew, hence not monotone.
TEST(Control, RegulatorIsMonotoneAndBanded) {
  const Problem problem = lq_control_own(9);
  EXPECT_TRUE(problem.mcp->is_affine());
  const SpMat J = test::jacobian(*problem.mcp, Vec::Zero(45));
  Vec diagonal(45);
  for (Index t = 0; t < 9; ++t) diagonal.segment(width * t, width) << 2, 2, 0.1, 0, 0;
  EXPECT_LT((Eigen::MatrixXd(J) + Eigen::MatrixXd(J).transpose() - Eigen::MatrixXd(diagonal.asDiagonal())).norm(),
            1e-15);
  for (Index j = 0; j < 45; ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it) EXPECT_LE(std::abs(it.row() - it.col()), 9);
}

// The reference from F at 0, then the cost under the controls by simulation: its slope at the planted controls is h
// times their rows of F, zero inside the box and outwards at its ends. Catches: a planted point that is stationary for
// F alone and not for the tracking problem.
TEST(Control, OscillatorIsStationaryForTheCost) {
  constexpr Index T = 100;
  constexpr double h = 0.1;
  const Problem problem = vanderpol_own(T);
  Vec F(width * T);
  ASSERT_TRUE(problem.mcp->eval(Vec::Zero(width * T), F));
  const auto cost = [&](const Vec& u) {
    Vector2d x(1, 0);
    double sum = 0;
    for (Index t = 0; t < T; ++t) {
      x = Vector2d(x[0] + h * x[1], x[1] + h * ((1 - x[0] * x[0]) * x[1] - x[0] + u[t]));
      sum += h * ((x + F.segment<2>(width * t)).squaredNorm() + 0.05 * u[t] * u[t]) / 2;  // F = -r
    }
    return sum;
  };
  const Vec& planted = problem.solutions.at(0).x;
  Vec rows(width * T);
  ASSERT_TRUE(problem.mcp->eval(planted, rows));
  const Vec u = controls(planted);
  Index inside = 0;
  for (Index t = 0; t < T; ++t) {
    const Vec step = 1e-5 * Vec::Unit(T, t);
    const double slope = (cost(u + step) - cost(u - step)) / 2e-5;
    EXPECT_NEAR(slope, h * rows[width * t + 2], 1e-8) << t;
    if (std::abs(u[t]) < 0.75) {
      EXPECT_NEAR(slope, 0, 1e-8);
      ++inside;
    } else {
      EXPECT_LT(slope * u[t], 1e-8);
    }
  }
  EXPECT_GT(inside, 10);
  EXPECT_LT(inside, 90);
}

// The Hessian of the Lagrangian is positive definite at the planted point: a strict local minimum. Catches: adjoints
// too large for that, so that the planted point would be a saddle.
TEST(Control, OscillatorIsAtAStrictMinimum) {
  for (const Index T : {40, 57, 400}) {
    const Problem problem = vanderpol_own(T);
    const Vec& planted = problem.solutions.at(0).x;
    EXPECT_LT(residual(*problem.mcp, planted).natural, 1e-12) << T;
    const SpMat J = test::jacobian(*problem.mcp, planted);
    for (Index t = 0; t < T; ++t) {
      const Index i = width * t;
      const double corner = J.coeff(i, i), other = J.coeff(i + 1, i + 1), off = J.coeff(i, i + 1);
      EXPECT_EQ(off, J.coeff(i + 1, i));
      EXPECT_GT(corner * other - off * off, 0.05) << t;
      EXPECT_GT(corner, 0.05) << t;
    }
  }
}

TEST(Control, FlagsOfConstantEntriesAreTrue) {
  test::expect_constant_entries(*vanderpol_own(40).mcp);
  test::expect_constant_entries(*lq_control_own(7).mcp);
}

// Catches: stages or parts exchanged in messages.
TEST(Control, NamesFollowTheStages) {
  const Problem problem = lq_control_own(3);
  EXPECT_EQ(problem.mcp->variable_name(0), "x[1,1]");
  EXPECT_EQ(problem.mcp->variable_name(7), "u[2]");
  EXPECT_EQ(problem.mcp->variable_name(14), "lambda[3,2]");
  EXPECT_EQ(problem.mcp->equation_name(1), "adjoint[1,2]");
  EXPECT_EQ(problem.mcp->equation_name(7), "gradient[2]");
  EXPECT_EQ(problem.mcp->equation_name(13), "state[3,1]");
  EXPECT_EQ(problem.mcp->box().lower[7], -0.3);
  EXPECT_EQ(problem.mcp->box().lower[6], -infinity);
}

}  // namespace
