// SPDX-License-Identifier: Apache-2.0
/// The JSON of docs/schema/: parsed back and compared with the result it came from.
#include "app/report/json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>

#include "app/json.hpp"
#include "app/support.hpp"
#include "lcp/gpl.hpp"

namespace perp::app {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;

Report report_of(const LoadedProblem& problem, const std::vector<Assignment>& options = {}) {
  return run_method(problem, apply_options(options).settings);
}

// Would catch a missing key, numbers cut to six digits, null in place of infinities.
TEST(Json, EveryKeyAndEveryDigit) {
  const LoadedProblem problem = load_problem("kojshin", 2);
  const Report report = report_of(problem);
  const Json parsed = parse_json(solve_json(report));
  for (const char* key : {"program", "version", "schema", "problem", "start", "size", "method", "status", "exit_code",
                          "message", "advice", "notes", "residual", "stats", "options", "variables", "iterations"})
    EXPECT_TRUE(parsed.contains(key)) << key;
  EXPECT_EQ(parsed["problem"], "kojshin");
  EXPECT_EQ(parsed["start"], 2);
  EXPECT_EQ(parsed["status"], "Solved");
  EXPECT_EQ(parsed["exit_code"], 0);
  EXPECT_EQ(parsed["residual"]["natural"].get<double>(), report.result.residual.natural);
  for (const char* key : {"worst", "worst_index", "bounds", "complementarity"})
    EXPECT_TRUE(parsed["residual"].contains(key)) << key;

  const Json& variables = parsed["variables"];
  ASSERT_EQ(variables.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto index = static_cast<ncp::Index>(i);
    EXPECT_EQ(variables[i]["value"].get<double>(), report.result.x[index]);
    EXPECT_EQ(variables[i]["F"].get<double>(), report.result.F[index]);
    EXPECT_EQ(variables[i]["lower"], 0.0);
    EXPECT_EQ(variables[i]["upper"], "inf");
    EXPECT_EQ(variables[i]["name"], problem.mcp->variable_name(index));
    EXPECT_EQ(variables[i]["equation"], problem.mcp->equation_name(index));
  }
}

TEST(Json, IterationsAreTheRecords) {
  const LoadedProblem problem = load_problem("kojshin");
  const Report report = report_of(problem, {{"method", "josephy", "test"}});
  const Json parsed = parse_json(solve_json(report));
  ASSERT_GT(report.iterations.size(), 1U);
  ASSERT_EQ(parsed["iterations"].size(), report.iterations.size());
  int pivots = 0;
  for (std::size_t k = 0; k < report.iterations.size(); ++k) {
    const ncp::Iteration& it = report.iterations[k];
    const Json& written = parsed["iterations"][k];
    EXPECT_EQ(written["k"], it.k);
    EXPECT_EQ(written["residual"].get<double>(), it.residual);
    EXPECT_EQ(written["merit"].get<double>(), it.merit);
    EXPECT_EQ(written["step"].get<double>(), it.step);
    EXPECT_EQ(written["prox"].get<double>(), it.prox);
    EXPECT_EQ(written["pivots"], it.pivots);
    EXPECT_EQ(written["backtracks"], it.backtracks);
    EXPECT_EQ(written["F_evals"], it.F_evals);
    EXPECT_EQ(written["J_evals"], it.J_evals);
    EXPECT_EQ(written["kind"], std::string(1, it.kind));
    EXPECT_EQ(written["worst_index"], it.worst);
    EXPECT_EQ(written["worst"], problem.mcp->equation_name(it.worst));
    pivots += it.pivots;
  }
  EXPECT_EQ(parsed["stats"]["pivots"], report.result.stats.pivots);
  EXPECT_GT(pivots, 0);
  EXPECT_EQ(parsed["options"]["method"], "josephy");
  EXPECT_EQ(parsed["options"]["lemke_start"], "automatic");
  EXPECT_FALSE(parsed["options"].contains("linear_solver")) << "that one is not josephy's";
}

// Smoothing's parameter, which is no prox; others have none.
TEST(Json, MuOfSmoothing) {
  const LoadedProblem problem = load_problem("kojshin");
  for (const char* method : {"smooth", "gsl-hybridsj", "josephy"}) {
    if (lcp::left_out(method)) continue;
    const Report report = report_of(problem, {{"method", method, "test"}});
    const Json parsed = parse_json(solve_json(report));
    ASSERT_GT(report.iterations.size(), 1U);
    double largest = 0;
    for (std::size_t k = 0; k < report.iterations.size(); ++k) {
      ASSERT_TRUE(parsed["iterations"][k].contains("mu"));
      EXPECT_EQ(parsed["iterations"][k]["mu"].get<double>(), report.iterations[k].mu);
      largest = std::max(largest, report.iterations[k].mu);
    }
    EXPECT_EQ(largest > 0, method != std::string_view("josephy")) << method;
  }
}

// Everything Stats has, under its own name. Would catch a count left out, or written under another's name.
TEST(Json, StatsAreComplete) {
  const LoadedProblem problem = load_problem("kojshin");
  Report report;
  report.problem = &problem;
  report.result.x = ncp::Vec::Zero(4);
  ncp::Stats& stats = report.result.stats;
  stats = {.iterations = 1,
           .crash_iterations = 2,
           .F_evals = 3,
           .J_evals = 4,
           .factorizations = 5,
           .pivots = 6,
           .restarts = 7,
           .gradient_steps = 8,
           .watchdogs = 9,
           .unchecked_steps = 10,
           .chord_steps = 11,
           .backtracks = 12,
           .ray_starts = 13,
           .rank_deficient = 14,
           .proximal_steps = 15,
           .linear_time = std::chrono::duration<double>(16),
           .time = std::chrono::duration<double>(17)};
  stats.presolved = 18;
  stats.krylov_iterations = 19;
  stats.J_colours = 20;
  stats.J_F_evals = 21;
  const Json written = parse_json(solve_json(report))["stats"];
  const std::vector<const char*> keys{
      "iterations",        "crash_iterations", "F_evals",        "J_evals",         "factorizations", "pivots",
      "restarts",          "gradient_steps",   "watchdogs",      "unchecked_steps", "chord_steps",    "backtracks",
      "ray_starts",        "rank_deficient",   "proximal_steps", "linear_time_s",   "time_s",         "presolved",
      "krylov_iterations", "J_colours",        "J_F_evals"};
  EXPECT_EQ(written.size(), keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k) EXPECT_EQ(written.at(keys[k]), static_cast<int>(k + 1)) << keys[k];
}

// Crash, linear problems and restarts in the records.
TEST(Json, IterationsOfPathSearch) {
  LoadedProblem problem = load_problem("kojshin");
  Report report;
  report.problem = &problem;
  report.result.x = ncp::Vec::Zero(4);
  report.iterations = {{.k = 0, .kind = 'I', .crash = true},
                       {.k = 0, .kind = 'C', .crash = true, .changes = 3, .inside = 2},
                       {.k = 1, .kind = 'D', .linear = 'S'},
                       {.k = 1, .kind = 'R', .attempt = "no crash"}};
  const Json written = parse_json(solve_json(report))["iterations"];
  EXPECT_EQ(written[1]["changes"], 3);
  EXPECT_EQ(written[1]["inside"], 2);
  EXPECT_EQ(written[1]["crash"], true);
  EXPECT_TRUE(written[1]["linear"].is_null() && written[2]["changes"].is_null() && written[2]["attempt"].is_null());
  EXPECT_EQ(written[2]["linear"], "S");
  EXPECT_EQ(written[2]["crash"], false);
  EXPECT_EQ(written[3]["attempt"], "no crash");
}

// The values JSON has no numbers for, in every place a result can have them.
TEST(Json, InfinitiesAndNaN) {
  LoadedProblem problem = load_problem("kojshin");
  Report report;
  report.problem = &problem;
  report.result.x = ncp::Vec::Zero(4);
  report.result.F = ncp::Vec::Constant(4, std::numeric_limits<double>::quiet_NaN());
  report.result.F[1] = -ncp::infinity;
  report.result.residual = {.natural = ncp::infinity, .worst = -1};
  const Json parsed = parse_json(solve_json(report));
  EXPECT_EQ(parsed["residual"]["natural"], "inf");
  EXPECT_TRUE(parsed["residual"]["worst"].is_null());
  EXPECT_TRUE(parsed["residual"]["worst_index"].is_null());
  EXPECT_EQ(parsed["variables"][0]["F"], "nan");
  EXPECT_EQ(parsed["variables"][1]["F"], "-inf");
}

// A result whose F is empty (nothing could be evaluated) is still written, as is a message that is no UTF-8.
TEST(Json, BrokenResultsAreWritten) {
  LoadedProblem problem = load_problem("kojshin");
  Report report;
  report.problem = &problem;
  report.result.x = ncp::Vec::Zero(4);
  report.result.message = "bad byte \xFF";
  const Json parsed = parse_json(solve_json(report));
  EXPECT_EQ(parsed["variables"][3]["F"], "nan");
  EXPECT_THAT(parsed["message"].get<std::string>(), HasSubstr("bad byte"));
  EXPECT_EQ(parsed["exit_code"], 1);
}

TEST(Json, StatesOfVariables) {
  const ncp::Box box{.lower = Eigen::VectorXd{{0, 0, -ncp::infinity, 1, -ncp::infinity}},
                     .upper = Eigen::VectorXd{{1, 1, ncp::infinity, 1, 5}}};
  EXPECT_EQ(state_name(box, 0, 1e-9, 1e-8), "at lower");
  EXPECT_EQ(state_name(box, 0, 1e-7, 1e-8), "basic");
  EXPECT_EQ(state_name(box, 1, 1 - 1e-9, 1e-8), "at upper");
  EXPECT_EQ(state_name(box, 2, 0, 1e-8), "free");
  EXPECT_EQ(state_name(box, 3, 1, 1e-8), "fixed");
  EXPECT_EQ(state_name(box, 4, 5, 1e-8), "at upper");
  EXPECT_EQ(state_name(box, 4, 0, 1e-8), "basic");
}

TEST(Json, RefusedInput) {
  const Json parsed = parse_json(refused_json("x.nl", "x.nl:3: \"why\""));
  EXPECT_EQ(parsed["status"], "InputError");
  EXPECT_EQ(parsed["exit_code"], 2);
  EXPECT_EQ(parsed["message"], "x.nl:3: \"why\"");
  EXPECT_EQ(parsed["problem"], "x.nl");
}

// Would catch leftovers of the neighbour file, a link replaced by a file, lost permissions.
TEST(WriteFile, WholeOrNotAtAll) {
  const test::Folder folder;
  write_file(folder / "a", "one");
  write_file(folder / "a", "two");
  EXPECT_EQ(test::read(folder / "a"), "two");
  std::filesystem::permissions(folder / "a", std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("a", folder / "link");
  write_file(folder / "link", "three");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(test::read(folder / "a"), "three");
  struct stat status {};
  ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "")) ++files;
  EXPECT_EQ(files, 2);
}

TEST(WriteFile, FailuresNameTheFile) {
  const test::Folder folder;
  for (const std::string& path : {folder / "no/such/folder/x.json", folder / "", std::string("/dev/full")}) {
    try {
      write_file(path, "text");
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path));
    }
  }
  std::filesystem::create_symlink("nowhere", folder / "dangling");
  EXPECT_NO_THROW(write_file(folder / "dangling", "text"));
}

}  // namespace
}  // namespace perp::app
