// SPDX-License-Identifier: Apache-2.0
/// `perp contact --compare`, and the command line of `perp contact` as a process.
#include "app/contact/compare/compare_variants.hpp"
#include "app/text/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <filesystem>
#include <regex>
#include <set>

#include "app/compare/compare.hpp"
#include "app/contact/compare/variants_report.hpp"
#include "app/json.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;

struct Ended {
  int code;
  std::string output;  // standard output and error
};
Ended perp(const test::Folder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {PERP_PROGRAM, "contact"});
  const compare::ProcessEnd end =
      compare::run_process({.arguments = arguments, .log = folder / "log", .limits = {}}, nullptr);
  return {WIFEXITED(end.status) ? WEXITSTATUS(end.status) : -WTERMSIG(end.status), test::read(folder / "log")};
}

Json cells_of(const std::string& dir) { return parse_json(test::read(dir + "/cells.json"))["cells"]; }

// Three problems with solutions by hand: exact variants are judged by Coulomb's law, the square by its own, its error
// beside it.
TEST(ContactCompare, TableFilesAndLaws) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  test::write(folder / "two.dat", test::two_plane_contacts());
  test::Captured captured;
  EXPECT_EQ(compare_variants({.problems = {folder / "three.dat", folder / "two.dat", "stack:4"},
                              .variants = "glocker,glocker+path/B,inner:4,frictionless",
                              .jobs = 2,
                              .out = folder / "out",
                              .program = PERP_PROGRAM},
                             captured.streams),
            exit_solved);
  const Json cells = cells_of(folder / "out");
  ASSERT_EQ(cells.size(), 12U);
  for (const Json& cell : cells) {
    EXPECT_EQ(cell["outcome"], "solved") << cell;
    const bool exact = cell["variant"].get<std::string>().starts_with("glocker");
    EXPECT_EQ(cell["exact"], exact);
    EXPECT_EQ(cell["own_residual"].is_null(), exact);
    if (exact) {
      EXPECT_LE(cell["siconos"].get<double>(), 1e-8);
    }
  }
  EXPECT_EQ(cells[0]["variant"], "glocker+auto");  // problem by problem, in the order asked for
  EXPECT_EQ(cells[2]["variant"], "inner:4");
  EXPECT_GT(cells[2]["siconos"].get<double>(), 1e-2);
  EXPECT_EQ(cells[4]["contacts"], 2);
  const auto records = parse_csv(test::read(folder / "out/cells.csv"));
  ASSERT_EQ(records.size(), 13U);
  for (const auto& record : records) EXPECT_EQ(record.size(), records[0].size());
  for (const char* part :
       {"glocker+auto", "3/3", "solved by", "sweeps ", "its own", "Coulomb", "stack:4", "report.html"})
    EXPECT_THAT(captured.out.str(), HasSubstr(part));
  const std::string page = test::read(folder / "out/report.html");
  for (const char* part : {"Performance profiles", "glocker+path/B", "inner:4 *", "three.dat", "<svg"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_THAT(test::read(folder / "out/profile.svg"),
              testing::AllOf(testing::StartsWith("<?xml"), HasSubstr("frictionless *")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/work"));
}

// A process that dies and one that hangs: would catch a comparison that goes down with them, or counts them as failures
// of the method.
TEST(ContactCompare, CrashAndHangLoseOneCellOnly) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  const std::string program = folder / "program";
  test::write(program, std::string("#!/bin/sh\ncase \"$*\" in\n*ncp1*) kill -SEGV $$ ;;\n*outer*) exec sleep 60 ;;\n"
                                   "*inner*) exit 3 ;;\nesac\nexec ") +
                           PERP_PROGRAM + " \"$@\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  test::Captured captured;
  EXPECT_EQ(compare_variants({.problems = {folder / "three.dat"},
                              .variants = "ncp1,outer:8,inner:8,glocker",
                              .time_limit = 0.1,
                              .reading = 0.5,
                              .out = folder / "out",
                              .program = program},
                             captured.streams),
            exit_solved);
  const Json cells = cells_of(folder / "out");
  ASSERT_EQ(cells.size(), 4U);
  EXPECT_EQ(cells[0]["outcome"], "crashed");
  EXPECT_THAT(cells[0]["message"].get<std::string>(), HasSubstr("Segmentation"));
  EXPECT_EQ(cells[1]["outcome"], "time-limit");
  EXPECT_EQ(cells[2]["outcome"], "crashed");
  EXPECT_THAT(cells[2]["message"].get<std::string>(), HasSubstr("exit code 3"));
  EXPECT_EQ(cells[3]["outcome"], "solved");
  EXPECT_THAT(captured.out.str(), HasSubstr("CRASH: perp contact"));
}

TEST(ContactCompare, RefusesBeforeAnythingRuns) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  test::write(folder / "nan.dat", test::identity_dat(3, 1, "-1 nan 0", "0.5"));
  const auto why = [&](CompareVariantsRequest request) {
    test::Captured captured;
    if (request.out == "contact-comparison") request.out = folder / "out";
    EXPECT_EQ(compare_variants(request, captured.streams), exit_input);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    return captured.err.str();
  };
  const std::string good = folder / "three.dat";
  EXPECT_THAT(why({}), HasSubstr("which problems"));
  EXPECT_THAT(why({.problems = {good, folder / "nan.dat", folder / "none.dat"}}),
              testing::AllOf(HasSubstr("nan.dat"), HasSubstr("none.dat")));
  EXPECT_THAT(why({.problems = {good, good}}), HasSubstr("twice"));
  EXPECT_THAT(why({.problems = {good}, .variants = "inner:2"}), HasSubstr("inner:2"));
  EXPECT_THAT(why({.problems = {good}, .tol = -1}), HasSubstr("--tol"));
  EXPECT_THAT(why({.problems = {good}, .time_limit = 0}), HasSubstr("--time-limit"));
  EXPECT_THAT(why({.problems = {good}, .memory_mb = 0}), HasSubstr("--memory-limit"));
  EXPECT_THAT(why({.problems = {good}, .jobs = 0}), HasSubstr("--jobs"));
  std::filesystem::create_directory(folder / "full");
  test::write(folder / "full/file", "x");
  EXPECT_THAT(why({.problems = {good}, .out = folder / "full"}), HasSubstr("not empty"));
}

TEST(ContactCompare, InterruptedHasItsOwnCode) {
  const test::Folder folder;
  const std::atomic<bool> interrupt{true};
  test::Captured captured;
  EXPECT_EQ(compare_variants({.problems = {"stack:4"}, .out = folder / "out", .program = PERP_PROGRAM},
                             captured.streams, &interrupt),
            compare::exit_interrupted);
  EXPECT_TRUE(cells_of(folder / "out").empty());
}

// Torn or foreign JSON is no result.
TEST(ContactCompare, CellOfAProcess) {
  const compare::ProcessLimits limits{.seconds = 1, .memory_mb = 10};
  for (const char* torn : {"", "{", "[]", R"({"status":"Solved"})", R"({"status":"Solved","message":3})"})
    EXPECT_EQ(cell_of({}, torn, limits).outcome, Outcome::Crashed) << torn;
  EXPECT_EQ(cell_of({.why = compare::ProcessEnd::Why::MemoryLimit}, "", limits).outcome, Outcome::MemoryLimit);
  const Cell told = cell_of({.why = compare::ProcessEnd::Why::TimeLimit, .seconds = 3},
                            R"({"status":"InputError","message":"interrupted"})", limits);
  EXPECT_EQ(told.outcome, Outcome::TimeLimit);
  EXPECT_THAT(told.message, HasSubstr("told to end after 3 s"));
  const Cell refused = cell_of({}, R"({"status":"InputError","message":"no"})", limits);
  EXPECT_EQ(refused.outcome, Outcome::Failed);
  EXPECT_THAT(refused.message, HasSubstr("refused: no"));
}

// Every flag, as a process; what the flags mean is tested in process.
TEST(ContactProcess, FlagsAndExitCodes) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  const std::string file = folder / "three.dat";
  EXPECT_EQ(perp(folder, {file}).code, exit_solved);
  EXPECT_EQ(perp(folder, {file,
                          "--formulation",
                          "glocker",
                          "--method",
                          "path",
                          "--encoding",
                          "B",
                          "--row",
                          "normalised",
                          "--tol",
                          "1e-9",
                          "--time-limit",
                          "10",
                          "--json",
                          folder / "r.json",
                          "--svg",
                          folder / "f.svg",
                          "--fclib-out",
                          folder / "o.hdf5",
                          "--log-level",
                          "debug",
                          "--full"})
                .code,
            exit_solved);
  for (const char* made : {"r.json", "f.svg", "o.hdf5"}) EXPECT_TRUE(std::filesystem::exists(folder / made)) << made;
  EXPECT_EQ(parse_json(test::read(folder / "r.json"))["variant"], "glocker+path/B");
  EXPECT_EQ(perp(folder, {file, "--formulation", "inner:5", "--form", "mixed"}).code, exit_solved);
  EXPECT_EQ(perp(folder, {"--generate", "stack:4", "--log-level", "quiet"}).output, "");
  EXPECT_EQ(perp(folder, {"--generate", "spheres:20", "--tol", "1e-30", "--time-limit", "0.2"}).code, exit_unsolved);
  EXPECT_EQ(perp(folder, {file, "--compare", "--variants", "glocker,inner:4", "--out", folder / "out", "--memory-limit",
                          "2000", "--jobs", "1", "--tol", "1e-8", "--time-limit", "5"})
                .code,
            exit_solved);
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{},
                                             {"none.dat"},
                                             {file, "--formulation", "outer:2"},
                                             {file, "--formulation", "inner:8", "--encoding", "A"},
                                             {file, "--tol", "small"},
                                             {file, "--log-level", "loud"},
                                             {file, "--no-such-flag"},
                                             {file, "--out", folder / "x"},
                                             {file, "--variants", "glocker"},
                                             {file, "--compare", "--method", "path"},
                                             {file, "--compare", "--option", "sweeps=0"},
                                             {file, "--option", "sweep=0"},
                                             {file, "--resume"},
                                             {file, "--svg", ""},
                                             {file, "--json", ""},
                                             {file, "--fclib-out", "-"},
                                             {file, "--svg", "-"},
                                             {file, "--compare", "--svg", folder / "f.svg"},
                                             {file, "--compare", "--variants", "nonsense", "--out", folder / "x"}}) {
    const Ended ended = perp(folder, bad);
    EXPECT_EQ(ended.code, exit_input) << testing::PrintToString(bad);
    EXPECT_THAT(ended.output, testing::StartsWith("perp"));
  }
}

std::string section(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find(to, begin + from.size()) - begin);
}

// Would catch a flag that was added without a word in the man page or to the shell.
TEST(ContactProcess, ManPageAndCompletionKnowEveryFlag) {
  const test::Folder folder;
  const std::string help = perp(folder, {"--help"}).output;
  std::string page = test::read(PERP_MAN_PAGE);
  page = section(page, ".Ss perp contact", "\n.Ss ");
  const std::string completion = test::offered("contact --");
  const std::regex flag("--([a-z][a-z-]*)");
  std::set<std::string> flags;
  for (std::sregex_iterator it(help.begin(), help.end(), flag), end; it != end; ++it) flags.insert((*it)[1]);
  EXPECT_GE(flags.size(), 18U);
  for (const std::string& name : flags) {
    if (name != "help") {
      EXPECT_NE(page.find("Fl -" + name), std::string::npos) << name;
    }
    EXPECT_THAT(completion, HasSubstr(fmt::format(" --{} ", name)));
  }
}

}  // namespace
}  // namespace perp::app::contacts
