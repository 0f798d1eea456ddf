/// ncp::Auto: what it chooses, what it says, and its one budget for all attempts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ncp/affine.hpp"
#include "ncp/collection/collection.hpp"
#include "ncp/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using ::testing::HasSubstr;

// Catches a choice that is not said, and false convergence of any member of the family behind it.
TEST(Auto, SolvesTheCollectionAndSaysHow) {
  for (const collection::Entry& entry : collection::entries()) {
    const collection::Problem problem = entry.make();
    for (std::size_t k = 0; k < problem.starts.size(); ++k) {
      const std::string what = std::string(entry.name) + " from start " + std::to_string(k + 1);
      const Result result = solve(*problem.mcp, problem.starts[k], Auto{});
      EXPECT_EQ(result.solved(), problem.no_solution.empty()) << what << ": " << result;
      EXPECT_TRUE(!result.solved() || support::violation(*problem.mcp, result.x) <= 1e-8) << what;
      EXPECT_TRUE(result.stats.iterations == 0 || result.message.find("auto chose") != std::string::npos) << what;
      EXPECT_TRUE(result.solved() || !problem.mcp->is_affine() || result.status == Status::Infeasible) << what;
    }
  }
}

TEST(Auto, ChoosesByClassAndBasis) {
  const auto affine = collection::find("cottle2")->make();
  EXPECT_THAT(solve(*affine.mcp, Vec::Zero(2), Auto{}).message,
              HasSubstr("auto chose the linear methods (the problem is affine)"));
  const auto nonlinear = make_mcp(support::kojima_shindo());
  EXPECT_THAT(solve(*nonlinear, Vec::Zero(4), Auto{}).message, HasSubstr("auto chose path (nonlinear, 4 variables)"));
  const auto symmetric = collection::find("bratu-own")->make();
  EXPECT_THAT(solve(*symmetric.mcp, symmetric.starts[0], Auto{.large = 100}).message,
              HasSubstr("a symmetric Jacobian: quadratic programs"));
  Auto warm;
  warm.path.basis.assign(2, lcp::Cell::Inside);
  EXPECT_THAT(solve(*affine.mcp, Vec::Zero(2), warm).message, HasSubstr("auto chose path (a warm basis is given)"));
  warm.path.basis.assign(3, lcp::Cell::Inside);
  EXPECT_THROW(solve(*affine.mcp, Vec::Zero(2), warm), std::invalid_argument);
}

// x^2 + 1 = 0 has no solution: every method gets its turn, within the limits together. Catches attempts that each take
// the whole budget, and records whose counters begin anew.
TEST(Auto, OneBudgetForAllAttempts) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return x * x + 1; }, [](double x) { return 2 * x; }));
  for (const int limit : {1, 7, 50, 1000}) {
    std::vector<Iteration> records;
    const Result result = solve(*mcp, vec({1}), Auto{.stop = {.max_iterations = limit}}, record(records));
    EXPECT_FALSE(result.solved());
    EXPECT_LE(result.stats.iterations, limit);
    EXPECT_FALSE(result.advice.empty());
    for (std::size_t i = 1; i < records.size(); ++i) {
      EXPECT_GE(records[i].k, records[i - 1].k) << limit;
      EXPECT_GE(records[i].F_evals, records[i - 1].F_evals) << limit;
    }
  }
  const Result few = solve(*mcp, vec({1}), Auto{.stop = {.max_F_evals = 40}});
  EXPECT_FALSE(few.solved());
  EXPECT_LT(few.stats.F_evals, 40 + 60);  // a search is not interrupted
  EXPECT_LT(few.stats.F_evals, solve(*mcp, vec({1}), Auto{}).stats.F_evals);
}

TEST(Auto, StopsWhenAsked) {
  const auto mcp = make_mcp(support::billups());
  for (int last = 0; last < 12; ++last) {
    int seen = 0;
    const Result result =
        solve(*mcp, vec({0}), Auto{}, [&](const Iteration&) { return seen++ == last ? Next::Stop : Next::Continue; });
    EXPECT_TRUE(result.status == Status::Interrupted || result.solved()) << result;
    EXPECT_LE(seen, last + 2) << "records after the stop";
  }
}

// Rounding leaves 1e-16 of the data: a residual of 1e-8 cannot be asked for where q is 1e9.
TEST(Auto, ToleranceOfBadlyScaledAffineProblems) {
  lcp::AffineMcp problem{
      .M = SpMat(3, 3), .q = vec({-1e12, 3e11, -7e11}), .box = {Vec::Zero(3), Vec::Constant(3, infinity)}};
  problem.M.insert(0, 0) = 3.3;
  problem.M.insert(0, 1) = 0.7;
  problem.M.insert(1, 1) = 1.1;
  problem.M.insert(2, 2) = 2.7;
  problem.M.insert(2, 0) = 0.1;
  problem.M.makeCompressed();
  const Result result = solve(*make_affine_mcp(problem, "large"), Vec::Zero(3), Auto{});
  EXPECT_TRUE(result.solved()) << result;
  EXPECT_LE(result.residual.natural, 1);
}

}  // namespace
}  // namespace perp::ncp
