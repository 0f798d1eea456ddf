// SPDX-License-Identifier: Apache-2.0
/// Result::basis and PathSearch::basis: a sequence of nearby problems.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using lcp::Cell;
using support::expect_solved;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// An obstacle-like problem with a cubic term under a load that grows with s: the contact set moves with s.
Functions loaded(Index n, double s) {
  Functions functions = support::affine({.M = support::tridiagonal(n, -1, 2.05, -1),
                                         .q = Vec::NullaryExpr(n,
                                                               [n, s](Index i) {
                                                                 return 0.2 * std::sin(9.0 * static_cast<double>(i) /
                                                                                       static_cast<double>(n)) +
                                                                        0.02 - 0.1 * s;
                                                               }),
                                         .box = {Vec::Zero(n), Vec::Constant(n, 3)}});
  functions.F = [F = functions.F](In x, Out out) {
    const bool defined = F(x, out);
    out += 0.01 * x.array().cube().matrix();
    return defined;
  };
  functions.J = [J = functions.J](In x, SpMat& out) {
    J(x, out);
    out.diagonal().array() += 0.03 * x.array().square();
    return true;
  };
  return functions;
}

struct Sweep {
  int pivots = 0;
  int iterations = 0;
  std::vector<Vec> solutions;
};

/// 20 problems, each from the last one's point; with its basis if `warm`.
Sweep sweep(Index n, bool from_last, bool warm) {
  Sweep out;
  Vec x = Vec::Zero(n);
  std::vector<Cell> basis;
  for (int k = 0; k < 20; ++k) {
    const Result result = expect_solved(*make_mcp(loaded(n, 0.05 * k)), from_last ? x : Vec(Vec::Zero(n)),
                                        path({.crash = {.on = false}}), "", {}, warm ? basis : std::vector<Cell>{});
    out.pivots += result.stats.pivots;
    out.iterations += result.stats.iterations;
    out.solutions.push_back(result.x);
    if (result.solved()) x = result.x;
    if (!result.basis.empty()) basis = result.basis;
  }
  return out;
}

// Catches a basis that is dropped on the way, belongs to another problem, or costs pivots.
TEST(WarmStart, AParametricSweepTakesFewerPivots) {
  const Sweep cold = sweep(60, false, false);
  const Sweep warm = sweep(60, true, true);
  EXPECT_LT(2 * warm.pivots, cold.pivots);
  EXPECT_LE(warm.iterations, cold.iterations);
  for (std::size_t k = 0; k < cold.solutions.size(); ++k)
    EXPECT_LE((warm.solutions[k] - cold.solutions[k]).lpNorm<Eigen::Infinity>(), 1e-5) << k;
}

// From the same point, the basis alone: a start moved off the solution by a little, its active set unknown.
TEST(WarmStart, TheBasisAloneSavesPivots) {
  Random random(1);
  int cold = 0;
  int warm = 0;
  for (int k = 0; k < 10; ++k) {
    const auto mcp = make_mcp(loaded(60, 0.1 * k));
    const Result solved = expect_solved(*mcp, Vec::Zero(60), path({.crash = {.on = false}}));
    ASSERT_EQ(solved.basis.size(), 60U);
    const Vec x0 = solved.x + 1e-3 * random.normals(60).cwiseAbs();  // all inside
    const Method method = path({.crash = {.on = false}});
    cold += expect_solved(*mcp, x0, method).stats.pivots;
    warm += expect_solved(*mcp, x0, method, "", {}, solved.basis).stats.pivots;
  }
  EXPECT_LT(2 * warm, cold);
}

// The cells of a solution: strictly complementary, they are where x is. Catches a basis that is not the last one.
TEST(WarmStart, TheBasisIsTheActiveSet) {
  Random random(2);
  int compared = 0;
  for (int k = 0; k < 20; ++k) {
    const auto [functions, solution] = support::planted(12, 0, random);
    const auto mcp = make_mcp(functions);
    const Result result = expect_solved(*mcp, 3 * random.normals(12), path({.crash = {.on = false}}));
    if (result.basis.empty()) continue;  // presolve or the start solved it
    ASSERT_EQ(result.basis.size(), 12U);
    const Box& box = mcp->box();
    for (Index i = 0; i < 12; ++i) {
      const Cell cell = result.basis[static_cast<std::size_t>(i)];
      const double x = solution[i];
      ++compared;
      EXPECT_EQ(cell, box.lower[i] == box.upper[i] ? Cell::Fixed
                      : x == box.lower[i]          ? Cell::Below
                      : x == box.upper[i]          ? Cell::Above
                                                   : Cell::Inside)
          << i;
    }
  }
  EXPECT_GT(compared, 100);
}

// Cells that contradict the box, or the solution, are only a start. Catches a wrong answer from a wrong basis.
TEST(WarmStart, AnyBasisLeadsToTheSolution) {
  Random random(3);
  for (int k = 0; k < 40; ++k) {
    const auto [functions, solution] = support::planted(8, 0, random);
    const PathSearch kernel{.crash = {.on = k % 4 < 2}};
    const Method method = k % 2 == 0 ? path(kernel) : Method(kernel);
    std::vector<Cell> basis;
    for (int i = 0; i < 8; ++i) basis.push_back(static_cast<Cell>(random.integer(0, 3)));
    const Result result = expect_solved(*make_mcp(functions), random.normals(8), method, "", {}, basis);
    EXPECT_LE((result.x - solution).lpNorm<Eigen::Infinity>(), 1e-6) << k;
  }
}

// Catches reads beyond the end of a basis of another problem.
TEST(WarmStart, ABasisOfAnotherSizeIsRefused) {
  for (const Method& method : {path(), Method(PathSearch{}), automatic()})
    for (const std::size_t size : {1U, 3U, 5U}) {
      const std::vector<Cell> basis(size, Cell::Below);
      Functions functions = support::kojima_shindo();
      functions.box.lower[1] = functions.box.upper[1] = 0;  // something to presolve
      const auto mcp = make_mcp(functions);
      EXPECT_THAT(
          [&] { solve(*mcp, Vec::Zero(4), method, {}, basis); },
          ThrowsMessage<std::invalid_argument>(
              AllOf(HasSubstr("kojima-shindo"), HasSubstr(std::to_string(size) + " cells"), HasSubstr("4 variables"))));
    }
}

}  // namespace
}  // namespace perp::ncp
