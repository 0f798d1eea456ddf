// SPDX-License-Identifier: Apache-2.0
/// `perp solve` in process: what it prints, answers and writes.
#include "app/commands/solve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "app/json.hpp"
#include "app/report/report.hpp"
#include "app/support.hpp"

namespace perp::app {
namespace {

using test::is_json;
using test::Json;
using test::parse_json;
using testing::HasSubstr;
using testing::Not;

TEST(Solve, PrintsTableSolutionAndSummary) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "josephy"}, captured.streams), exit_solved);
  for (const char* part : {"josephy: 4 variables", "start 1 of 8", "major", "residual", "variable", "lower", "upper",
                           "state", "z[1]", "1.224745", "at lower", "basic", "Solved:", "Nearest known solution"})
    EXPECT_THAT(captured.out.str(), HasSubstr(part));
  EXPECT_EQ(captured.err.str(), "");
}

// sqrt(2) is the solution by hand; the model's names come from the .col and .row files.
TEST(Solve, ModelWithNames) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::write(folder / "m.col", "side_length\n");
  test::write(folder / "m.row", "area_balance\n");
  for (const char* name : {"m.nl", "m"}) {
    test::Captured captured;
    EXPECT_EQ(solve({.problem = folder / name, .json = folder / "out.json"}, captured.streams), exit_solved);
    EXPECT_THAT(captured.out.str(),
                testing::AllOf(HasSubstr("side_length"), HasSubstr("(area_balance)"), HasSubstr("1.414214")));
    const Json parsed = parse_json(test::read(folder / "out.json"));
    EXPECT_NEAR(parsed["variables"][0]["value"].get<double>(), std::sqrt(2.0), 1e-8);
    EXPECT_EQ(parsed["residual"]["worst"], "area_balance");
  }
}

// profit = p - 3, 0 <= p _|_ profit >= 0: the reader makes p - 3 the F of p, and profit = 0 no unknown. Catches an
// answer without a variable that the modeller has named, or with one that Pyomo has added.
TEST(Solve, AVariableThatAloneMakesUpAConditionIsShown) {
  const test::Folder folder;
  test::write(folder / "m.nl",
              "g3 1 1 0\n 2 2 0 0 1\n 0 0 1 0\n 0 0\n 0 0 0\n 0 0 0 1\n 0 0 0 0 0\n 3 0\n 0 0\n 0 0 0 0 0\n"
              "C0\nn0\nC1\nn0\nx0\nr\n5 1 1\n4 -3\nb\n2 0\n3\nk1\n1\nJ0 1\n1 1\nJ1 2\n0 -1\n1 1\n");
  const auto names_of = [&](const std::string& profit) {
    test::write(folder / "m.col", "p\n" + profit + "\n");
    test::write(folder / "m.row", "entry.c\nentry.bc\n");
    test::Captured captured;
    EXPECT_EQ(solve({.problem = folder / "m.nl", .json = folder / "m.json"}, captured.streams), exit_solved);
    const Json parsed = parse_json(test::read(folder / "m.json"));
    EXPECT_EQ(parsed["size"], 1);
    std::vector<std::string> names;
    for (const Json& variable : parsed["variables"]) {
      names.push_back(variable["name"]);
      EXPECT_THAT(captured.out.str(), HasSubstr("\n" + names.back() + " "));
    }
    return names;
  };
  EXPECT_THAT(names_of("entry.bv"), testing::ElementsAre("p"));
  EXPECT_THAT(names_of("profit"), testing::ElementsAre("p", "profit"));
  const Json profit = parse_json(test::read(folder / "m.json"))["variables"][1];
  EXPECT_EQ(profit["state"], "computed");
  EXPECT_EQ(profit["equation"], "entry.bc");
  EXPECT_NEAR(profit["value"].get<double>(), 0, 1e-8);
  test::Captured captured;  // the result is one to start from
  EXPECT_EQ(solve({.problem = folder / "m.nl", .warm_start = folder / "m.json"}, captured.streams), exit_solved)
      << captured.err.str();
}

TEST(Solve, StartsAreCountedFromOne) {
  for (const int start : {1, 8}) {
    test::Captured captured;
    solve({.problem = "kojshin", .start = start, .json = "-"}, captured.streams);
    EXPECT_EQ(parse_json(captured.out.str())["start"], start);
  }
  for (const int start : {0, 9, -1}) {
    test::Captured captured;
    EXPECT_EQ(solve({.problem = "kojshin", .start = start}, captured.streams), exit_input);
    EXPECT_THAT(captured.err.str(), HasSubstr("1 to 8"));
  }
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::Captured captured;
  EXPECT_EQ(solve({.problem = folder / "m.nl", .start = 2}, captured.streams), exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("one start"));
}

// Would catch a solver that says "solved" of a problem that has no solution, or that fails without a word of advice.
TEST(Solve, UnsolvedIsExitOneWithAdvice) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::infeasible_nl());
  for (const MethodEntry& method : methods()) {
    if (method.affine()) continue;
    test::Captured captured;
    const SolveRequest request{.problem = folder / "m.nl",
                               .flags = {{"method", std::string(method.name), "--method"}},
                               .json = folder / "out.json",
                               .log_level = LogLevel::Summary};
    EXPECT_EQ(solve(request, captured.streams), exit_unsolved) << method.name;
    const Json parsed = parse_json(test::read(folder / "out.json"));
    EXPECT_NE(parsed["status"], "Solved") << method.name;
    EXPECT_EQ(parsed["exit_code"], 1);
    EXPECT_FALSE(parsed["advice"].get<std::string>().empty()) << method.name;
    EXPECT_THAT(captured.out.str(), HasSubstr("Try: "));
  }
}

// A method for affine problems refuses a nonlinear one: it would solve its linearization.
TEST(Solve, MethodsForAffineProblemsRefuseOthers) {
  for (const MethodEntry& method : methods()) {
    if (!method.affine()) continue;
    test::Captured captured;
    EXPECT_EQ(solve({.problem = "kojshin", .flags = {{"method", std::string(method.name), ""}}}, captured.streams),
              exit_input);
    EXPECT_THAT(captured.err.str(), testing::AllOf(HasSubstr("kojshin"), HasSubstr("affine")));
  }
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .flags = {{"method", "auto", ""}}}, captured.streams), exit_solved);
  EXPECT_THAT(captured.out.str(), HasSubstr("auto chose path"));
}

TEST(Solve, UndefinedStart) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::undefined_nl());
  test::Captured captured;
  EXPECT_EQ(solve({.problem = folder / "m.nl", .json = "-"}, captured.streams), exit_unsolved);
  const Json parsed = parse_json(captured.out.str());
  EXPECT_EQ(parsed["status"], "EvaluationFailed");
  EXPECT_EQ(parsed["residual"]["natural"], "inf");
}

// exp(800) is too large for a double, and 1000 - exp(800) as well; log(0) has no value. Would catch an overflow called
// NaN.
TEST(Solve, OverflowAtTheStartIsNotCalledNaN) {
  const auto message = [](const std::string& nl) {
    const test::Folder folder;
    test::write(folder / "m.nl", nl);
    test::Captured captured;
    EXPECT_EQ(solve({.problem = folder / "m.nl", .json = "-"}, captured.streams), exit_unsolved);
    return parse_json(captured.out.str())["message"].get<std::string>();
  };
  for (const char* F : {"o44\nv0\n", "o1\nn1000\no44\nv0\n"})
    EXPECT_THAT(message(test::scalar_nl(F, 800)), testing::AllOf(HasSubstr("is too large"), HasSubstr("= 800")));
  EXPECT_THAT(message(test::undefined_nl()), HasSubstr("log(_svar[1]) in row _scon[1]: _svar[1] = 0 at the start"));
}

// Would catch log lines inside JSON on standard output, and a log that is lost.
TEST(Solve, JsonOnStandardOutputIsAlone) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .json = "-"}, captured.streams), exit_solved);
  EXPECT_TRUE(is_json(captured.out.str()));
  EXPECT_THAT(captured.err.str(), HasSubstr("Solved:"));
}

TEST(Solve, RefusedInputIsSaidAndWritten) {
  const test::Folder folder;
  test::write(folder / "square.nl", test::nonsquare_nl());
  test::write(folder / "broken.nl", "g3 1 1 0\nno model\n");
  test::write(folder / "empty.nl", "");
  for (const std::string& problem : {folder / "square.nl", folder / "broken.nl", folder / "empty.nl",
                                     folder / "none.nl", folder / "", std::string("no-such-name")}) {
    test::Captured captured;
    EXPECT_EQ(solve({.problem = problem, .json = "-"}, captured.streams), exit_input) << problem;
    const Json parsed = parse_json(captured.out.str());
    EXPECT_EQ(parsed["status"], "InputError");
    EXPECT_EQ(parsed["exit_code"], 2);
    EXPECT_THAT(captured.err.str(), HasSubstr(parsed["message"].get<std::string>()));
  }
}

TEST(Solve, BadOptionsAreRefused) {
  const test::Folder folder;
  test::write(folder / "bad.opt", "# fine\ntol 1e-4\nsigma 3\n");
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .options_file = folder / "bad.opt"}, captured.streams), exit_input);
  EXPECT_THAT(captured.err.str(), HasSubstr("bad.opt:3"));
  test::Captured word;
  EXPECT_EQ(solve({.problem = "kojshin", .options = {"tol"}}, word.streams), exit_input);
  EXPECT_THAT(word.err.str(), HasSubstr("key=value"));
}

// File, then --option, then flags: the order app/README.md states.
TEST(Solve, LaterOptionsWin) {
  const test::Folder folder;
  test::write(folder / "a.opt", "tol 1e-3\nmajor_iteration_limit = 77\ntime_limit 11\n");
  test::Captured captured;
  const SolveRequest request{.problem = "kojshin",
                             .options_file = folder / "a.opt",
                             .options = {"tol=1e-4", "major=66"},
                             .flags = {{"tol", "1e-5", "--tol"}},
                             .json = "-"};
  EXPECT_EQ(solve(request, captured.streams), exit_solved);
  const Json options = parse_json(captured.out.str())["options"];
  EXPECT_EQ(options["convergence_tolerance"], 1e-5);
  EXPECT_EQ(options["major_iteration_limit"], 66);
  EXPECT_EQ(options["time_limit"], 11.0);
}

// The solution is printed before the file fails, so that a long run is not lost. (What is known to fail is refused
// before: Outputs.AreWritableBeforeTheSolve.)
TEST(Solve, UnwritableJsonIsAnErrorAfterTheSolution) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "josephy", .json = "/dev/full"}, captured.streams), exit_input);
  EXPECT_THAT(captured.out.str(), HasSubstr("1.224745"));
  EXPECT_THAT(captured.err.str(), HasSubstr("/dev/full: cannot be written: No space left"));
}

TEST(Solve, LogLevelsAddUp) {
  const auto log = [](LogLevel level) {
    test::Captured captured;
    solve({.problem = "kojshin", .options = {"method=semismooth", "lemke_start=always"}, .log_level = level},
          captured.streams);
    return captured.out.str() + captured.err.str();
  };
  EXPECT_EQ(log(LogLevel::Quiet), "");
  EXPECT_THAT(log(LogLevel::Warning), testing::AllOf(HasSubstr("lemke_start"), Not(HasSubstr("Solved"))));
  EXPECT_THAT(log(LogLevel::Summary), testing::AllOf(HasSubstr("Solved"), Not(HasSubstr("major"))));
  EXPECT_THAT(log(LogLevel::Info), testing::AllOf(HasSubstr("major"), HasSubstr("z[1]"), Not(HasSubstr("options:"))));
  EXPECT_THAT(log(LogLevel::Debug), HasSubstr("options: method=semismooth"));
  EXPECT_EQ(log_level("debug"), LogLevel::Debug);
  EXPECT_THROW(log_level("loud"), InputError);
}

// The method users know by this log: its tables and, at the end, its counts in words.
TEST(Solve, TheDefaultTakesPathAndReportsAsPathDoes) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "josephy"}, captured.streams), exit_solved);
  for (const char* part : {"method auto",
                           "auto chose path",
                           "Crash Log\nmajor  func  diff  size",
                           "Major Iteration Log\nmajor minor  func  grad",
                           "inorm (label)",
                           "Final statistics",
                           "natural residual",
                           "Final summary",
                           "major iterations",
                           "minor iterations",
                           "crash iterations",
                           "evaluations of F",
                           "evaluations of J",
                           "factorizations",
                           "restarts",
                           "gradient steps",
                           "watchdog",
                           "D-steps",
                           "rank-deficient",
                           "starts from a ray",
                           "time in linear problems",
                           "time in all"})
    EXPECT_THAT(captured.out.str(), HasSubstr(part));
  test::Captured other;
  EXPECT_EQ(solve({.problem = "josephy", .options = {"method=semismooth"}}, other.streams), exit_solved);
  EXPECT_THAT(other.out.str(),
              testing::AllOf(HasSubstr("Final summary"), Not(HasSubstr("watchdog")), Not(HasSubstr("Crash Log"))));
}

// Each of PATH's switches alone, with output off and on. Would catch one wired to another's part.
TEST(Solve, OutputSwitchesShowTheirPart) {
  const auto log = [](std::vector<std::string> options) {
    test::Captured captured;
    solve({.problem = "josephy", .options = std::move(options)}, captured.streams);
    return captured.out.str();
  };
  const std::vector<std::pair<const char*, const char*>> parts{{"output_crash_iterations", "Crash Log"},
                                                               {"output_major_iterations", "Major Iteration Log"},
                                                               {"output_initial_statistics", "Initial statistics"},
                                                               {"output_final_statistics", "Final statistics"},
                                                               {"output_final_summary", "Final summary"},
                                                               {"output_options", "options: method=auto"}};
  for (const auto& [key, part] : parts) {
    const std::string alone = log({"output=no", std::string(key) + "=yes"});
    const std::string without = log({std::string(key) + "=no"});
    for (const auto& [other, text] : parts) {
      EXPECT_EQ(alone.find(text) != std::string::npos, part == text) << key << ' ' << text;
    }
    EXPECT_THAT(without, testing::AllOf(Not(HasSubstr(part)), HasSubstr("Solved")));
  }
}

// The attempts are told apart by name, in the log and in JSON.
TEST(Solve, RestartsAreNamed) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::infeasible_nl());
  test::Captured captured;
  EXPECT_EQ(solve({.problem = folder / "m.nl", .options = {"res_lim=2"}, .json = folder / "r.json"}, captured.streams),
            exit_unsolved);
  const Json parsed = parse_json(test::read(folder / "r.json"));
  int named = 0;
  for (const Json& it : parsed["iterations"]) {
    if (it["attempt"].is_null()) continue;
    ++named;
    EXPECT_THAT(captured.out.str(), HasSubstr("Restart: " + it["attempt"].get<std::string>() + "\n"));
  }
  EXPECT_EQ(named, parsed["stats"]["restarts"]);
  EXPECT_GT(named, 0);
  test::Captured silent;
  solve({.problem = folder / "m.nl", .options = {"output_restart_log=no"}}, silent.streams);
  EXPECT_THAT(silent.out.str(), Not(HasSubstr("Restart: ")));
}

// By hand. Would catch the largest of another vector, or a row taken for a column.
TEST(Solve, InitialStatistics) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::scalar_nl("o1\no5\nv0\nn2\nn7\n", 3));  // x^2 - 7 at x = 3
  test::Captured captured;
  solve({.problem = folder / "m.nl", .options = {"out_init_stat=yes"}}, captured.streams);
  EXPECT_THAT(captured.out.str(), testing::ContainsRegex("largest entry of x[ .]+3.0000e\\+00"));
  EXPECT_THAT(captured.out.str(), testing::ContainsRegex("largest entry of F[ .]+2.0000e\\+00"));
  EXPECT_THAT(captured.out.str(), testing::ContainsRegex("largest entry of J[ .]+6.0000e\\+00"));
}

TEST(Solve, OutputNoLeavesTheSolution) {
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .options = {"output=no"}}, captured.streams), exit_solved);
  EXPECT_THAT(captured.out.str(), testing::AllOf(Not(HasSubstr("major")), HasSubstr("z[1]")));
}

TEST(Solve, LongSolutionsAreShortened) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::endless_nl(100));
  test::Captured shortened;
  solve({.problem = folder / "m.nl"}, shortened.streams);
  EXPECT_THAT(shortened.out.str(), HasSubstr("40 rows are not shown; --full"));
  test::Captured full;
  solve({.problem = folder / "m.nl", .full = true}, full.streams);
  EXPECT_THAT(full.out.str(), testing::AllOf(Not(HasSubstr("not shown")), HasSubstr("_svar[75] ")));
}

// A flag that is set before the start ends the run at the start, with a best point and everything printed.
TEST(Solve, InterruptedKeepsTheBestPoint) {
  const std::atomic<bool> interrupt{true};
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "kojshin", .json = "-"}, captured.streams, &interrupt), exit_unsolved);
  const Json parsed = parse_json(captured.out.str());
  EXPECT_EQ(parsed["status"], "Interrupted");
  EXPECT_EQ(parsed["variables"].size(), 4U);
}

TEST(Solve, DerivativesAreCheckedOnDemand) {
  test::Captured captured;
  const SolveRequest request{.problem = "kojshin", .start = 2, .options = {"check_derivatives=yes"}, .json = "-"};
  EXPECT_EQ(solve(request, captured.streams), exit_solved);
  const Json parsed = parse_json(captured.out.str());
  EXPECT_EQ(parsed["derivatives"]["defined"], true);
  EXPECT_LT(parsed["derivatives"]["worst"].get<double>(), 1e-6);
  EXPECT_EQ(parsed["options"]["check_derivatives"], true);
  EXPECT_THAT(captured.err.str(), HasSubstr("Jacobian checked"));
}

// sqrt(2) again, whose box has to hold it; a problem beyond 5000 variables says why there is no proof. Catches a proof
// about another point than the one that is written.
TEST(Solve, VerifiesOnDemand) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::Captured captured;
  EXPECT_EQ(solve({.problem = folder / "m.nl", .options = {"verify=yes"}, .json = "-"}, captured.streams), exit_solved);
  const Json parsed = parse_json(captured.out.str());
  EXPECT_EQ(parsed["verified"]["unique"], true);
  EXPECT_LE(std::abs(parsed["variables"][0]["value"].get<double>() - std::sqrt(2.0)),
            parsed["verified"]["radius"].get<double>() + 1e-15);
  EXPECT_LE(parsed["verified"]["radius"].get<double>(), 1e-12);
  EXPECT_THAT(captured.err.str(), HasSubstr("verified: exactly one solution in the box of half-widths up to"));

  test::Captured functions;
  solve({.problem = "bratu-own:72x72", .options = {"verify=yes"}}, functions.streams);
  EXPECT_THAT(functions.out.str(), HasSubstr("not verified: the problem gives no ranges"));
}

// A Jacobian with a wrong sign must be refused with the names of its row and column.
TEST(Solve, WrongDerivativesAreRefused) {
  const LoadedProblem problem{.label = "wrong",
                              .mcp = ncp::make_mcp({.name = "wrong",
                                                    .box = ncp::Box::nonnegative(1),
                                                    .pattern = ncp::dense_pattern(1),
                                                    .F =
                                                        [](ncp::In x, ncp::Out F) {
                                                          F[0] = x[0] - 1;
                                                          return true;
                                                        },
                                                    .J =
                                                        [](ncp::In, ncp::SpMat& J) {
                                                          J.coeffRef(0, 0) = -1;
                                                          return true;
                                                        },
                                                    .variable_names = {"price"},
                                                    .equation_names = {"market"}}),
                              .x0 = ncp::Vec::Ones(1) * 3};
  const std::vector<Assignment> options{{"check_derivatives", "yes", "test"}};
  try {
    run_method(problem, apply_options(options).settings);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("price"), HasSubstr("market")));
  }
}

TEST(Solve, SideInequalitiesAcceptedOrRefused) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::side_inequality_nl());
  test::Captured accepted;
  EXPECT_EQ(solve({.problem = folder / "m.nl"}, accepted.streams), exit_solved);
  EXPECT_THAT(accepted.out.str(), testing::AllOf(HasSubstr("side inequalities"), HasSubstr("1.414214")));
  test::Captured refused;
  EXPECT_EQ(solve({.problem = folder / "m.nl", .options = {"sideineq=2"}}, refused.streams), exit_input);
  EXPECT_THAT(refused.err.str(), HasSubstr("1 side inequality"));
}

}  // namespace
}  // namespace perp::app
