// SPDX-License-Identifier: Apache-2.0
/// The parts of perp compare in process: outcomes, .sol files, starts, baselines, the journal, progress.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "app/campaign/start.hpp"
#include "app/compare/baseline.hpp"
#include "app/compare/journal.hpp"
#include "app/compare/outcome_table.hpp"
#include "app/compare/progress.hpp"
#include "app/problem/problem.hpp"
#include "app/support.hpp"
#include "app/worker/external.hpp"
#include "app/worker/run_cell.hpp"
#include "app/worker/sol_file.hpp"
#include "lcp/gpl.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/ampl/nl_writer.hpp"
#include "ncp/ampl/sol.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::app::compare {
namespace {

using test::refused;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Outcomes.

RunEnd finished(double natural) {
  RunEnd end;
  end.answer.complete = true;
  end.natural = natural;
  return end;
}
RunEnd claimed(double natural) {
  RunEnd end = finished(natural);
  end.answer.claimed = true;
  return end;
}

// Each row of the definition, once with a residual that holds and once with one that does not. Would catch a method
// that is believed: only the judge's residual makes a cell solved.
TEST(Outcomes, TheJudgeDecides) {
  const Campaign campaign{.tol = 1e-6, .memory_mb = 100};
  const AskedProblem problem{.name = "kojshin"};
  const auto of = [&](const RunEnd& end) { return outcome_of_run(end, problem, campaign); };
  EXPECT_EQ(of(claimed(1e-6)), Outcome::Solved);
  EXPECT_EQ(of(claimed(1.1e-6)), Outcome::FalseConvergence);
  EXPECT_EQ(of(claimed(std::nan(""))), Outcome::FalseConvergence) << "no point";
  EXPECT_EQ(of(claimed(lcp::infinity)), Outcome::FalseConvergence) << "F is not defined there";
  EXPECT_EQ(of(finished(1e-7)), Outcome::Unclaimed);
  EXPECT_EQ(of(finished(1e-5)), Outcome::Failed);
  EXPECT_EQ(of(finished(std::nan(""))), Outcome::Failed);
}

TEST(Outcomes, ClaimsThatThereIsNoSolution) {
  const Campaign campaign{};
  RunEnd end = finished(1);
  end.answer.infeasible = true;
  EXPECT_EQ(outcome_of_run(end, {.name = "a"}, campaign), Outcome::FalseInfeasible) << "of the collection";
  EXPECT_EQ(outcome_of_run(end, {.name = "a", .no_solution = "why"}, campaign), Outcome::Infeasible);
  EXPECT_EQ(outcome_of_run(end, {.name = "a.nl", .file = "/a.nl"}, campaign), Outcome::Failed) << "nobody knows";
  end.natural = 0;
  EXPECT_EQ(outcome_of_run(end, {.name = "a.nl", .file = "/a.nl"}, campaign), Outcome::FalseInfeasible)
      << "its own point is a solution";
  // F -> 0 on the way to infinity: a small residual is no solution where there is none.
  EXPECT_EQ(outcome_of_run(claimed(1e-9), {.name = "a", .no_solution = "why"}, campaign), Outcome::FalseConvergence);
  EXPECT_EQ(outcome_of_run(finished(1e-9), {.name = "a", .no_solution = "why"}, campaign), Outcome::Failed);
}

TEST(Outcomes, LimitsAndCrashesGoBeforeClaims) {
  const Campaign campaign{.memory_mb = 100};
  const AskedProblem problem{.name = "a"};
  RunEnd end = claimed(0);
  end.process.peak_mb = 101;
  EXPECT_EQ(outcome_of_run(end, problem, campaign), Outcome::MemoryLimit);
  end = claimed(0);
  end.process.why = ProcessEnd::Why::TimeLimit;
  EXPECT_EQ(outcome_of_run(end, problem, campaign), Outcome::TimeLimit);
  end = claimed(0);
  end.answer.crashed = "signal 11";
  EXPECT_EQ(outcome_of_run(end, problem, campaign), Outcome::Crashed);
  end = claimed(0);
  end.answer.garbage = "no .sol";
  EXPECT_EQ(outcome_of_run(end, problem, campaign), Outcome::Garbage);
  EXPECT_EQ(outcome_of_run({}, problem, campaign), Outcome::Crashed) << "a process that leaves no result";
  end = finished(1);
  end.answer.not_applicable = true;
  EXPECT_EQ(outcome_of_run(end, problem, campaign), Outcome::NotApplicable);
  EXPECT_TRUE(is_failure(Outcome::Unclaimed));
  EXPECT_FALSE(is_failure(Outcome::NotApplicable));
  EXPECT_FALSE(is_failure(Outcome::Infeasible));
}

// .sol files.

// What ASL's write_sol writes for two rows and two variables (Gay 1997).
std::string sol_file(const std::string& values = "0.5\n1e-3\n", const std::string& count = "2",
                     const std::string& end = "objno 0 0\n") {
  return "A solver: optimal\nsecond line\n\nOptions\n3\n1\n1\n0\n2\n0\n2\n" + count + "\n" + values + end;
}

TEST(SolFile, Text) {
  const SolFile read = parse_sol(sol_file(), 2);
  EXPECT_EQ(read.message, "A solver: optimal\nsecond line");
  EXPECT_EQ(read.code, 0);
  ASSERT_EQ(read.x.size(), 2);
  EXPECT_EQ(read.x[1], 1e-3);
  EXPECT_EQ(parse_sol(sol_file("", "0", "objno 0 500\n"), 2).x.size(), 0);
  EXPECT_EQ(parse_sol(sol_file("", "0", "objno 0 500\n"), 2).code, 500);
  const std::string duals = "m\n\nOptions\n3\n1\n1\n0\n2\n2\n1\n1\n7\n8\n0.25\nobjno 0 100\n";
  EXPECT_EQ(parse_sol(duals, 1).x[0], 0.25);
  const std::string tolerance = "m\n\nOptions\n5\n1\n3\n0\n1\n0\n1\n1\n1e-9\n0.25\nobjno 0 0\nsuffix 0 1 2 0 0\n";
  EXPECT_EQ(parse_sol(tolerance, 1).x[0], 0.25);
  EXPECT_TRUE(std::isnan(parse_sol(sol_file("nan\n1\n"), 2).x[0]));
}

// A program that has given up writes a record of values that is empty. Would catch (under asan-ubsan) a copy to the
// address of an empty vector, which there is none of.
TEST(SolFile, BinaryWithoutValues) {
  const SolFile sol = parse_sol(ncp::ampl::sol_text({.binary = true, .n_con = 2, .n_var = 3}, "failed", {}, 500), 3);
  EXPECT_EQ(sol.message, "failed");
  EXPECT_EQ(sol.code, 500);
  EXPECT_EQ(sol.x.size(), 0);
}

// An empty line ends the message (Gay 1997). Would catch a line "Options" of a message taken for the end of it, and the
// rest of the message for a point.
TEST(SolFile, OptionsInTheMessage) {
  const std::string message = "Options\n3\n1\n1\n0\n2\n0\n2\n0\nobjno 0 0";
  const std::vector<double> x{1, 2};
  for (const std::string& said : {message, "Says:\n" + message}) {
    const SolFile read = parse_sol(ncp::ampl::sol_text({.n_con = 2, .n_var = 2}, said, x, 400), 2);
    EXPECT_EQ(read.message, said);
    EXPECT_EQ(read.code, 400);
    ASSERT_EQ(read.x.size(), 2);
    EXPECT_EQ(read.x[1], 2);
  }
}

// Would catch what stands behind a NUL left out of sight, and codes that an int does not hold.
TEST(SolFile, WholeLinesAreNumbers) {
  using namespace std::string_literals;
  EXPECT_THROW(parse_sol(sol_file("1\n2\0junk\n"s), 2), InputError);
  EXPECT_THROW(parse_sol(sol_file("1\n2\n", "2\0junk"s), 2), InputError);
  for (const char* end : {"objno 0 4294967296\n", "objno 0 1e3\n", "objno 0 \n", "objno 0\n", "objno 0 0x10\n"})
    EXPECT_THROW(parse_sol(sol_file("1\n2\n", "2", end), 2), InputError) << end;
  EXPECT_EQ(parse_sol(sol_file("1\n2\n", "2", "objno -1 402 \n"), 2).code, 402);
}

// Every proper prefix of a file is one that was cut off.
TEST(SolFile, TruncatedTextIsRefused) {
  const std::string text = sol_file();
  for (std::size_t length = 0; length < text.size(); ++length)
    EXPECT_THROW(parse_sol(text.substr(0, length), 2), InputError) << length;
}

TEST(SolFile, GarbageIsRefused) {
  EXPECT_THAT(refused([] { parse_sol(sol_file(), 3); }), HasSubstr("for 2 variables, the model has 3"));
  EXPECT_THAT(refused([] { parse_sol(sol_file("1\n", "1"), 2); }), HasSubstr("1 values instead of 2"));
  EXPECT_THAT(refused([] { parse_sol(sol_file("1\nx\n"), 2); }), HasSubstr("'x' is no value"));
  EXPECT_THAT(refused([] { parse_sol(sol_file("1\n2\n3\n"), 2); }), HasSubstr("where objno belongs"));
  EXPECT_THAT(refused([] { parse_sol("\nOptions\n999999999\n", 2); }), HasSubstr("options"));
  EXPECT_THAT(refused([] { parse_sol("\nOptions\n0\n1\n0\n2\n99999999999\n", 2); }), HasSubstr("instead of 2"));
  EXPECT_THAT(refused([] { parse_sol(std::string(5000, '\xff'), 2); }), HasSubstr("cut off"));
  EXPECT_THAT(refused([] { parse_sol("", 2); }), HasSubstr("empty"));
}

// Text and binary as the program itself writes them for AMPL; every proper prefix of the binary one is refused.
TEST(SolFile, ReadsWhatPerpWrites) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const auto model = ncp::ampl::read_model(folder / "m.nl");
  model->write_sol("done", ncp::Vec::Constant(1, 1.25), 0);
  EXPECT_EQ(parse_sol(test::read(folder / "m.sol"), 1).x[0], 1.25);
  ncp::ampl::write_failed_sol(folder / "m", "refused", 505);
  EXPECT_EQ(parse_sol(test::read(folder / "m.sol"), 1).code, 505);
  const std::string binary_model = PERP_SOURCE_DIR "/../shared/data/nl/kojshin_b.nl";
  if (!std::filesystem::exists(binary_model)) GTEST_SKIP() << "no ../shared/data/nl";
  std::filesystem::copy_file(binary_model, folder / "b.nl");
  const ncp::Vec x = ncp::Vec::LinSpaced(4, 0, 3);
  ncp::ampl::read_model(folder / "b.nl")->write_sol("done", x, 100);
  const std::string bytes = test::read(folder / "b.sol");
  EXPECT_EQ(parse_sol(bytes, 4).x, x);
  EXPECT_EQ(parse_sol(bytes, 4).code, 100);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(parse_sol(bytes.substr(0, length), 4), InputError) << length;
}

// Starts.

TEST(Starts, TheRule) {
  const ncp::Box box{ncp::Vec::Zero(50), ncp::Vec::Constant(50, 3)};
  const ncp::Vec x0 = ncp::Vec::Constant(50, 1.5);
  const Perturbation rule{.seed = 1, .problem = "p", .start = 1, .run = 1};
  const ncp::Vec x = perturbed(box, x0, rule);
  EXPECT_LE((x - x0).lpNorm<Eigen::Infinity>(), 0.25) << "d_1 = 0.1, 1 + |x0| = 2.5";
  EXPECT_GT((x - x0).lpNorm<Eigen::Infinity>(), 0.2);
  EXPECT_GT((x - x0).maxCoeff(), 0.1);
  EXPECT_LT((x - x0).minCoeff(), -0.1);
  EXPECT_EQ(x, perturbed(box, x0, rule)) << "the same every time";
  const auto differs = [&](const Perturbation& other) { return perturbed(box, x0, other) != x; };
  EXPECT_TRUE(differs({.seed = 2, .problem = "p", .start = 1, .run = 1}));
  EXPECT_TRUE(differs({.seed = 1, .problem = "q", .start = 1, .run = 1}));
  EXPECT_TRUE(differs({.seed = 1, .problem = "p", .start = 2, .run = 1}));
  EXPECT_TRUE(differs({.seed = 1, .problem = "p", .start = 1, .run = 2}));
  const ncp::Vec far = perturbed(box, x0, {.seed = 1, .problem = "p", .start = 1, .run = 9});
  EXPECT_EQ(far.maxCoeff(), 3) << "in the box, at its bounds";
  EXPECT_EQ(far.minCoeff(), 0);
  EXPECT_EQ(perturbed(box, x0, {.run = 0}), x0);
}

// As another implementation of the generator (MT19937-64) and of CRC-32 gives them: the same on every platform, so that
// campaigns can be repeated elsewhere.
TEST(Starts, TheNumbers) {
  const ncp::Box box{ncp::Vec::Constant(2, -10), ncp::Vec::Constant(2, 10)};
  const ncp::Vec x = perturbed(box, ncp::Vec::Zero(2), {.seed = 1, .problem = "kojshin", .start = 1, .run = 1});
  EXPECT_DOUBLE_EQ(x[0], 0.0007172039089279992);
  EXPECT_DOUBLE_EQ(x[1], -0.06239324796398729);
}

// The guess of an .nl file, with a guess of its own and without, is the one put in; all else stays.
TEST(Starts, OfAnNlFile) {
  const test::Folder folder;
  const std::string text = test::sqrt2_nl();
  std::string without = text;
  without.erase(without.find("x1\n0 1\n"), 7);
  for (const std::string& original : {text, without}) {
    test::write(folder / "m.nl", nl_with_start(original, ncp::Vec::Constant(1, 0.1)));
    const auto model = ncp::ampl::read_model(folder / "m.nl");
    EXPECT_EQ(model->start()[0], 0.1);
    ncp::Vec F(1);
    ASSERT_TRUE(model->eval(ncp::Vec::Constant(1, 3), F));
    EXPECT_EQ(F[0], 7);
  }
  EXPECT_THROW(nl_with_start("b3 1 1 0\n", ncp::Vec::Zero(1)), InputError);
}

// Affine problems as .nl files: the same box, F and J back, with both kinds of bounds, free and fixed variables.
TEST(AffineNl, IsReadBack) {
  const test::Folder folder;
  for (const char* name :
       {"cottle4", "tinloi42", "torsion:4x3", "lq-control-own:5", "random-pd-own", "infeasible-own"}) {
    const LoadedProblem problem = load_problem(std::string(name));
    test::write(folder / "m.nl", ncp::ampl::nl_text(*problem.mcp, problem.x0).value());
    const auto model = ncp::ampl::read_model(folder / "m.nl");
    ASSERT_EQ(model->size(), problem.mcp->size()) << name;
    EXPECT_EQ(model->side_inequalities(), 0) << name;
    EXPECT_EQ(model->start(), problem.x0) << name;
    EXPECT_EQ(model->box().lower, problem.mcp->box().lower) << name;
    EXPECT_EQ(model->box().upper, problem.mcp->box().upper) << name;
    for (const double scale : {0.0, 1.0, -3.0}) {
      const ncp::Vec x = ncp::Vec::LinSpaced(model->size(), scale, 0.7);
      ncp::Vec F(x.size()), G(x.size());
      ASSERT_TRUE(model->eval(x, F) && problem.mcp->eval(x, G));
      EXPECT_LE((F - G).lpNorm<Eigen::Infinity>(), 1e-12 * (1 + G.lpNorm<Eigen::Infinity>())) << name;
    }
    EXPECT_EQ(ncp::check_jacobian(*model, problem.x0).outside_pattern, false);
  }
}

// Baselines.

Cell cell(const std::string& method, int start, Outcome outcome) {
  return {.method = method, .problem = "p", .start = start, .outcome = outcome, .message = "so, it is"};
}

TEST(Baseline, ListsWhatWasLost) {
  const test::Folder folder;
  const std::vector<Cell> before{cell("a", 1, Outcome::Solved), cell("a", 2, Outcome::Failed),
                                 cell("a", 3, Outcome::Infeasible), cell("b", 1, Outcome::Solved)};
  const std::vector<Cell> now{cell("a", 1, Outcome::Unclaimed), cell("a", 2, Outcome::Solved),
                              cell("a", 3, Outcome::Failed), cell("c", 1, Outcome::Crashed)};
  for (const std::string& text : {cells_csv(before), outcomes_csv(before)}) {
    test::write(folder / "b.csv", text);
    const BaselineComparison found = compare_with(read_baseline(folder / "b.csv"), now);
    EXPECT_EQ(found.compared, 3U) << "b and c are not in both";
    ASSERT_EQ(found.regressions.size(), 2U);
    EXPECT_EQ(found.regressions[0].now.start, 1);
    EXPECT_EQ(found.regressions[1].before.outcome, Outcome::Infeasible);
    EXPECT_THAT(found.gained, ElementsAre(CellKey{"a", "p", 2}));
    std::ostringstream text_out;
    print_comparison(text_out, "b.csv", found);
    EXPECT_THAT(text_out.str(), HasSubstr("so, it is"));
  }
}

// The committed one is of every preset, on the same problems. Catches a preset that was added and is not held to
// anything.
TEST(Baseline, CommittedOneIsOfEveryPreset) {
  if (!lcp::gpl_linked()) GTEST_SKIP() << lcp::not_in_this_build("gsl-hybridsj");
  std::map<std::string, std::set<std::string>> problems;
  for (const BaselineRow& row : read_baseline(PERP_SOURCE_DIR "/data/baseline/baseline.csv"))
    problems[row.key.method].insert(row.key.problem);
  EXPECT_EQ(problems.size(), ncp::presets().size());
  for (const ncp::Preset& preset : ncp::presets())
    EXPECT_EQ(problems[std::string(preset.name)], problems["path"]) << preset.name;
}

TEST(Baseline, BadOnesAreRefused) {
  const test::Folder folder;
  const auto refused_text = [&](const std::string& text) {
    test::write(folder / "b.csv", text);
    return refused([&] { read_baseline(folder / "b.csv"); });
  };
  EXPECT_THAT(refused_text(""), HasSubstr("no header"));
  EXPECT_THAT(refused_text("method,problem,outcome\n"), HasSubstr("no column 'start'"));
  EXPECT_THAT(refused_text("method,problem,start,outcome\na,b,1\n"), HasSubstr("record 2 has 3 fields"));
  EXPECT_THAT(refused_text("method,problem,start,outcome\na,b,x,solved\n"), HasSubstr("'x' is no start"));
  EXPECT_THAT(refused_text("method,problem,start,outcome\na,b,1,done\n"), HasSubstr("'done' is no outcome"));
  EXPECT_THAT(refused([&] { read_baseline(folder / "absent.csv"); }), HasSubstr("there is no file"));
}

// The journal.

TEST(Journal, AddsAfterATornLine) {
  const test::Folder folder;
  const std::string whole = cell_line(cell("a", 1, Outcome::Solved));
  test::write(folder / "cells.jsonl", whole + whole.substr(0, 30));
  {
    Journal journal(folder / "");
    EXPECT_TRUE(journal.before().torn);
    ASSERT_EQ(journal.before().cells.size(), 1U);
    journal.add(cell("a", 2, Outcome::Failed));
  }
  EXPECT_EQ(test::read(folder / "cells.jsonl"), whole + cell_line(cell("a", 2, Outcome::Failed)));
  test::write(folder / "cells.jsonl", whole.substr(0, 30));
  {
    Journal journal(folder / "");
    EXPECT_THAT(journal.before().cells, IsEmpty());
  }
  EXPECT_EQ(test::read(folder / "cells.jsonl"), "");
}

// A second campaign is kept out while the first one lives, and not after it.
TEST(Journal, Lock) {
  const test::Folder folder;
  {
    const DirectoryLock first(folder / "");
    EXPECT_THAT(refused([&] { const DirectoryLock second(folder / ""); }),
                HasSubstr("another campaign is at work there (process " + std::to_string(getpid())));
  }
  const DirectoryLock third(folder / "");
  EXPECT_THAT(refused([&] { const DirectoryLock lock(folder / "absent"); }), HasSubstr("absent"));
}

// Issue 17: a lock that is a link empties what it leads to.
TEST(Journal, LockFollowsNoLink) {
  const test::Folder folder;
  test::write(folder / "victim", "kept");
  std::filesystem::create_symlink("victim", folder / "lock");
  EXPECT_THAT(refused([&] { const DirectoryLock lock(folder / "."); }), HasSubstr("lock"));
  EXPECT_EQ(test::read(folder / "victim"), "kept");
}

// On a disk that is full, in a child: lines that were there stay, none is torn.
TEST(Journal, DiskThatFillsUp) {
  const test::Folder folder;
  const std::string line = cell_line(cell("a", 1, Outcome::Solved));
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{line.size() * 5 / 2, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    Journal journal(folder / ".");
    int added = 0;
    const std::string why = refused([&] {
      for (; added < 5; ++added) journal.add(cell("a", 1, Outcome::Solved));
    });
    _exit(added == 2 && why.find("cells.jsonl': File too large") != std::string::npos ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(test::read(folder / "cells.jsonl"), line + line);
}

TEST(Journal, Directories) {
  const test::Folder folder;
  make_directory(folder / "a/b", true);
  make_directory(folder / "a/b", true);
  test::write(folder / "a/b/x", "");
  EXPECT_THAT(refused([&] { make_directory(folder / "a/b", true); }), HasSubstr("is not empty"));
  test::write(folder / "a/b/campaign.json", "");
  EXPECT_THAT(refused([&] { make_directory(folder / "a/b", true); }), HasSubstr("--resume"));
  EXPECT_THAT(refused([&] { make_directory(folder / "a/b/x", true); }), HasSubstr("is a file"));
  EXPECT_THAT(refused([&] { make_directory(folder / "a/b/x/y", true); }), HasSubstr("cannot be made"));
}

// Progress.

TEST(Progress, OneLine) {
  std::ostringstream out;
  const std::vector<Cell> before{cell("a", 1, Outcome::Solved)};
  Progress progress(out, 5, before, 0);
  progress.add(cell("a", 2, Outcome::FalseConvergence));
  progress.add(cell("a", 3, Outcome::TimeLimit));
  EXPECT_EQ(progress.line(90), "3/5  solved 1  false 1  limits 1  1:30 left") << "two of them took 90 s";
  EXPECT_THAT(out.str(), HasSubstr("perp: 2/5")) << "a line for every tenth";
  EXPECT_EQ(duration_text(0.2), "1 s");
  EXPECT_EQ(duration_text(59.5), "1:00");
  EXPECT_EQ(duration_text(3723), "1:02:03");
}

// On a terminal: one line that is rewritten, never wider than the terminal, with a bar where there is room.
// Would catch: failures in the progress that the table at the end does not know.
TEST(Progress, NotToSolveWhatHasNoSolutionIsHonest) {
  std::ostringstream out;
  Progress progress(out, 5, {}, 0, {"none"});
  progress.add({.problem = "none", .outcome = Outcome::Failed});
  progress.add({.problem = "p", .outcome = Outcome::Failed});
  progress.add({.problem = "none", .outcome = Outcome::Infeasible});
  EXPECT_THAT(progress.line(1), testing::StartsWith("3/5  solved 1  failed 1  honest 1  "));
}

TEST(Progress, OnATerminal) {
  std::ostringstream out;
  Progress progress(out, 4, {}, 60);
  progress.add(cell("a", 1, Outcome::Solved));
  EXPECT_THAT(out.str(), testing::StartsWith("\r\033[K[#"));
  EXPECT_EQ(out.str().find('\n'), std::string::npos);
  progress.end();
  EXPECT_TRUE(out.str().ends_with("\r\033[K"));
  std::ostringstream narrow;
  Progress small(narrow, 1000000, {}, 40);
  small.add(cell("a", 1, Outcome::Solved));
  EXPECT_LE(narrow.str().size(), 40U + 4U);
}

// The table's rows add up to the cells; honest ends of problems without a solution are no failures.
TEST(OutcomeTable, Counts) {
  Campaign campaign{.methods = {{.label = "a"}, {.label = "b"}},
                    .problems = {{.name = "p", .starts = 3}, {.name = "none", .no_solution = "why"}},
                    .restarts = 1};
  std::vector<Cell> cells{cell("a", 1, Outcome::Solved), cell("a", 2, Outcome::Failed), cell("b", 1, Outcome::Crashed)};
  cells[1].outcome_after_restarts = Outcome::Solved;
  cells[0].outcome_after_restarts = Outcome::Solved;
  cells[2].outcome_after_restarts = Outcome::Crashed;
  cells.push_back(cell("b", 1, Outcome::Failed));
  cells.back().problem = "none";
  std::ostringstream out;
  print_outcomes(out, campaign, cells);
  EXPECT_THAT(out.str(), testing::ContainsRegex("method +solved +failed +crashed +honest +failures after restarts"));
  EXPECT_THAT(out.str(), testing::ContainsRegex("a +1 +1 +\\. +\\. +\\. +0.0"));
  EXPECT_THAT(out.str(), testing::ContainsRegex("b +\\. +\\. +1 +1 +1 +0.0"));
}

}  // namespace
}  // namespace perp::app::compare
