// SPDX-License-Identifier: Apache-2.0
/// The AMPL driver in process. The conventions are those of Gay, "Hooking Your Solver to AMPL" (1997), and AMPL's list
/// of solve_result ranges (0-99 solved, 200-299 infeasible, 400-499 limit, 500-599 failure).
#include "app/commands/ampl_driver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>

#include "app/options/options.hpp"
#include "app/support.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Answer {
  ExitCode code;
  std::string out, err;
};

Answer call(std::vector<std::string> arguments, const std::map<std::string, std::string>& environment = {},
            const std::atomic<bool>* interrupt = nullptr) {
  test::Captured captured;
  const AmplRequest request{
      .program = "perp", .arguments = std::move(arguments), .environment = [&](const char* name) -> const char* {
        const auto found = environment.find(name);
        return found == environment.end() ? nullptr : found->second.c_str();
      }};
  const ExitCode code = ampl_driver(request, captured.streams, interrupt);
  return {code, captured.out.str(), captured.err.str()};
}

/// The last line of a .sol file: "objno 0 solve_result_num".
std::string objno(const std::string& sol) {
  const std::size_t at = sol.rfind("objno");
  return at == std::string::npos ? "no objno" : sol.substr(at, sol.find('\n', at) - at);
}

TEST(AmplDriver, SolvesWithAndWithoutSuffix) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  for (const char* stub : {"m", "m.nl"}) {
    std::filesystem::remove(folder / "m.sol");
    const Answer answer = call({folder / stub, "-AMPL"});
    EXPECT_EQ(answer.code, exit_solved);
    EXPECT_THAT(answer.out, testing::StartsWith("Perp 1.0.0: solution found. "));
    EXPECT_THAT(answer.out, HasSubstr("natural residual"));
    EXPECT_THAT(answer.out, Not(HasSubstr("major"))) << "no table unless asked for";
    EXPECT_EQ(answer.err, "");
    const std::string sol = test::read(folder / "m.sol");
    EXPECT_THAT(sol, testing::StartsWith("Perp 1.0.0: solution found."));
    EXPECT_THAT(sol, HasSubstr("\n1.41421356"));
    EXPECT_EQ(objno(sol), "objno 0 0");
  }
}

TEST(AmplDriver, FlagsOfAmplDoNoHarm) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  EXPECT_EQ(call({"-s", "-e", folder / "m", "-AMPL"}).code, exit_solved);
  EXPECT_EQ(call({folder / "m", "-AMPL", "-s", "-e", "tol=1e-9"}).code, exit_solved);
  EXPECT_THAT(call({folder / "m", "-AMPL", "output=yes"}).out, HasSubstr("major"));
  EXPECT_EQ(call({folder / "m", "-AMPL", "wantsol=8"}).out, "");
}

// Would catch an environment that is not read, or read in another order than the header says.
TEST(AmplDriver, OptionsFromEnvironmentAndCommandLine) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::write(folder / "one.opt", "major_iteration_limit 1\n");
  const auto limit = [&](const std::map<std::string, std::string>& environment, std::vector<std::string> words = {}) {
    std::vector<std::string> arguments{folder / "m", "-AMPL"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const std::string sol = (call(arguments, environment), test::read(folder / "m.sol"));
    const std::size_t at = sol.find("the limit of ");
    return at == std::string::npos ? std::string("solved") : sol.substr(at + 13, 1);
  };
  EXPECT_EQ(limit({}), "solved");
  EXPECT_EQ(limit({{"perp_options", "major_iteration_limit=0"}}), "0");
  EXPECT_EQ(limit({{"path_options", "major_iteration_limit 1"}}), "1");
  EXPECT_EQ(limit({{"pathampl_options", "major_iteration_limit = 1"}}), "1");
  EXPECT_EQ(limit({{"perp_options", "major=0"}, {"path_options", "major=1"}}), "1");
  EXPECT_EQ(limit({{"path_options", "major=0"}, {"pathampl_options", "major=1"}}), "1");
  EXPECT_EQ(limit({{"pathampl_options", "major=99"}}, {"major=0"}), "0");
  EXPECT_EQ(limit({{"perp_options", "major=0"}}, {"major", "99"}), "solved");
  EXPECT_EQ(limit({}, {"optfile=" + (folder / "one.opt")}), "1");
  EXPECT_EQ(limit({{"path_options", "crash_meth none maj_iter 1"}}), "1") << "as PATH's users abbreviate";
}

// PATH's way: all off (AMPL's calls are silent here), and a part of it on again.
TEST(AmplDriver, OutputSwitches) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const auto out = [&](const std::string& options) {
    return call({folder / "m", "-AMPL"}, {{"path_options", options}}).out;
  };
  EXPECT_THAT(out(""), testing::AllOf(testing::Not(HasSubstr("Log")), testing::Not(HasSubstr("Final"))));
  EXPECT_THAT(out("output_major_iterations yes"),
              testing::AllOf(HasSubstr("Major Iteration Log"), testing::Not(HasSubstr("Crash Log")),
                             testing::Not(HasSubstr("Final summary"))));
  EXPECT_THAT(out("output yes output_crash_iterations no"),
              testing::AllOf(HasSubstr("Major Iteration Log"), HasSubstr("Final summary"),
                             HasSubstr("Final statistics"), testing::Not(HasSubstr("Crash Log"))));
}

TEST(AmplDriver, UnknownKeysAreWarnedAbout) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const Answer answer = call({folder / "m", "-AMPL", "no_such_key=3", "crash_perturb=no"});
  EXPECT_EQ(answer.code, exit_solved);
  EXPECT_THAT(answer.err, testing::AllOf(HasSubstr("warning"), HasSubstr("no_such_key"), HasSubstr("crash_perturb")));
}

// Each refusal leaves a .sol with its code, says why, and is no success to the caller.
TEST(AmplDriver, RefusedModelsLeaveASolFileWithTheReason) {
  const test::Folder folder;
  const std::vector<std::array<std::string, 4>> refused{
      {"square", test::nonsquare_nl(), "", "objno 0 504"},
      {"bounds", test::scalar_nl("o1\nv0\nn1\n", 0, "0 2 1"), "", "objno 0 200"},
      {"broken", "g3 1 1 0\nno model\n", "", "objno 0 500"},
      {"empty", "", "", "objno 0 500"},
      {"side", test::side_inequality_nl(), "sideineq=2", "objno 0 505"},
      {"option", test::sqrt2_nl(), "tol=-1", "objno 0 500"}};
  for (const auto& [name, model, option, code] : refused) {
    test::write(folder / (name + ".nl"), model);
    std::vector<std::string> arguments{folder / name, "-AMPL"};
    if (!option.empty()) arguments.push_back(option);
    const Answer answer = call(arguments);
    EXPECT_EQ(answer.code, exit_input) << name;
    EXPECT_EQ(answer.out, "") << name;
    const std::string sol = test::read(folder / (name + ".sol"));
    EXPECT_EQ(objno(sol), code) << name << '\n' << sol << answer.err;
    EXPECT_THAT(sol, testing::StartsWith("Perp 1.0.0: ")) << name;
    EXPECT_THAT(answer.err, testing::StartsWith("perp: ")) << name;
  }
}

TEST(AmplDriver, SideInequalitiesGiveOnlyTheModelsVariables) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::side_inequality_nl());
  EXPECT_EQ(call({folder / "m", "-AMPL"}).code, exit_solved);
  // ... n_con, 0 duals, n_var, 1 value, the value: Gay, "Hooking Your Solver to AMPL", section 8.
  EXPECT_THAT(test::read(folder / "m.sol"), HasSubstr("\n2\n0\n1\n1\n1.41421356"));
}

TEST(AmplDriver, MissingModelAndUnwritableAnswer) {
  const test::Folder folder;
  Answer answer = call({folder / "none", "-AMPL"});
  EXPECT_EQ(answer.code, exit_input);
  EXPECT_THAT(answer.err, HasSubstr("none.nl"));
  EXPECT_FALSE(std::filesystem::exists(folder / "none.sol"));
  EXPECT_EQ(call({"-AMPL"}).code, exit_input);

  test::write(folder / "m.nl", test::sqrt2_nl());
  std::filesystem::create_directory(folder / "m.sol");  // also root cannot write there
  answer = call({folder / "m", "-AMPL"});
  EXPECT_EQ(answer.code, exit_input);
  EXPECT_THAT(answer.out, HasSubstr("solution found")) << "the result is not lost";
  EXPECT_THAT(answer.err, HasSubstr("m.sol"));
}

TEST(AmplDriver, OutcomesReachAmpl) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::write(folder / "billups.nl", test::billups_nl());
  test::write(folder / "undefined.nl", test::undefined_nl());
  const std::atomic<bool> interrupt{true};
  const auto code = [&](const std::string& name, const std::string& option, const std::atomic<bool>* flag = nullptr) {
    EXPECT_EQ(call({folder / name, "-AMPL", "restart_limit=0", option}, {}, flag).code, exit_solved) << name;
    return objno(test::read(folder / (name + ".sol")));
  };
  EXPECT_EQ(code("m", "major=1"), "objno 0 400");
  EXPECT_EQ(code("m", "time_limit=1e-12"), "objno 0 402");
  EXPECT_EQ(code("m", "tol=1e-8", &interrupt), "objno 0 403");
  EXPECT_EQ(code("billups", "method=semismooth"), "objno 0 510");
  EXPECT_EQ(code("undefined", "tol=1e-8"), "objno 0 503");
}

// x^2 - 2 is not affine. Would catch a number that says that the file is bad.
TEST(AmplDriver, AMethodThatIsNotForTheProblem) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  EXPECT_EQ(call({folder / "m", "-AMPL", "method=lemke"}).code, exit_input);
  EXPECT_EQ(objno(test::read(folder / "m.sol")), "objno 0 590");
  EXPECT_THAT(test::read(folder / "m.sol"), HasSubstr("for affine problems"));
}

TEST(AmplDriver, EveryStatusHasANumber) {
  using ncp::Status;
  EXPECT_EQ(solve_result_num(Status::Solved), 0);
  EXPECT_EQ(solve_result_num(Status::IterationLimit), 400);
  EXPECT_EQ(solve_result_num(Status::TimeLimit), 402);
  EXPECT_EQ(solve_result_num(Status::Interrupted), 403);
  EXPECT_EQ(solve_result_num(Status::LinearAlgebraFailed), 501);
  EXPECT_EQ(solve_result_num(Status::EvaluationFailed), 503);
  EXPECT_EQ(solve_result_num(Status::NotApplicable), 590);
  for (const Status status : {Status::StationaryPoint, Status::NoProgress, Status::SubproblemFailed})
    EXPECT_EQ(solve_result_num(status), 510);
}

TEST(AmplDriver, Questions) {
  EXPECT_EQ(call({"-v"}).out, version_line() + "\n");
  EXPECT_EQ(call({"--version"}).out, version_text());
  EXPECT_THAT(call({"-?"}).out, HasSubstr("usage"));
  const std::string keywords = call({"-="}).out;
  for (const Option& option : options()) EXPECT_THAT(keywords, HasSubstr(std::string(option.key)));
}

TEST(AmplDriver, WhoIsMeant) {
  EXPECT_TRUE(is_ampl_call("pathampl", {}));
  EXPECT_TRUE(is_ampl_call("pathampl", {"stub"}));
  EXPECT_TRUE(is_ampl_call("perp", {"stub", "-AMPL"}));
  EXPECT_TRUE(is_ampl_call("perp", {"-v"}));
  EXPECT_FALSE(is_ampl_call("perp", {"solve", "kojshin"}));
  EXPECT_FALSE(is_ampl_call("perp", {}));
}

}  // namespace
}  // namespace perp::app
