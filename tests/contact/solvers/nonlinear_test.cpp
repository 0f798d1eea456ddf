// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/nonlinear.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "contact/refusal.hpp"
#include "contact/scenes/elastic_rod.hpp"
#include "contact/scenes/pendulum_chain.hpp"
#include "lcp/judge/result.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::contact {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

SpMat matrix(const Eigen::MatrixXd& dense) {
  SpMat sparse = dense.sparseView();
  sparse.makeCompressed();
  return sparse;
}

/// A mass of m = 2 kg on a plane that slides with air drag: R = m (v - v_k) - h F + h c |v_T| v_T, N first.
NonlinearProblem mass_with_drag(const Vec3& v_k, const Vec3& F, double c, double mu) {
  constexpr double m = 2;
  constexpr double h = 0.1;
  const auto R = [=](In v, ncp::Out out) {
    out = m * (v - v_k) - h * F;
    out.tail(2) += h * c * v.tail(2).norm() * v.tail(2);
    return true;
  };
  NonlinearProblem problem{.H = matrix(Mat3::Identity()), .w = Vec::Zero(3), .mu = Vec::Constant(1, mu)};
  problem.R = ncp::make_mcp({.name = "drag", .box = ncp::Box::free(3), .F = R});
  return problem;
}

/// A rod that is pushed hard: a third of its nodes slips, the others stick.
NonlinearProblem pushed_rod(Derivative derivative = Derivative::Dual) {
  const ElasticRod rod;
  return rod.step(rod.straight(), derivative);
}

/// A chain that fell from the horizontal until some of its nodes are on the floor.
struct FallenChain {
  PendulumChain chain{.links = 12, .h = 0.02};
  Motion at = chain.straight(1.5);

  FallenChain() {
    for (int k = 0; k < 40 && chain.step(at).contacts() < 4; ++k) {
      const NonlinearResult step = solve(chain.step(at), at.v, {.tol = 1e-10});
      EXPECT_TRUE(step.solved()) << k << ": " << step.message;
      at = chain.moved(at, step.v);
    }
  }
};

/// |v_k - v*| of the points that the solver met, from a tighter solve.
std::vector<double> dynamics_of(const NonlinearResult& result) {
  std::vector<double> all;
  for (const NonlinearRecord& record : result.history) all.push_back(record.dynamics);
  return all;
}

// While it slides, with s = |v_T|: m (s - s_k) - h F_T + h c s^2 = -mu h (-F_N), a quadratic equation in s. A wrong
// sign of H r, of w or of the derivative would give another s.
TEST(Nonlinear, MassThatSlidesAgainstDragHasItsClosedForm) {
  const NonlinearProblem problem = mass_with_drag(Vec3(0, 3, 4), Vec3(-20, 0, 0), 3, 0.3);
  const NonlinearResult result = solve(problem, Vec3(0, 3, 4), {.tol = 1e-12});
  ASSERT_TRUE(result.solved()) << result.message;
  const double a = 0.1 * 3;
  const double c = 0.3 * 0.1 * 20 - 2 * 5;
  const double s = (-2 + std::sqrt(4 - 4 * a * c)) / (2 * a);
  EXPECT_NEAR(result.v[1], 0.6 * s, 1e-11);
  EXPECT_NEAR(result.v[2], 0.8 * s, 1e-11);
  EXPECT_NEAR(result.v[0], 0, 1e-12);
  EXPECT_NEAR(result.solution.r[0], 2, 1e-11);
}

// Without friction (41) is an NCP of (v, r_N), which the path search of ncp/ solves by a way of its own.
TEST(Nonlinear, WithoutFrictionIsTheNcpOf41) {
  ElasticRod rod{.nodes = 6, .mu = 0};
  const NonlinearProblem problem = rod.step(rod.straight());
  const Index m = problem.size();
  const Index n = problem.contacts();
  Eigen::MatrixXd H_N(m, n);
  for (Index a = 0; a < n; ++a) H_N.col(a) = Vec(problem.H.col(3 * a));
  ncp::Functions ncp41;
  ncp41.box = ncp::Box::free(m + n);
  ncp41.box.lower.tail(n).setZero();
  ncp41.F = [&](In z, ncp::Out F) {
    Vec R(m);
    if (!problem.R->eval(z.head(m), R)) return false;
    F.head(m) = R - H_N * z.tail(n);
    F.tail(n) = H_N.transpose() * z.head(m);
    return true;
  };
  const auto mcp = ncp::make_mcp(std::move(ncp41));
  ncp::PathSearch path;
  path.stop.tol = 1e-11;
  const ncp::Result reference = ncp::solve(*mcp, Vec::Zero(m + n), path);
  ASSERT_TRUE(reference.solved()) << reference.message;
  const NonlinearResult result = solve(problem, Vec::Zero(m), {.tol = 1e-11});
  ASSERT_TRUE(result.solved()) << result.message;
  EXPECT_LE((result.v - reference.x.head(m)).norm(), 1e-8 * reference.x.head(m).norm());
  for (Index a = 0; a < n; ++a) EXPECT_NEAR(result.solution.r[3 * a], reference.x[m + a], 1e-8);
}

// Josephy's theorem: once near, each residual is at most a constant times the square of the one before. With a first-
// order error in A, W or the recovered v the ratios below would grow without bound as the residuals fall.
TEST(Nonlinear, ConvergesQuadratically) {
  const FallenChain fallen;
  const std::pair<NonlinearProblem, Vec> cases[] = {{fallen.chain.step(fallen.at), fallen.at.v},
                                                    {pushed_rod(), Vec::Zero(60)}};
  for (const auto& [problem, v] : cases) {
    const NonlinearResult result = solve(problem, v, {.tol = 1e-12});
    ASSERT_TRUE(result.solved()) << problem.name << ": " << result.message;
    const std::vector<double> e = dynamics_of(result);
    int quadratic = 0;
    for (std::size_t k = 0; k + 1 < e.size(); ++k) {
      if (e[k] > 1e-2 || e[k] < 1e-7) continue;  // far away, or below what doubles show of a square
      EXPECT_LE(e[k + 1], 20 * e[k] * e[k] + 1e-14) << problem.name << " after " << k << " steps";
      ++quadratic;
    }
    EXPECT_GE(quadratic, 1) << problem.name << " never came near";
  }
}

// A mass that slides from beyond a stiff stop, with the stiffness k, to rest at 0.8 - 0.3. The first step leads to the
// stop. R' is 1 there and k before: beside k |v| what is left of R is small, though it is as large as the impulse.
TEST(Nonlinear, AStiffStopOnTheWayIsNotTheScaleOfTheEnd) {
  for (const double k : {1e6, 1e8, 1e10}) {
    NonlinearProblem problem{.H = matrix(Mat3::Identity()), .w = Vec::Zero(3), .mu = Vec::Constant(1, 0.3)};
    const auto R = [=](In v, ncp::Out out) {
      out = v - Vec3(-1, 0.8, 0);
      out[1] += k * std::max(0.0, v[1] - 1);
      return true;
    };
    const auto derivative = [=](In v, SpMat& A) {
      A.coeffs().setOnes();
      if (v[1] > 1) A.coeffs()[1] += k;
      return true;
    };
    problem.R = ncp::make_mcp(
        {.name = "stop", .box = ncp::Box::free(3), .pattern = matrix(Mat3::Identity()), .F = R, .J = derivative});
    const NonlinearResult result = solve(problem, Vec3(0, 2, 0));
    ASSERT_TRUE(result.solved()) << result.message;
    EXPECT_NEAR(result.v[1], 0.5, 1e-7) << k << ": " << result.message;
    EXPECT_NEAR(result.solution.r[1], -0.3, 1e-7) << k;
  }
}

// The rod's W is positive definite: all methods of the same law must end in the same point, whichever formulation they
// use. One that solved another law, or that the outer loop accepted too early, would stand out. The hyperplane method
// stalls short of 1e-9, so less is asked of it.
TEST(Nonlinear, IsTheSameByEveryInnerMethod) {
  const NonlinearProblem problem = pushed_rod();
  const NonlinearResult reference = solve(problem, Vec::Zero(60), {.tol = 1e-10});
  ASSERT_TRUE(reference.solved()) << reference.message;
  NonlinearOptions options;
  for (const MethodEntry& entry : methods()) {
    options.inner = variant_of(VariantWords{.method = std::string(entry.name)});
    const bool stalls = entry.name == "hyperplane";
    options.tol = stalls ? 1e-6 : 1e-8;
    const NonlinearResult result = solve(problem, Vec::Zero(60), options);
    EXPECT_TRUE(result.solved()) << entry.name << ": " << result.message;
    const double near = stalls ? 1e-4 : 1e-6;
    EXPECT_LE((result.v - reference.v).norm(), near * reference.v.norm()) << entry.name;
    EXPECT_LE((result.solution.r - reference.solution.r).norm(), near * reference.solution.r.norm()) << entry.name;
  }
  options.tol = 1e-8;
  options.inner = variant_of("glocker+path");
  const NonlinearResult by_path = solve(problem, Vec::Zero(60), options);
  EXPECT_TRUE(by_path.solved()) << by_path.message;
  EXPECT_LE((by_path.v - reference.v).norm(), 1e-6 * reference.v.norm());
}

// R without its derivative, by coloured differences: the same point, for as many Newton steps, and a J costs as many
// evaluations of R as the pattern has colours, not m.
TEST(Nonlinear, NeedsNoDerivative) {
  const NonlinearResult with = solve(pushed_rod(), Vec::Zero(60), {.tol = 1e-10});
  const NonlinearProblem plain = pushed_rod(Derivative::Differences);
  const NonlinearResult without = solve(plain, Vec::Zero(60), {.tol = 1e-10});
  ASSERT_TRUE(with.solved()) << with.message;
  ASSERT_TRUE(without.solved()) << without.message;
  EXPECT_LE((with.v - without.v).norm(), 1e-9 * with.v.norm());
  EXPECT_LE(without.stats.iterations, with.stats.iterations + 1);
  EXPECT_LE(without.stats.J_R_evals, without.stats.J_evals * (plain.R->jacobian_work().colours + 1));
  EXPECT_LT(plain.R->jacobian_work().colours, 20);
}

// atan has the root 0 and Newton's steps from |v| > 1.39 overshoot more each time: a search is needed. Without contacts
// and with one that opens and one that closes.
TEST(Nonlinear, SearchesWhereFullStepsDiverge) {
  for (const double w : {inf, 1.0, -0.5}) {
    const Index n = w == inf ? 0 : 1;
    NonlinearProblem problem{.dimension = 2, .w = Vec::Zero(2 * n), .mu = Vec::Constant(n, 0.5)};
    problem.R = ncp::make_mcp({.box = ncp::Box::free(2), .F = [](In v, ncp::Out R) {
                                 R = v.array().atan();
                                 return true;
                               }});
    problem.H = matrix(Eigen::MatrixXd::Identity(2, 2 * n));
    if (n > 0) problem.w[0] = w;
    const Vec far = Vec::Constant(2, 4);
    const NonlinearResult result = solve(problem, far);
    EXPECT_TRUE(result.solved()) << w << ": " << result.message;
    EXPECT_NEAR(result.v[0], w == -0.5 ? 0.5 : 0, 1e-7) << w;
    EXPECT_NEAR(result.v[1], 0, 1e-7) << w;
    EXPECT_FALSE(solve(problem, far, {.search = false}).solved()) << w;
  }
}

// R(v) = v^2 + 1 - H r with the contact open has no root: that must be said, and no point may be called solved.
TEST(Nonlinear, SaysWhereItIsStuck) {
  NonlinearProblem problem{.dimension = 2, .w = Vec::Zero(0), .mu = Vec::Zero(0)};
  problem.R = ncp::make_mcp({.box = ncp::Box::free(1), .F = [](In v, ncp::Out R) {
                               R[0] = v[0] * v[0] + 1;
                               return true;
                             }});
  problem.H = SpMat(1, 0);
  const NonlinearResult result = solve(problem, Vec::Constant(1, 3));
  EXPECT_FALSE(result.solved());
  EXPECT_GT(result.dynamics, 1e-3);
  EXPECT_NE(result.message.find("|R - H r|"), std::string::npos) << result.message;
}

// A polygon's law is another one: its point is balanced, and the exact judge must not call it solved. In the plane, and
// without friction, it is the same law.
TEST(Nonlinear, APolygonIsNotCoulombsLaw) {
  NonlinearOptions options{.inner = variant_of("inner:8")};
  const NonlinearResult polygon = solve(pushed_rod(), Vec::Zero(60), options);
  EXPECT_EQ(polygon.status, Status::NotApplicable) << polygon.message;
  EXPECT_LE(polygon.dynamics, 1e-8);
  EXPECT_GT(polygon.residual.largest(), 1e-4);
  const FallenChain fallen;
  const NonlinearResult plane = solve(fallen.chain.step(fallen.at), fallen.at.v, options);
  EXPECT_TRUE(plane.solved()) << plane.message;
}

// Neither may a point pass that is no solution: the accepted one, moved by a thousandth, must begin with residuals.
TEST(Nonlinear, JudgesTheStartByTheSameRule) {
  const NonlinearProblem problem = pushed_rod();
  const NonlinearResult result = solve(problem, Vec::Zero(60), {.tol = 1e-9});
  ASSERT_TRUE(result.solved()) << result.message;
  NonlinearOptions warm{.start = result.solution.r};
  EXPECT_EQ(solve(problem, result.v, warm).stats.iterations, 0);
  const NonlinearResult moved = solve(problem, 1.001 * result.v, warm);
  EXPECT_TRUE(moved.solved()) << moved.message;
  EXPECT_GE(moved.stats.iterations, 1);
  EXPECT_LE((moved.v - result.v).norm(), 1e-6 * result.v.norm());
}

std::string refusal_of(const NonlinearProblem& problem, const Vec& v, const NonlinearOptions& options = {}) {
  return test::refusal_of([&] { solve(problem, v, options); });
}

// What is wrong is named: part, place and value.
TEST(Nonlinear, RefusesAtTheDoor) {
  const NonlinearProblem good = mass_with_drag(Vec3(0, 1, 0), Vec3(-20, 0, 0), 1, 0.3);
  const Vec v = Vec::Ones(3);
  const auto refused = [&](auto change) {
    NonlinearProblem problem = good;
    change(problem);
    return refusal_of(problem, v);
  };
  const auto dynamics = [](ncp::Box box, double value) {
    return ncp::make_mcp({.box = std::move(box), .F = [value](In x, ncp::Out R) {
                            R = x;
                            R[1] = value;
                            return true;
                          }});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal_of(good, v), "");
  EXPECT_EQ(refused([](auto& p) { p.R = nullptr; }), "nonlinear contact: there is no R");
  EXPECT_EQ(refused([&](auto& p) { p.R = dynamics(ncp::Box::free(3), nan); }),
            "nonlinear contact: R is nan at the start in F[2]");
  EXPECT_EQ(refused([&](auto& p) { p.R = dynamics(ncp::Box::nonnegative(3), 1); }),
            "nonlinear contact: x[1] is bounded by [0, inf]; velocities have no bounds");
  ncp::Box crossing = ncp::Box::free(3);
  crossing.lower[2] = 2;
  crossing.upper[2] = 1;
  EXPECT_NE(refused([&](auto& p) { p.R = dynamics(crossing, 1); }).find("the bounds of v"), std::string::npos);
  EXPECT_EQ(refused([](auto& p) { p.H = SpMat(3, 6); }),
            "nonlinear contact: H is 3 x 6; it must be 3 x 3, degrees of freedom by dimension times contacts");
  EXPECT_EQ(refused([&](auto& p) { p.H.coeffRef(1, 1) = nan; }),
            "nonlinear contact: H(1, 1) is nan, which is not finite");
  EXPECT_EQ(refused([](auto& p) { p.w = Vec::Zero(2); }), "nonlinear contact: w has 2 entries; there must be 3");
  EXPECT_EQ(refused([](auto& p) { p.scale = -Vec::Ones(3); }), "nonlinear contact: scale[0] is -1, not >= 0");
  EXPECT_NE(refused([](auto& p) { p.mu[0] = -0.1; }).find("-0.1"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.dimension = 4; }).find("4"), std::string::npos);
  EXPECT_EQ(refusal_of(good, Vec::Ones(2)), "nonlinear contact: v has 2 entries; there must be 3");
  EXPECT_NE(refusal_of(good, v, {.tol = 0}).find("tol"), std::string::npos);
  EXPECT_EQ(refusal_of(good, v, {.start = Vec::Zero(4)}),
            "nonlinear contact: the start r has 4 entries; there must be 3");
}

// Each option is described once: a field without a line is neither checked nor shown.
TEST(Nonlinear, DescribesItsOptions) {
  NonlinearOptions options;
  ncp::Fields fields;
  describe(options, fields);
  EXPECT_EQ(fields.options().size(), 7U);
  EXPECT_TRUE(invalid(NonlinearOptions{.shortest_step = 2}).has_value());
  EXPECT_FALSE(invalid(NonlinearOptions{}).has_value());
}

}  // namespace
}  // namespace perp::contact
