// SPDX-License-Identifier: Apache-2.0
/// Warm starts from the JSON of an earlier run: what is read, what is refused, and that it saves pivots.
#include "app/problem/warm_start.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/commands/solve.hpp"
#include "app/json.hpp"
#include "app/report/json.hpp"
#include "app/support.hpp"
#include "lcp/io/file_error.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::app {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;

/// An obstacle problem on n points, pushed down by `load`: M tridiagonal (-1, 2, -1), an M-matrix, q = load h^2 - ...
LoadedProblem obstacle(int n, double load) {
  ncp::SpMat M(n, n);
  ncp::Vec q(n);
  for (int i = 0; i < n; ++i) {
    M.insert(i, i) = 2;
    if (i > 0) M.insert(i - 1, i) = -1;
    if (i + 1 < n) M.insert(i + 1, i) = -1;
    q[i] = i < n / 2 ? -load : load;
  }
  M.makeCompressed();
  LoadedProblem problem{.label = "obstacle", .mcp = nullptr, .x0 = ncp::Vec::Zero(n)};
  problem.mcp = ncp::make_affine_mcp({.M = M, .q = q, .box = ncp::Box::nonnegative(n)}, "obstacle");
  return problem;
}

const std::vector<Assignment> by_pivots{
    {"method", "path", "test"}, {"crash_method", "none", "test"}, {"preprocess", "no", "test"}};

/// A result with a basis, as JSON.
Json result_with_basis(const LoadedProblem& problem) {
  return parse_json(solve_json(run_method(problem, apply_options(by_pivots).settings)));
}

std::string refusal(const std::string& path, const ncp::Mcp& mcp) {
  try {
    read_warm_start(path, mcp);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Would catch values that lose digits, a basis in another order, cells under exchanged names.
TEST(WarmStart, ReadsWhatWasWritten) {
  const test::Folder folder;
  const LoadedProblem problem = obstacle(20, 1);
  const Report report = run_method(problem, apply_options(by_pivots).settings);
  ASSERT_TRUE(report.result.solved());
  ASSERT_EQ(report.result.basis.size(), 20U);
  test::write(folder / "r.json", solve_json(report));
  const WarmStart warm = read_warm_start(folder / "r.json", *problem.mcp);
  EXPECT_EQ(warm.x, report.result.x);
  EXPECT_EQ(warm.basis, report.result.basis);
  const Json parsed = parse_json(test::read(folder / "r.json"));
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_EQ(parsed["variables"][i]["basis"], report.result.x[static_cast<ncp::Index>(i)] > 0 ? "inside" : "below");
}

// What warm starts are for. Would catch a basis that does not reach the method, or is worse than none.
TEST(WarmStart, SavesPivotsOnANearbyProblem) {
  const test::Folder folder;
  test::write(folder / "r.json", result_with_basis(obstacle(60, 1)).dump());
  LoadedProblem nearby = obstacle(60, 1.03);
  Applied options = apply_options(by_pivots);
  const Report cold = run_method(nearby, options.settings);
  set_warm_start(read_warm_start(folder / "r.json", *nearby.mcp), nearby, options);
  EXPECT_THAT(options.notes, testing::IsEmpty());
  EXPECT_EQ(options.settings.basis.size(), 60U);
  const Report warm = run_method(nearby, options.settings);
  ASSERT_TRUE(cold.result.solved() && warm.result.solved());
  EXPECT_GT(cold.result.stats.pivots, 8);
  EXPECT_LT(warm.result.stats.pivots, cold.result.stats.pivots / 4);
}

// A cell that is a list in a list, a million deep. Would catch a message that writes it out, a call a level: the
// stack's end.
TEST(WarmStart, DeepJsonIsRefused) {
  const LoadedProblem problem = obstacle(1, 1);
  constexpr std::size_t deep = 1'000'000;
  const std::string text =
      R"({"variables":[{"name":"x[1]","value":1,"basis":)" + std::string(deep, '[') + std::string(deep, ']') + "}]}";
  EXPECT_THROW(parse_warm_start(text, "r.json", *problem.mcp), InputError);
}

TEST(WarmStart, WhatIsNoResultOfThisProblemIsRefused) {
  const test::Folder folder;
  const LoadedProblem problem = obstacle(6, 1);
  const Json good = result_with_basis(problem);
  const auto refused = [&](const Json& content) {
    test::write(folder / "r.json", content.dump());
    return refusal(folder / "r.json", *problem.mcp);
  };
  ASSERT_EQ(refused(good), "");
  Json bad = good;
  bad["variables"].erase(5);
  EXPECT_THAT(refused(bad), testing::AllOf(HasSubstr("r.json"), HasSubstr("5 variables"), HasSubstr("6")));
  bad = good;
  bad["variables"][2]["name"] = "price";
  EXPECT_THAT(refused(bad), testing::AllOf(HasSubstr("price"), HasSubstr(problem.mcp->variable_name(2))));
  for (const Json& value : {Json("inf"), Json(nullptr), Json("1")}) {
    bad = good;
    bad["variables"][3]["value"] = value;
    EXPECT_THAT(refused(bad), testing::AllOf(HasSubstr(problem.mcp->variable_name(3)), HasSubstr("finite number")));
  }
  for (const Json& cell : {Json("between"), Json(3)}) {
    bad = good;
    bad["variables"][4]["basis"] = cell;
    EXPECT_THAT(refused(bad), testing::AllOf(HasSubstr(problem.mcp->variable_name(4)), HasSubstr("inside")));
  }
  for (const int k : {0, 5}) {
    bad = good;
    bad["variables"][static_cast<std::size_t>(k)].erase("basis");
    EXPECT_THAT(refused(bad), HasSubstr("others have none"));
  }
  bad = good;
  for (Json& variable : bad["variables"]) variable.erase("basis");
  EXPECT_EQ(refused(bad), "") << "a run without a basis gives its point";
  EXPECT_THAT(refused(parse_json(refused_json("x.nl", "why"))), HasSubstr("no result"));
  EXPECT_THAT(refused(Json::array()), HasSubstr("no result"));
  test::write(folder / "r.json", "{ not JSON");
  EXPECT_THAT(refusal(folder / "r.json", *problem.mcp), HasSubstr("no result"));
  EXPECT_THROW(read_warm_start(folder / "none.json", *problem.mcp), lcp::FileError);
}

// A parametric sweep may add or take away bounds: lemke() has no cell below a bound that is gone.
TEST(WarmStart, CellsFollowTheBoundsOfTheNewProblem) {
  LoadedProblem problem{.label = "p", .mcp = nullptr, .x0 = ncp::Vec::Zero(4)};
  problem.mcp = ncp::make_mcp({.name = "p",
                               .box = {.lower = Eigen::VectorXd{{-ncp::infinity, 0, 2, 0}},
                                       .upper = Eigen::VectorXd{{ncp::infinity, 1, 2, ncp::infinity}}},
                               .pattern = ncp::dense_pattern(4),
                               .F = [](ncp::In, const ncp::Out&) { return true; },
                               .J = [](ncp::In, ncp::SpMat&) { return true; }});
  Applied options = apply_options({});
  using lcp::Cell;
  set_warm_start({.x = Eigen::VectorXd{{0, 1, 2, 5}}, .basis = {Cell::Below, Cell::Above, Cell::Inside, Cell::Above}},
                 problem, options);
  EXPECT_EQ(options.settings.basis, (std::vector{Cell::Inside, Cell::Above, Cell::Fixed, Cell::Inside}));
  EXPECT_EQ(problem.x0[3], 5);
  EXPECT_THAT(options.notes, testing::ElementsAre(HasSubstr("3 variables")));

  const std::vector<Assignment> other{{"method", "semismooth", "test"}};
  Applied semismooth = apply_options(other);
  set_warm_start({.x = Eigen::VectorXd{{0, 1, 2, 5}}, .basis = {Cell::Below, Cell::Above, Cell::Inside, Cell::Above}},
                 problem, semismooth);
  EXPECT_THAT(semismooth.notes, testing::ElementsAre(HasSubstr("without the basis")));
}

// From file to file through the command.
TEST(WarmStart, OnTheCommand) {
  const test::Folder folder;
  test::Captured first;
  ASSERT_EQ(solve({.problem = "josephy", .json = folder / "r.json"}, first.streams), exit_solved);
  test::Captured second;
  ASSERT_EQ(solve({.problem = "josephy", .json = "-", .warm_start = folder / "r.json"}, second.streams), exit_solved);
  EXPECT_EQ(parse_json(second.out.str())["stats"]["iterations"], 0);
  for (const SolveRequest& request :
       {SolveRequest{.problem = "josephy", .start = 2, .warm_start = folder / "r.json"},
        SolveRequest{.problem = "josephy", .start_at = "x.mtx", .warm_start = folder / "r.json"},
        SolveRequest{.problem = "kojshin", .warm_start = folder / "none.json"},
        SolveRequest{.problem = "colvdual", .warm_start = folder / "r.json"}}) {
    test::Captured refused;
    EXPECT_EQ(solve(request, refused.streams), exit_input);
    EXPECT_EQ(refused.out.str(), "");
    EXPECT_THAT(refused.err.str(), testing::AnyOf(HasSubstr("--warm-start"), HasSubstr("none.json")));
  }
}

}  // namespace
}  // namespace perp::app
