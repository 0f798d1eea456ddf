// SPDX-License-Identifier: Apache-2.0
// The catalogue as a whole: what every entry promises.
#include <gmock/gmock.h>

#include <limits>
#include <set>

#include "each_entry.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp::collection {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

INSTANTIATE_TEST_SUITE_P(Collection, EachEntry, each_name(), test_name);

// Catches: a line of the table left half empty.
TEST_P(EachEntry, TellsSourceAndDifficulty) {
  EXPECT_FALSE(entry.problem_class.empty());
  EXPECT_GE(entry.source.size(), 10u);
  EXPECT_GE(entry.hard.size(), 10u);
}

// Catches: the table's size or name differing from the problem's; starts and solutions of another length.
TEST_P(EachEntry, SizesAgree) {
  const Problem problem = entry.make();
  ASSERT_TRUE(problem.mcp);
  EXPECT_TRUE(entry.name.starts_with(problem.mcp->name())) << problem.mcp->name();
  EXPECT_EQ(problem.mcp->size(), entry.size);
  ASSERT_FALSE(problem.starts.empty());
  for (const Vec& start : problem.starts) EXPECT_NO_THROW(check_input(*problem.mcp, start));
  for (const KnownSolution& solution : problem.solutions) EXPECT_EQ(solution.x.size(), entry.size);
}

// Catches: F not defined at a start, so that no method could begin; J left unfilled there.
TEST_P(EachEntry, IsDefinedAtItsStarts) {
  const Problem problem = entry.make();
  for (const Vec& start : problem.starts) {
    Vec F(start.size());
    EXPECT_TRUE(problem.mcp->eval(start, F)) << start.transpose();
    SpMat J = problem.mcp->jacobian_pattern();
    Eigen::Map<Vec>(J.valuePtr(), J.nonZeros()).setConstant(std::nan(""));
    EXPECT_TRUE(problem.mcp->jacobian(start, J)) << start.transpose();
    EXPECT_TRUE(Eigen::Map<Vec>(J.valuePtr(), J.nonZeros()).allFinite());
  }
}

/// What rounding leaves of F(x) = 0: some eps of the largest sum_j |J_ij x_j|.
double rounding(const Mcp& mcp, const Vec& x) {
  SpMat J = mcp.jacobian_pattern();
  if (!mcp.jacobian(x, J)) return 0;
  return 16 * std::numeric_limits<double>::epsilon() * (J.cwiseAbs() * x.cwiseAbs()).lpNorm<Eigen::Infinity>();
}

// Catches: a misprint in the formulas, the data or the solution: each solution is known independently of the code.
TEST_P(EachEntry, KnownSolutionsSolveIt) {
  const Problem problem = entry.make();
  for (const KnownSolution& solution : problem.solutions) {
    const Residual judged = residual(*problem.mcp, solution.x);
    EXPECT_LT(judged.natural, std::max(1e-12, rounding(*problem.mcp, solution.x)))
        << solution.label << ", worst in " << problem.mcp->equation_name(std::max<Index>(0, judged.worst));
    EXPECT_GE(solution.tol, 0) << solution.label;
    EXPECT_LE(solution.tol, 1e-6) << solution.label;
    EXPECT_FALSE(solution.label.empty());
  }
}

// Catches: solutions listed twice, a list of none that claims to be complete, a problem without solution that has one.
TEST_P(EachEntry, SolutionsAreDistinct) {
  const Problem problem = entry.make();
  EXPECT_EQ(problem.solutions_complete && problem.solutions.empty(), !problem.no_solution.empty());
  for (std::size_t i = 0; i < problem.solutions.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT((problem.solutions[i].x - problem.solutions[j].x).lpNorm<Eigen::Infinity>(), 1e-4);
}

// Catches: two unknowns or two rows under one name, which makes a log's blame worthless.
TEST_P(EachEntry, NamesOfUnknownsAndRowsAreUnique) {
  const Problem problem = entry.make();
  std::set<std::string> variables, equations;
  for (Index i = 0; i < entry.size; ++i) {
    EXPECT_TRUE(variables.insert(problem.mcp->variable_name(i)).second) << problem.mcp->variable_name(i);
    EXPECT_TRUE(equations.insert(problem.mcp->equation_name(i)).second) << problem.mcp->equation_name(i);
  }
}

// Catches: two problems under one name, of which find() would hide the second; the promised order.
TEST(Catalogue, IsSortedAndNamesAreUnique) {
  std::set<std::string_view> names;
  std::pair<std::string_view, std::string_view> previous;
  for (const Entry& entry : entries()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_EQ(find(entry.name), &entry);
    EXPECT_LT(previous, std::pair(entry.problem_class, entry.name));
    previous = {entry.problem_class, entry.name};
  }
}

// Catches: a start hidden from `--start k`, that is the published lists being cut short.
TEST(Catalogue, StartsAreThePublishedOnes) {
  EXPECT_EQ(find("kojshin")->make().starts.size(), 8u);
  EXPECT_EQ(find("josephy")->make().starts.size(), 8u);
  EXPECT_EQ(find("billups")->make().starts.size(), 5u);
  EXPECT_EQ(find("nash10")->make().starts.size(), 5u);
  EXPECT_EQ(find("kojshin")->make().starts[7], Vec({{1.25, 0, 0, 0.5}}));
  EXPECT_EQ(find("tinloi42")->make().starts[0], Vec::Constant(42, 0.4));
  const Vec hs117 = find("colvdual")->make().starts[0];
  EXPECT_EQ(hs117[6], 60);  // y[7]
  EXPECT_EQ(hs117.head(6), Vec::Constant(6, 0.001));
  EXPECT_EQ(hs117.tail(5), Vec::Zero(5));
}

// Catches: fixed variables, two-sided boxes and free variables lost on the way.
TEST(Catalogue, BoxesAreThePublishedOnes) {
  const Problem choi = find("choi")->make();
  EXPECT_EQ(choi.mcp->box().lower[7], 0.199);
  EXPECT_EQ(choi.mcp->box().upper[7], 0.199);
  const Problem hs34 = find("hs34-kkt")->make();
  EXPECT_EQ(hs34.mcp->box().upper, Vec({{100, 100, 10, infinity, infinity}}));
  const Problem kehoe = find("kehoe")->make();
  EXPECT_EQ(kehoe.mcp->box().lower, Vec({{0, 0, 1, 1e-4, 1e-4, 1e-4, -infinity, -infinity, -infinity, -infinity}}));
  EXPECT_EQ(kehoe.mcp->box().upper[2], 1);
  EXPECT_EQ(find("methan08")->make().mcp->box().lower, Vec::Constant(31, -infinity));
}

// Catches: hs34-kkt without the feature it is there for, an upper bound active with F < 0.
TEST(Catalogue, UpperBoundIsActiveInHs34) {
  const Problem problem = find("hs34-kkt")->make();
  Vec F(5);
  ASSERT_TRUE(problem.mcp->eval(problem.solutions[0].x, F));
  EXPECT_EQ(problem.solutions[0].x[2], problem.mcp->box().upper[2]);
  EXPECT_LT(F[2], -0.01);
}

TEST(Catalogue, FindsNothingUnderAnUnknownName) {
  EXPECT_EQ(find("kojshi"), nullptr);
  EXPECT_EQ(find(""), nullptr);
}

// Catches: no help for a slip of the finger, or help that offers everything.
TEST(Catalogue, SuggestsCloseNames) {
  EXPECT_THAT(similar("kojishin"), ElementsAre("kojshin"));
  EXPECT_THAT(similar("KOJSHIN"), ElementsAre("kojshin"));
  EXPECT_THAT(similar("nahs10"), Contains("nash10"));
  EXPECT_THAT(similar("walras"), ElementsAre("walras-own", "walras-own-1000"));
  EXPECT_THAT(similar("traveling-salesman"), IsEmpty());
  EXPECT_THAT(similar(""), IsEmpty());
}

}  // namespace
}  // namespace perp::ncp::collection
