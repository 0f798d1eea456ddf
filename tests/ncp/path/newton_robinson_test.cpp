// SPDX-License-Identifier: Apache-2.0
/// Robinson 1992; Acary, lecture 3, equations (34) to (36).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::expect_solved;
using support::Random;
using support::vec;

/// The iterates pi(y^0), pi(y^1), ... of a run.
std::vector<Vec> iterates(const Mcp& mcp, const Vec& x0, const Method& method, std::vector<bool>* full = nullptr) {
  std::vector<Vec> points;
  solve(mcp, x0, method, [&](const Iteration& it) {
    points.push_back(*it.x);
    if (full != nullptr) full->push_back(it.kind == 'N' && it.step == 1);
    return Next::Continue;
  });
  return points;
}

struct Case {
  std::string name;
  std::unique_ptr<Mcp> mcp;
  Vec x0;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const bool josephy : {false, true})
    for (const Vec& x0 : support::kojima_shindo_starts())
      all.push_back({josephy ? "josephy" : "kojima-shindo", make_mcp(support::kojima_shindo(josephy)), x0});
  all.push_back({"hs34", make_mcp(support::hs34()), vec({0, 1.05, 2.9, 0, 0})});
  all.push_back({"nash10", make_mcp(support::nash10()), Vec::Ones(10)});
  Random random(3);
  for (int k = 1; k <= 20; ++k)
    all.push_back(
        {"planted " + std::to_string(k), make_mcp(support::planted(k, 0, random).functions), random.normals(k)});
  return all;
}

// (36) by its own words: with y^{k+1} = z - (F(z^k) + F'(z^k)(z - z^k)) for z = pi(y^{k+1}), y^{k+1} is a zero of L_k
// if and only if pi(y^{k+1}) = z. Catches a linearisation at another point, and an iterate that is not the zero.
TEST(NewtonRobinson, IteratesAreZerosOfTheLinearisedNormalMap) {
  int checked = 0;
  for (const Case& c : cases()) {
    const std::vector<Vec> z = iterates(*c.mcp, c.x0, NewtonRobinson{});
    for (std::size_t k = 0; k + 1 < z.size(); ++k, ++checked) {
      Vec F(z[k].size());
      SpMat J = c.mcp->jacobian_pattern();
      ASSERT_TRUE(c.mcp->eval(z[k], F) && c.mcp->jacobian(z[k], J)) << c.name;
      const Vec y = z[k + 1] - (F + J * (z[k + 1] - z[k]));
      const double size = 1 + y.lpNorm<Eigen::Infinity>() + z[k].lpNorm<Eigen::Infinity>();
      EXPECT_LE((lcp::project(c.mcp->box(), y) - z[k + 1]).lpNorm<Eigen::Infinity>(), 1e-8 * size) << c.name << k;
    }
  }
  EXPECT_GT(checked, 100);
}

// "The same y_{k+1} would be obtained by Newton-Josephy's method if z^k were set to y_k^+" (lecture 3, after (36)): as
// long as josephy's steps are full, the two make the same points. Catches a difference in either.
TEST(NewtonRobinson, IsNewtonJosephyWithFullSteps) {
  int compared = 0;
  for (const Case& c : cases()) {
    std::vector<bool> full;
    const std::vector<Vec> josephy = iterates(*c.mcp, c.x0, NewtonJosephy{}, &full);
    const std::vector<Vec> robinson = iterates(*c.mcp, c.x0, NewtonRobinson{});
    for (std::size_t k = 1; k < std::min(josephy.size(), robinson.size()) && full[k]; ++k, ++compared) {
      const double size = 1 + robinson[k].lpNorm<Eigen::Infinity>();
      // a linearised problem may have several solutions; the two start their paths from the same y
      EXPECT_LE((josephy[k] - robinson[k]).lpNorm<Eigen::Infinity>(), 1e-6 * size) << c.name << " iterate " << k;
    }
  }
  EXPECT_GT(compared, 100);
}

// Quadratic near a strongly regular solution (Robinson 1992, theorem 3.2): r+ <= C r^2. Catches a stale Jacobian, and
// runs that do not come near a solution.
TEST(NewtonRobinson, ConvergesQuadratically) {
  int checked = 0;
  for (const Case& c : cases()) {
    if (c.name == "kojima-shindo") continue;  // degenerate or not by the start
    std::vector<Iteration> records;
    const Result result = solve(*c.mcp, c.x0, NewtonRobinson{}, record(records));
    if (!result.solved()) continue;
    for (std::size_t k = 1; k < records.size(); ++k)
      if (const double before = records[k - 1].residual; before < 1e-2) {
        ++checked;
        EXPECT_LE(records[k].residual, std::max(1e-10, 100 * before * before)) << c.name << " iteration " << k;
      }
  }
  EXPECT_GE(checked, 40);
}

// Full steps, no search: F or F' undefined at a Newton point ends the run, and says so.
TEST(NewtonRobinson, SaysWhereItCannotGoOn) {
  const auto root = make_mcp(support::scalar(
      0, infinity, [](double x) { return std::sqrt(x) - 0.5; }, [](double x) { return 0.5 / std::sqrt(x); }));
  const Result undefined = solve(*root, vec({20}), NewtonRobinson{});
  EXPECT_EQ(undefined.status, Status::EvaluationFailed) << undefined;
  EXPECT_THAT(undefined.message, ::testing::HasSubstr("Newton point"));
  const auto none = make_mcp(support::scalar(
      0, infinity, [](double) { return -1; }, [](double) { return 0; }));
  const Result unsolvable = solve(*none, vec({1}), NewtonRobinson{});
  EXPECT_EQ(unsolvable.status, Status::SubproblemFailed) << unsolvable;
  EXPECT_EQ(
      solve(*make_mcp(support::kojima_shindo()), Vec::Constant(4, 100), NewtonRobinson{.stop = {.max_iterations = 1}})
          .status,
      Status::IterationLimit);
}

}  // namespace
}  // namespace perp::ncp
