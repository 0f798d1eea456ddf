// SPDX-License-Identifier: Apache-2.0
/// Derivatives of solutions: closed forms, and differences of solutions that solve() finds.
#include "ncp/analysis/sensitivity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "collection/collection.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::Random;
using support::vec;
using testing::HasSubstr;

/// F(x) + s g.
class Shifted final : public Mcp {
 public:
  Shifted(const Mcp& base, Vec shift) : base_(base), shift_(std::move(shift)) {}
  const Box& box() const override { return base_.box(); }
  const SpMat& jacobian_pattern() const override { return base_.jacobian_pattern(); }
  bool eval(In x, Out F) const override {
    if (!base_.eval(x, F)) return false;
    F += shift_;
    return true;
  }
  bool jacobian(In x, SpMat& J) const override { return base_.jacobian(x, J); }

 private:
  const Mcp& base_;
  Vec shift_;
};

SpMat column(const Vec& v) { return Dense(v).sparseView(); }
SpMat identity(Index n) {
  SpMat I(n, n);
  I.setIdentity();
  return I;
}

std::unique_ptr<Mcp> lcp_of(const Dense& M, const Vec& q) {
  return make_mcp(support::affine(lcp::standard_lcp(M.sparseView(), q)));
}

/// The example of ncp/README.md.
struct Shift {
  Vec dx, multipliers;
};
Shift readme_example() {
  // Two firms with unit costs 1 and 2 on the market P = 10 - q_1 - q_2, and one too dear at 9: how do outputs move
  // with the first one's cost?
  const auto market = lcp_of((Dense(3, 3) << 2, 1, 1, 1, 2, 1, 1, 1, 2).finished(), vec({1 - 10, 2 - 10, 9 - 10}));
  const Result equilibrium = solve(*market, Vec::Ones(3), path());
  SpMat dF(3, 1);  // F_i = c_i - P + q_i, and p = c_1
  dF.insert(0, 0) = 1;
  const Sensitivity s = sensitivity(*market, equilibrium.x, {.dF = dF});
  if (!s.known()) throw std::runtime_error(s.message);
  return {s.dx.col(0), s.dF.col(0)};  // (-2/3, 1/3, 0): the firm loses, its rival gains; (0, 0, -1/3)
}

// q_i = (a - (n + 1) c_i + sum c) / (n + 1) of the n active firms; dP/dc_1 = 1/3, hence dF_3 = -1/3. Catches wrong
// signs and an inactive firm whose multiplier is forgotten; keeps the README's example true.
TEST(Sensitivity, ExampleOfTheReadmeIsTheClosedForm) {
  const Shift shift = readme_example();
  EXPECT_LE((shift.dx - vec({-2.0 / 3, 1.0 / 3, 0})).lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_LE((shift.multipliers - vec({0, 0, -1.0 / 3})).lpNorm<Eigen::Infinity>(), 1e-12);
}

// dx_A = -M_AA^-1 dq_A, dF_N = dq_N + M_NA dx_A for all q_j at once, by dense algebra. Catches confused index sets and
// transposed blocks.
TEST(Sensitivity, LcpInAllItsRightHandSides) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Index n = 3 + k;
    const auto [functions, solution] = support::planted(n, 0, random);
    const auto mcp = make_mcp(functions);
    const Sensitivity s = sensitivity(*mcp, solution, {.dF = identity(n)});
    ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
    SpMat J = mcp->jacobian_pattern();
    mcp->jacobian(solution, J);
    std::vector<Index> A;
    for (Index i = 0; i < n; ++i)
      if (solution[i] > mcp->box().lower[i] && solution[i] < mcp->box().upper[i]) A.push_back(i);
    const Dense dense = J;
    Dense expected = Dense::Zero(n, n);
    for (Index j = 0; j < n; ++j) {
      const Vec e = Vec::Unit(n, j);
      if (!A.empty()) {
        const Vec dA = -Dense(dense(A, A)).partialPivLu().solve(Vec(e(A)));
        expected(A, j) = dA;
      }
    }
    Dense multipliers = Dense::Identity(n, n) + dense * expected;
    EXPECT_LE((s.dx - expected).lpNorm<Eigen::Infinity>(), 1e-12);
    EXPECT_LE((s.dF - multipliers).lpNorm<Eigen::Infinity>(), 1e-12);
    EXPECT_TRUE(s.strongly_regular);
    EXPECT_GT(s.rcond, 0);
  }
}

// Catches a wrong dx on real nonlinear systems: central differences of solve() along random directions at every
// regular solution that the collection's small problems have near the start's. Equations and optimality conditions are
// left out: many of their solutions are singular, or scaled over so many decades that differences show nothing.
TEST(Sensitivity, MatchesDifferencesOfSolvesOnTheCollection) {
  Random random(5);
  int compared = 0;
  for (const collection::Entry& entry : collection::entries()) {
    if (entry.size > 60 || entry.problem_class == "equations" || entry.problem_class == "kkt") continue;
    const collection::Problem problem = entry.make();
    PathSearch method;
    method.stop.tol = 1e-10;
    const Result base = solve(*problem.mcp, problem.starts.front(), method);
    if (!base.solved()) continue;
    const Vec g = random.normals(entry.size);
    const Sensitivity s = sensitivity(*problem.mcp, base.x, {.dF = column(g)});
    if (s.status != SensitivityStatus::Differentiable || s.rcond < 1e-8) continue;
    const double h = 1e-5 / std::max(1.0, s.dx.lpNorm<Eigen::Infinity>());
    const Result up = solve(Shifted(*problem.mcp, h * g), base.x, method);
    const Result down = solve(Shifted(*problem.mcp, -h * g), base.x, method);
    if (!up.solved() || !down.solved()) continue;
    const Vec difference = (up.x - down.x) / (2 * h);
    const double scale = std::max(1.0, s.dx.lpNorm<Eigen::Infinity>());
    // The two solutions are known to tol / h at best, times the condition.
    EXPECT_LE((s.dx.col(0) - difference).lpNorm<Eigen::Infinity>(), 1e-3 * scale) << entry.name;
    Vec F_up(entry.size), F_down(entry.size);
    problem.mcp->eval(up.x, F_up);
    problem.mcp->eval(down.x, F_down);
    const Vec F_difference = (F_up - F_down) / (2 * h) + g;
    EXPECT_LE((s.dF.col(0) - F_difference).lpNorm<Eigen::Infinity>(),
              1e-3 * std::max(1.0, s.dF.lpNorm<Eigen::Infinity>() + g.lpNorm<Eigen::Infinity>()))
        << entry.name;
    ++compared;
  }
  EXPECT_GE(compared, 15);
}

// Harker's game of ten firms in all their costs: column sums of dq are negative (a cost lowers the total output) and a
// firm's own output falls. Differences to 1e-6.
TEST(Sensitivity, CournotOligopolyInTheCosts) {
  const auto mcp = make_mcp(support::nash10());
  PathSearch method;
  method.stop.tol = 1e-11;
  const Result base = solve(*mcp, Vec::Ones(10), method);
  ASSERT_TRUE(base.solved());
  const Sensitivity s = sensitivity(*mcp, base.x, {.dF = identity(10)});
  ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
  for (Index j = 0; j < 10; ++j) {
    EXPECT_LT(s.dx(j, j), 0);
    EXPECT_LT(s.dx.col(j).sum(), 0);
    const double h = 1e-4;
    const Vec up = solve(Shifted(*mcp, h * Vec::Unit(10, j)), base.x, method).x;
    const Vec down = solve(Shifted(*mcp, -h * Vec::Unit(10, j)), base.x, method).x;
    EXPECT_LE((s.dx.col(j) - (up - down) / (2 * h)).lpNorm<Eigen::Infinity>(), 1e-6);
  }
}

// hs34 with its active upper bound u_3 = p = 10: x(p) = (ln ln p, ln p, p, 1 / ln p, 1 / (p ln p)) and F_3 = -x_5.
// Catches bounds that do not move, and a multiplier of an upper bound with the wrong sign.
TEST(Sensitivity, MovingUpperBoundOfHs34) {
  const auto mcp = make_mcp(support::hs34());
  SpMat du(5, 1);
  du.insert(2, 0) = 1;
  const Sensitivity s = sensitivity(*mcp, support::hs34_solution(), {.dF = SpMat(5, 1), .dl = {}, .du = du});
  ASSERT_EQ(s.status, SensitivityStatus::Differentiable) << s.message;
  const double p = 10, ln = std::log(p);
  const double d5 = -(ln + 1) / (p * ln * p * ln);
  const Vec expected = vec({1 / (p * ln), 1 / p, 1, -1 / (p * ln * ln), d5});
  EXPECT_LE((s.dx.col(0) - expected).lpNorm<Eigen::Infinity>(), 1e-12) << s.dx.transpose();
  EXPECT_LE((s.dF.col(0) - vec({0, 0, -d5, 0, 0})).lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_EQ(s.states[2], Activity::AtUpper);
  EXPECT_EQ(to_string(s.states[2]), "at upper");
}

// 0 <= x _|_ x - p >= 0 at p = 0: x = max(p, 0). And x <= 0, x - p <= 0 with x = min(p, 0). Catches a reflected upper
// bound.
TEST(Sensitivity, OneSidedDerivativesOfAScalar) {
  for (const bool lower : {true, false}) {
    const auto mcp = make_mcp(support::scalar(
        lower ? 0 : -infinity, lower ? infinity : 0, [](double x) { return x; }, [](double) { return 1; }));
    const ParameterDerivatives dp{.dF = column(vec({-1}))};
    const Sensitivity both = sensitivity(*mcp, vec({0}), dp);
    EXPECT_EQ(both.status, SensitivityStatus::Degenerate);
    EXPECT_THAT(both.message, HasSubstr("x[1]"));
    EXPECT_EQ(both.dx.size(), 0);
    for (const double t : {2.0, -2.0}) {
      const Sensitivity s = sensitivity(*mcp, vec({0}), dp, vec({t}));
      ASSERT_EQ(s.status, SensitivityStatus::Directional) << s.message;
      EXPECT_TRUE(s.strongly_regular);
      EXPECT_DOUBLE_EQ(s.dx(0, 0), lower ? std::max(t, 0.0) : std::min(t, 0.0));
      EXPECT_DOUBLE_EQ(s.dF(0, 0), lower ? std::max(-t, 0.0) : std::min(-t, 0.0));
    }
    // Of a direction that does nothing the derivative is zero.
    EXPECT_EQ(sensitivity(*mcp, vec({0}), dp, vec({0})).dx(0, 0), 0);
  }
}

// Where many indices are degenerate, with every kind of interval: the solution of F + h g for small h > 0, from both
// sides. F is a P-function, so S is a P-matrix. Catches a wrong Schur complement, sign or back substitution.
TEST(Sensitivity, OneSidedDerivativesMatchOneSidedDifferences) {
  Random random(7);
  SemismoothNewton method;
  method.stop.tol = 1e-12;
  int degenerate = 0;
  for (int k = 0; k < 30; ++k) {
    const Index n = 2 + k % 15;
    const auto [functions, solution] = support::planted(n, 0.7, random);
    const auto mcp = make_mcp(functions);
    const Vec g = random.normals(n);
    for (const double side : {1.0, -1.0}) {
      const Sensitivity s = sensitivity(*mcp, solution, {.dF = column(g)}, vec({side}));
      ASSERT_TRUE(s.known()) << s.message;
      EXPECT_TRUE(s.strongly_regular);
      degenerate += static_cast<int>(s.degenerate.size());
      const double h = 1e-7;
      const Result moved = support::expect_solved(Shifted(*mcp, side * h * g), solution, method);
      EXPECT_LE((s.dx.col(0) - (moved.x - solution) / h).lpNorm<Eigen::Infinity>(), 1e-4);
    }
  }
  EXPECT_GT(degenerate, 50);
}

// At Kojima & Shindo's (sqrt6/2, 0, 0, 1/2) x_3 is degenerate and S = -4: F_3 + p has two solution paths for p > 0 and
// none for p < 0. Catches a branch that is given out as the derivative. The other solution is regular.
TEST(Sensitivity, RefusesWhereKojimaShindoBranches) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Vec x = vec({std::sqrt(6) / 2, 0, 0, 0.5});
  const ParameterDerivatives dp{.dF = column(Vec::Unit(4, 2))};
  for (const double side : {1.0, -1.0}) {
    const Sensitivity s = sensitivity(*mcp, x, dp, vec({side}));
    EXPECT_EQ(s.status, SensitivityStatus::Degenerate);
    EXPECT_FALSE(s.strongly_regular);
    EXPECT_EQ(s.degenerate, std::vector<Index>{2});
    EXPECT_EQ(s.states[2], Activity::DegenerateLower);
    EXPECT_THAT(s.message, HasSubstr("x[3]"));
    EXPECT_THAT(s.message, HasSubstr(side > 0 ? "2 solutions" : "vanish or jump"));
  }
  const Sensitivity regular = sensitivity(*mcp, vec({1, 0, 3, 0}), {.dF = identity(4)});
  ASSERT_EQ(regular.status, SensitivityStatus::Differentiable);
  // J_AA = (6 1; 6 2) of x_1, x_3.
  EXPECT_LE((regular.dx({0, 2}, {0, 2}) - (Dense(2, 2) << -1.0 / 3, 1.0 / 6, 1, -1).finished()).norm(), 1e-12);
}

// S = (0 1; 1 0) is no P-matrix, but LCP(q, S) has one solution for q = (1, 1) and for q = (-1, -1). Catches a refusal
// where enumeration of the cells decides.
TEST(Sensitivity, EnumerationFindsTheOnlyDirectionWithoutPProperty) {
  const auto mcp = lcp_of((Dense(2, 2) << 0, 1, 1, 0).finished(), Vec::Zero(2));
  // z_i > 0 needs F_i = z_j + 1 = 0.
  const Sensitivity s = sensitivity(*mcp, Vec::Zero(2), {.dF = column(Vec::Ones(2))}, vec({1}));
  ASSERT_EQ(s.status, SensitivityStatus::Directional) << s.message;
  EXPECT_FALSE(s.strongly_regular);
  EXPECT_LE(s.dx.norm(), 0);
  EXPECT_LE((s.dF.col(0) - Vec::Ones(2)).norm(), 1e-15);
  // z_j - 1 >= 0 for both, hence F = 0.
  const Sensitivity back = sensitivity(*mcp, Vec::Zero(2), {.dF = column(Vec::Ones(2))}, vec({-1}));
  ASSERT_EQ(back.status, SensitivityStatus::Directional) << back.message;
  EXPECT_LE((back.dx.col(0) - Vec::Ones(2)).norm(), 1e-15);
}

// A continuum: 0 <= z _|_ 0 >= 0.
TEST(Sensitivity, RefusesAContinuumOfDirections) {
  const auto mcp = lcp_of(Dense::Zero(1, 1), Vec::Zero(1));
  const Sensitivity s = sensitivity(*mcp, Vec::Zero(1), {.dF = SpMat(1, 1)}, vec({1}));
  EXPECT_EQ(s.status, SensitivityStatus::Degenerate);
  EXPECT_THAT(s.message, HasSubstr("continuum"));
}

// Mathiesen's prices have no numeraire: a ray of solutions, J_AA singular at all of them. Catches numbers from a
// singular matrix; the message names the variables.
TEST(Sensitivity, RefusesSingularSystemsWithNames) {
  const auto* entry = collection::find("mathiesen");
  ASSERT_NE(entry, nullptr);
  const collection::Problem problem = entry->make();
  ASSERT_FALSE(problem.solutions.empty());
  const Vec& x = problem.solutions.front().x;
  const Sensitivity s = sensitivity(*problem.mcp, x, {.dF = identity(problem.mcp->size())});
  EXPECT_EQ(s.status, SensitivityStatus::Singular) << s.rcond;
  EXPECT_THAT(s.message, HasSubstr("singular"));
  EXPECT_THAT(s.message, HasSubstr(problem.mcp->variable_name(1)));
  EXPECT_EQ(s.dx.size(), 0);
}

TEST(Sensitivity, RefusesWhatIsNoSolution) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Sensitivity s = sensitivity(*mcp, Vec::Ones(4), {.dF = identity(4)});
  EXPECT_EQ(s.status, SensitivityStatus::NotASolution);
  EXPECT_THAT(s.message, HasSubstr("natural residual is 1, worst in equation F[1]"));
  EXPECT_DOUBLE_EQ(s.residual.natural, residual(*mcp, Vec::Ones(4)).natural);
  const Sensitivity undefined = sensitivity(*make_mcp(support::nash10()), -Vec::Ones(10), {.dF = identity(10)});
  EXPECT_EQ(undefined.status, SensitivityStatus::NotDefined);
}

// J infinite where x is: sqrt x >= 0 at x = 0.
TEST(Sensitivity, RefusesWhereOnlyTheJacobianIsUndefined) {
  const auto mcp = make_mcp(support::scalar(
      0, infinity, [](double x) { return std::sqrt(x) + 1; }, [](double x) { return 0.5 / std::sqrt(x); }));
  const Sensitivity s = sensitivity(*mcp, vec({0}), {.dF = identity(1)});
  EXPECT_EQ(s.status, SensitivityStatus::NotDefined);
  EXPECT_THAT(s.message, HasSubstr("Jacobian"));
}

// The degenerate set is bounded: S is dense.
TEST(Sensitivity, RefusesMoreDegenerateIndicesThanAllowed) {
  const auto mcp = make_mcp(support::affine(lcp::standard_lcp(identity(5), Vec::Zero(5))));
  const Sensitivity s = sensitivity(*mcp, Vec::Zero(5), {.dF = identity(5)}, Vec::Ones(5), {.max_degenerate = 4});
  EXPECT_EQ(s.status, SensitivityStatus::TooLarge);
  EXPECT_THAT(s.message, HasSubstr("max_degenerate"));
  EXPECT_THAT(s.message, HasSubstr("5 variables"));
}

// 2500 unknowns of the obstacle problem, p the load: -h^2 in every equation. The membrane does not move where it
// touches.
TEST(Sensitivity, ObstacleProblemInItsLoad) {
  constexpr int N = 50;
  constexpr Index n = Index{N} * N;
  const double h2 = 1.0 / ((N + 1) * (N + 1));
  const auto mcp = make_mcp(support::obstacle(N));
  PathSearch method;
  method.stop.tol = 1e-12;
  const Result base = solve(*mcp, Vec::Zero(n), method);
  ASSERT_TRUE(base.solved());
  const Sensitivity s =
      sensitivity(*mcp, base.x, {.dF = column(Vec::Constant(n, -h2))}, vec({1}), {.degenerate_tol = 1e-10});
  ASSERT_TRUE(s.known()) << s.message;
  const double step = 1e-6;  // before the next point touches
  const Result moved = solve(*make_mcp(support::obstacle(N, 1 + step)), base.x, method);
  ASSERT_TRUE(moved.solved());
  EXPECT_LE((s.dx.col(0) - (moved.x - base.x) / step).lpNorm<Eigen::Infinity>(), 1e-5);
  EXPECT_GT(s.dx.lpNorm<Eigen::Infinity>(), 1e-3);
}

TEST(Sensitivity, RefusesMalformedInput) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Vec x = vec({1, 0, 3, 0});
  const auto refused = [&](const ParameterDerivatives& p, const SensitivityOptions& o, const char* why) {
    try {
      sensitivity(*mcp, x, p, o);
      ADD_FAILURE() << why;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
      EXPECT_THAT(error.what(), HasSubstr("kojima-shindo"));
    }
  };
  refused({.dF = SpMat(3, 1)}, {}, "dF is 3 x 1");
  refused({.dF = column(Vec::Constant(4, std::numeric_limits<double>::quiet_NaN()))}, {}, "dF is nan");
  refused({.dF = SpMat(4, 1), .dl = SpMat(4, 2)}, {}, "dl is 4 x 2");
  refused({.dF = SpMat(4, 1), .dl = {}, .du = column(Vec::Ones(4))}, {}, "infinite bound of variable x[1]");
  refused({.dF = SpMat(4, 1)}, {.residual_tol = 0}, "residual_tol is 0");
  refused({.dF = SpMat(4, 1)}, {.degenerate_tol = -1}, "degenerate_tol is -1");
  refused({.dF = SpMat(4, 1)}, {.singular_rcond = 1}, "singular_rcond is 1");
  EXPECT_THROW(sensitivity(*mcp, vec({1, 0}), {.dF = SpMat(4, 1)}), std::invalid_argument);
  EXPECT_THROW(sensitivity(*mcp, x, {.dF = SpMat(4, 1)}, vec({1, 2})), std::invalid_argument);
}

}  // namespace
}  // namespace perp::ncp
