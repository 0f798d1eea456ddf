// SPDX-License-Identifier: Apache-2.0
/// `perp solve --all`: what it prints, answers and writes.
#include "app/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "app/commands/solve.hpp"
#include "app/json.hpp"
#include "app/support.hpp"

namespace perp::app {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;
using testing::Not;

TEST(Several, CountsOfTheCommandLine) {
  EXPECT_EQ(parse_solutions(""), 10);
  EXPECT_EQ(parse_solutions("3"), 3);
  for (const char* bad : {"0", "-1", "kojshin", "2x", "1e3", "99999999999"})
    EXPECT_THROW(parse_solutions(bad), InputError) << bad;
}

// The two solutions of Kojima & Shindo side by side, with their residuals; the log is that of the first solve. Catches
// thousands of lines of deflation's iterations, and a list that passes for complete.
TEST(Several, PrintsSolutionsSideBySide) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .all = 10}, captured.streams), exit_solved);
  const std::string out = captured.out.str();
  EXPECT_THAT(out, HasSubstr("2 solutions after"));
  EXPECT_THAT(out, HasSubstr("attempts of deflation"));
  EXPECT_THAT(out, HasSubstr("need not be complete"));
  EXPECT_THAT(out, HasSubstr("  1: natural residual"));
  EXPECT_THAT(out, HasSubstr("  2: natural residual"));
  EXPECT_THAT(out, HasSubstr("sigma"));
  EXPECT_THAT(out, HasSubstr("1.224745"));
  EXPECT_LT(std::count(out.begin(), out.end(), '\n'), 80);
}

// Kehoe's three equilibria as JSON: each with x, F and its residual.
TEST(Several, JsonHoldsEverySolution) {
  test::Captured captured;
  const SolveRequest request{.problem = "kehoe", .flags = {{"method", "path", "--method"}}, .json = "-", .all = 10};
  EXPECT_EQ(solve(request, captured.streams), exit_solved);
  const Json parsed = parse_json(captured.out.str());
  ASSERT_EQ(parsed["solutions"].size(), 3U);
  EXPECT_EQ(parsed["solutions_complete"], false);
  EXPECT_EQ(parsed["exit_code"], 0);
  EXPECT_GT(parsed["deflation"]["attempts"], 0);
  EXPECT_EQ(parsed["deflation"]["asked"], 10);
  std::vector<double> h;
  for (const Json& solution : parsed["solutions"]) {
    EXPECT_LE(solution["residual"]["natural"].get<double>(), 1e-6);
    EXPECT_EQ(solution["x"].size(), 10U);
    EXPECT_EQ(solution["F"].size(), 10U);
    EXPECT_TRUE(solution["singular"].is_null());
    h.push_back(solution["x"][9]);
  }
  std::sort(h.begin(), h.end());
  EXPECT_NEAR(h[0], 24.16, 0.01);
  EXPECT_NEAR(h[1], 40, 0.01);
  EXPECT_NEAR(h[2], 138.48, 0.01);
  EXPECT_EQ(parsed["solutions"][0]["found_by"], "path");
  EXPECT_EQ(parsed["variables"][9]["value"], parsed["solutions"][0]["x"][9]);
}

// found_by is the name that was asked for, also where several presets are one method. Catches semicomp told as
// semismooth.
TEST(Several, FoundByTheMethodAskedFor) {
  for (const char* method :
       {"auto", "semicomp", "semismooth-min", "newton-min", "qpcomp", "proxi", "miles", "josephy"}) {
    test::Captured captured;
    const SolveRequest request{
        .problem = "kojshin", .start = 2, .flags = {{"method", method, "--method"}}, .json = "-", .all = 1};
    EXPECT_EQ(solve(request, captured.streams), exit_solved) << method;
    EXPECT_EQ(parse_json(captured.out.str())["solutions"][0]["found_by"], method);
  }
}

// As many as asked for, and not one more.
TEST(Several, StopsAtTheNumberAskedFor) {
  for (const int asked : {1, 2}) {
    test::Captured captured;
    EXPECT_EQ(solve({.problem = "kehoe", .json = "-", .all = asked}, captured.streams), exit_solved);
    EXPECT_EQ(parse_json(captured.out.str())["solutions"].size(), static_cast<std::size_t>(asked));
  }
}

TEST(Several, WithoutASolutionNothingIsDeflated) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::infeasible_nl());
  test::Captured captured;
  EXPECT_EQ(solve({.problem = folder / "m.nl", .json = folder / "out.json", .all = 5}, captured.streams),
            exit_unsolved);
  EXPECT_THAT(captured.out.str(), HasSubstr("0 solutions after 0 attempts of deflation"));
  EXPECT_TRUE(parse_json(test::read(folder / "out.json"))["solutions"].empty());
}

// Without --all there are no such keys and lines.
TEST(Several, OnlyWhereAskedFor) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .json = "-"}, captured.streams), exit_solved);
  EXPECT_FALSE(parse_json(captured.out.str()).contains("solutions"));
  EXPECT_THAT(captured.err.str(), Not(HasSubstr("deflation")));
}

// Enumeration has its own list.
TEST(Several, RefusesEnumeration) {
  test::Captured captured;
  const SolveRequest request{.problem = "murty", .flags = {{"method", "enumeration", "--method"}}, .all = 2};
  EXPECT_EQ(solve(request, captured.streams), exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("enumeration"));
}

}  // namespace
}  // namespace perp::app
