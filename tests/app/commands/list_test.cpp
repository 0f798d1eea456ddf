// SPDX-License-Identifier: Apache-2.0
/// `perp list`, against the collection itself.
#include "app/commands/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "app/json.hpp"
#include "app/support.hpp"
#include "collection/collection.hpp"

namespace perp::app {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;

// Would catch a problem left out, and lines that a terminal of 120 columns breaks.
TEST(List, TableNamesEveryProblem) {
  test::Captured captured;
  EXPECT_EQ(list({}, captured.streams), exit_solved);
  ASSERT_FALSE(ncp::collection::entries().empty());
  for (const ncp::collection::Entry& entry : ncp::collection::entries()) {
    std::string line_start("\n");
    line_start.append(entry.name).append(" ");
    EXPECT_THAT(captured.out.str(), HasSubstr(line_start));
    EXPECT_THAT(captured.out.str(), HasSubstr(std::string(entry.hard.substr(0, 12))));
  }
  std::istringstream lines(captured.out.str());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120U) << line;
  EXPECT_EQ(captured.err.str(), "");
}

std::set<std::string> listed(const std::vector<std::string>& classes) {
  test::Captured captured;
  EXPECT_EQ(list({.classes = classes, .json = true}, captured.streams), exit_solved) << captured.err.str();
  std::set<std::string> names;
  const Json json = parse_json(captured.out.str());
  for (const auto& problem : json.at("problems")) names.insert(problem.at("name").get<std::string>());
  return names;
}

// Would catch a class that takes others along, and of several classes only one.
TEST(List, OfSomeClasses) {
  std::set<std::string> expected;
  for (const ncp::collection::Entry& entry : ncp::collection::entries())
    if (entry.problem_class == "games" || entry.problem_class == "kkt") expected.emplace(entry.name);
  EXPECT_EQ(listed({"games,kkt"}), expected);
  EXPECT_EQ(listed({"kkt", "games"}), expected);
  EXPECT_EQ(listed({}).size(), ncp::collection::entries().size());
  test::Captured table;
  EXPECT_EQ(list({.classes = {"games"}}, table.streams), exit_solved);
  EXPECT_THAT(table.out.str(), HasSubstr("\nnash10 "));
  EXPECT_THAT(table.out.str(), testing::Not(HasSubstr("\nkojshin ")));
}

TEST(List, UnknownClassIsAnInputErrorWithSuggestion) {
  test::Captured captured;
  EXPECT_EQ(list({.classes = {"lcp,gams"}}, captured.streams), exit_input);
  EXPECT_EQ(captured.out.str(), "");
  EXPECT_THAT(captured.err.str(), testing::AllOf(HasSubstr("'gams'"), HasSubstr("'games'"), HasSubstr("tiny")));
  for (const ListRequest& wrong : {ListRequest{.classes = {""}}, ListRequest{.name = "kojshin", .classes = {"tiny"}}}) {
    test::Captured refused;
    EXPECT_EQ(list(wrong, refused.streams), exit_input);
    EXPECT_THAT(refused.err.str(), HasSubstr("--class"));
  }
}

// kojshin: eight starts and two solutions, (sqrt6/2, 0, 0, 1/2) and (1, 0, 3, 0) (Kojima & Shindo 1986).
TEST(List, OneProblemWithStartsAndSolutions) {
  test::Captured captured;
  EXPECT_EQ(list({.name = "kojshin"}, captured.streams), exit_solved);
  for (const char* part :
       {"8 starts", "2 known solutions", "start 8", "solution 2", "1.224745", "natural residual", "source"})
    EXPECT_THAT(captured.out.str(), HasSubstr(part));
}

// Would catch sizes that nobody can find: the mark, the syntax below the table, arguments and limits of one problem.
TEST(List, SaysWhichComeInAnySize) {
  test::Captured all;
  EXPECT_EQ(list({}, all.streams), exit_solved);
  EXPECT_THAT(all.out.str(), testing::AllOf(testing::ContainsRegex("\nwalras-own +100 +any "),
                                            testing::ContainsRegex("\nwalras-own-1000 +1000 +economics"),
                                            HasSubstr("NAME:SIZE[xSIZE...][:SEED]")));
  test::Captured one;
  EXPECT_EQ(list({.name = "walras-own"}, one.streams), exit_solved);
  for (const char* part : {"walras-own:GOODSxSECTORSxHOUSEHOLDS[:SEED], as in walras-own:400x300x300:7",
                           "goods from 4 to 10000000, sectors from 1", "seed"})
    EXPECT_THAT(one.out.str(), HasSubstr(part));
  test::Captured other;
  EXPECT_EQ(list({.name = "kojshin"}, other.streams), exit_solved);
  EXPECT_THAT(other.out.str(), testing::Not(HasSubstr("sizes")));
  test::Captured json;
  ASSERT_EQ(list({.name = "obstacle", .json = true}, json.streams), exit_solved);
  EXPECT_EQ(parse_json(json.out.str()).at("any_size"), "obstacle:MxN");
}

// Would catch a problem without solution that looks like one whose solutions are merely not known.
TEST(List, SaysWhereThereIsNoSolution) {
  test::Captured one;
  EXPECT_EQ(list({.name = "infeasible-own"}, one.streams), exit_solved);
  EXPECT_THAT(one.out.str(), HasSubstr("There is no solution: F_1 + F_2 = -1/2"));
  test::Captured json;
  ASSERT_EQ(list({.name = "infeasible-own", .json = true}, json.streams), exit_solved);
  EXPECT_NE(parse_json(json.out.str()).at("no_solution"), "");
  test::Captured all;
  EXPECT_EQ(list({}, all.streams), exit_solved);
  EXPECT_THAT(all.out.str(), HasSubstr("none"));
}

// Would catch numbers printed with too few digits, infinities as null, residuals not of the solution they stand by.
TEST(List, JsonHasAllDigits) {
  test::Captured captured;
  ASSERT_EQ(list({.name = "kojshin", .json = true}, captured.streams), exit_solved);
  const Json json = parse_json(captured.out.str());
  const ncp::collection::Problem problem = ncp::collection::find("kojshin")->make();
  EXPECT_EQ(json.at("upper").at(0), "inf");
  EXPECT_EQ(json.at("lower").at(0), 0.0);
  ASSERT_EQ(json.at("known_solutions").size(), problem.solutions.size());
  for (std::size_t k = 0; k < problem.solutions.size(); ++k) {
    const auto& known = json.at("known_solutions").at(k);
    for (ncp::Index i = 0; i < 4; ++i)
      EXPECT_EQ(known.at("x").at(static_cast<std::size_t>(i)).get<double>(), problem.solutions[k].x[i]);
    EXPECT_LT(known.at("residual").at("natural").get<double>(), 1e-6);
  }
}

TEST(List, JsonOfAll) {
  test::Captured captured;
  ASSERT_EQ(list({.json = true}, captured.streams), exit_solved);
  const Json json = parse_json(captured.out.str());
  ASSERT_EQ(json.at("problems").size(), ncp::collection::entries().size());
  for (const auto& problem : json.at("problems"))
    for (const char* key :
         {"name", "size", "any_size", "class", "starts", "known_solutions", "solutions_complete", "hard", "source"})
      EXPECT_TRUE(problem.contains(key)) << problem << key;
}

TEST(List, UnknownNameIsAnInputErrorWithSuggestion) {
  test::Captured captured;
  EXPECT_EQ(list({.name = "kojshim"}, captured.streams), exit_input);
  EXPECT_EQ(captured.out.str(), "");
  EXPECT_THAT(captured.err.str(), testing::AllOf(HasSubstr("'kojshim'"), HasSubstr("'kojshin'")));
}

}  // namespace
}  // namespace perp::app
