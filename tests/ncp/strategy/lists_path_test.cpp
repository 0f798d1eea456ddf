// SPDX-License-Identifier: Apache-2.0
/// ncp::path(): what is tried after the first attempt.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "ncp/reformulation/merit.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using testing::HasSubstr;
using testing::Not;

/// What the attempts of a run are called, with the points they begin at.
struct Begun {
  std::vector<std::string> names;
  std::vector<Vec> points;
};
Observer begun(Begun& out) {
  return [&out](const Iteration& it) {
    if (!it.attempt.empty()) {
      out.names.push_back(it.attempt);
      out.points.push_back(*it.x);
    }
    return Next::Continue;
  };
}

// PATH's manual, option restart_limit. Billups' problem has a local minimum that none of the three leaves. Catches
// other restarts in their place, and a list that goes on.
TEST(Restarts, ThoseThatPathDocuments) {
  const auto mcp = make_mcp(support::billups());
  Begun all;
  const Result result = solve(*mcp, vec({0}), path_documented({}, 3), begun(all));
  EXPECT_FALSE(result.accepted());
  ASSERT_EQ(all.names.size(), 3U);
  EXPECT_THAT(all.names[0], HasSubstr("perturbed by 0.01 times the residual"));
  EXPECT_THAT(all.names[1], HasSubstr("a test in each iteration"));
  EXPECT_THAT(all.names[2], HasSubstr("arcs"));
  EXPECT_EQ(result.stats.restarts, 3);
}

// Billups 1995: no descent method leaves its local minimum; a proximal escape does (Billups & Ferris 1997). Catches a
// list that ends before that, and a limit of restarts that is not kept.
TEST(Restarts, GoThroughTheListUntilOneSolves) {
  const auto mcp = make_mcp(support::billups());
  Begun all;
  const Result result = support::expect_solved(*mcp, vec({0}), path(), "", begun(all));
  ASSERT_FALSE(all.names.empty());
  EXPECT_THAT(all.names.back(), HasSubstr("escape"));
  int limit = 0;
  for (;; ++limit) {
    Begun some;
    const Result less = solve(*mcp, vec({0}), path({}, limit), begun(some));
    EXPECT_TRUE(std::equal(some.names.begin(), some.names.end(), all.names.begin())) << limit;
    if (less.solved()) break;
    EXPECT_NEAR(less.residual.natural, 0.01, 1e-6);
    EXPECT_TRUE(limit == 0 || less.message.find(std::to_string(limit) + " restart") != std::string::npos) << less;
    ASSERT_LT(limit, 20);
  }
  EXPECT_GE(limit, 3);
  EXPECT_GE(result.stats.restarts, limit);
}

// Attempts with other options begin where the user did or where they say, escapes where the best point is. Catches
// starts from where the last attempt ended: a local minimum.
TEST(Restarts, BeginWhereTheySay) {
  const auto mcp = make_mcp(support::billups());
  Begun all;
  support::expect_solved(*mcp, vec({0.001}), path(), "", begun(all));
  ASSERT_GE(all.points.size(), 4U);
  for (std::size_t k = 0; k < all.points.size(); ++k) {
    const std::string& name = all.names[k];
    if (name.find("escape") != std::string::npos || name == "on with the options given") continue;
    const bool origin = name.find("from the origin") != std::string::npos;
    const bool unit_box = name.find("unit box") != std::string::npos;
    EXPECT_EQ(all.points[k], origin ? vec({0}) : unit_box ? generic(1, 1) : vec({0.001})) << name;
  }
  EXPECT_NE(all.points.back(), vec({0.001})) << all.names.back();
}

// Limits are for all attempts together, and neither a limit nor a proof is a reason to go on.
TEST(Restarts, ShareTheLimits) {
  const auto mcp = make_mcp(support::billups());
  for (const int limit : {5, 40, 80}) {
    int last = 0;
    const Result result = solve(*mcp, vec({0}), path({.stop = {.max_iterations = limit}}), [&](const Iteration& it) {
      last = std::max(last, it.k);
      return Next::Continue;
    });
    EXPECT_FALSE(result.solved());
    EXPECT_LE(last, limit);
    EXPECT_LE(result.stats.iterations, limit);
    EXPECT_THAT(result.message, HasSubstr("limit of " + std::to_string(limit) + " iterations"));
  }
  int interrupted = 0;
  const Result stopped = solve(*mcp, vec({0}), path(), [&](const Iteration& it) {
    interrupted += it.attempt.empty() ? 0 : 1;
    return interrupted == 3 ? Next::Stop : Next::Continue;
  });
  EXPECT_EQ(stopped.status, Status::Interrupted) << stopped;
  EXPECT_EQ(stopped.stats.restarts, 3);
}

// The best point of all attempts is answered, whichever attempt met it.
TEST(Restarts, KeepTheBestPoint) {
  const auto mcp = make_mcp(support::scalar(  // 1 + (x - 3)^2 (1 + sin^2): no zero, many local minima
      -infinity, infinity, [](double x) { return 1 + (x - 3) * (x - 3) * (1 + std::pow(std::sin(4 * x), 2)); },
      [](double x) {
        const double s = std::sin(4 * x);
        return 2 * (x - 3) * (1 + s * s) + (x - 3) * (x - 3) * 8 * s * std::cos(4 * x);
      }));
  for (const double x0 : {-5.0, 0.0, 10.0}) {
    double best = infinity;
    const Result result = solve(*mcp, vec({x0}), path(), [&](const Iteration& it) {
      best = std::min(best, it.residual);
      return Next::Continue;
    });
    EXPECT_FALSE(result.solved());
    EXPECT_LE(result.residual.natural, best);
    EXPECT_GE(result.residual.natural, 1);
    EXPECT_GT(result.stats.restarts, 0);
    EXPECT_THAT(result.message, HasSubstr("restarts"));
  }
}

// Affine problems on which the path fails go to the methods of lcp/ next: a bimatrix-like LCP with a copositive M from
// a start on which regular paths cycle is solved by Lemke-Howson or Lemke's ray. And a proof of infeasibility ends it.
TEST(Restarts, AffineProblemsGoToTheLinearMethods) {
  // -x + 1 >= 0 .. M = -1, q = 1: two solutions, 0 and 1; M = -1, q = -1: none, and not certified by copositivity.
  Functions none = support::affine({support::matrix({{-1}}), vec({-1}), Box::nonnegative(1)});
  none.affine = true;
  Begun all;
  const Result result = solve(*make_mcp(none), vec({1}), path(), begun(all));
  EXPECT_FALSE(result.solved());
  EXPECT_TRUE(result.status == Status::Infeasible ||
              (!all.names.empty() && all.names.front().find("linear") != std::string::npos))
      << result;
}

// Everything that is solved at once is solved without restarts.
TEST(Restarts, AreNotTakenWhereNothingIsWrong) {
  for (const bool josephy : {false, true})
    for (const Vec& x0 : support::kojima_shindo_starts()) {
      const Result result = support::expect_solved(*make_mcp(support::kojima_shindo(josephy)), x0, path());
      EXPECT_EQ(result.stats.restarts, 0);
      EXPECT_THAT(result.message, Not(HasSubstr("restart")));
    }
}

}  // namespace
}  // namespace perp::ncp
