// SPDX-License-Identifier: Apache-2.0
/// perp compare as a process: limits, kill -9 and --resume, refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <map>
#include <thread>

#include "app/campaign/process.hpp"
#include "app/json.hpp"
#include "app/options/methods.hpp"
#include "compare_process_support.hpp"

namespace perp::app::compare {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;

// Our own methods: one that has no end is stopped by its own limit, one whose problem does not fit by memory's, those
// for affine problems are not for others.
TEST(CompareRun, OwnMethodsAtTheirLimits) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more memory than the limit";
#endif
  const test::Folder folder;
  test::write(folder / "endless.nl", test::endless_nl(20000));
  const Finished finished = compare(folder, {"--problems", (folder / "endless.nl") + ",obstacle:400x400,infeasible-own",
                                             "--methods", "josephy:tol=1e-300:major_iteration_limit=1000000000,lemke",
                                             "--out", folder / "out", "--time-limit", "0.4", "--memory-limit", "150"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  std::map<std::string, Outcome> outcomes;
  for (const Cell& cell : read_cells(folder / "out").cells)
    outcomes[cell.method.substr(0, 5) + " " + cell.problem.substr(0, 8) + (cell.start == 1 ? "" : " again")] =
        cell.outcome;
  EXPECT_EQ(outcomes["josep endless."], Outcome::TimeLimit);
  EXPECT_EQ(outcomes["lemke endless."], Outcome::NotApplicable);
  EXPECT_EQ(outcomes["lemke infeasib"], Outcome::Infeasible);
  EXPECT_TRUE(outcomes["josep obstacle"] == Outcome::MemoryLimit || outcomes["josep obstacle"] == Outcome::TimeLimit);
}

// Every method for affine problems, asked of nonlinear ones: of the collection, and of a file. Would catch a method
// that throws, crashes or solves a linearization.
TEST(CompareRun, MethodsForAffineProblemsOnOthers) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  std::string names;
  for (const MethodEntry& method : methods()) {
    if (!method.affine()) continue;
    if (!names.empty()) names += ',';
    names += method.name;
  }
  const Finished finished = compare(folder, {"--problems", "kojshin," + (folder / "m.nl"), "--methods", names,
                                             "--starts", "1", "--out", folder / "out"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  const std::vector<Cell> cells = read_cells(folder / "out").cells;
  EXPECT_GE(cells.size(), 2U * 10U);
  for (const Cell& cell : cells) {
    EXPECT_EQ(cell.outcome, Outcome::NotApplicable) << cell.method << " on " << cell.problem;
    EXPECT_THAT(cell.message, HasSubstr("is for affine problems"));
  }
}

const std::vector<std::string> campaign_of_tiny{"--problems", "kojshin,josephy,billups",     "--starts",     "3",
                                                "--methods",  "path,miles,newton-min,lemke", "--time-limit", "30"};

// Killed with -9 whenever it has so many cells, and resumed, until it is complete: the same outcomes, byte by byte, as
// in one go, no cell twice, and none of its processes left.
TEST(CompareRun, KilledAndResumed) {
  const test::Folder folder;
  const Finished once = compare(folder, with(campaign_of_tiny, {"--out", folder / "once", "--restarts", "1"}));
  ASSERT_EQ(once.code, 0) << once.err;
  const std::string out = folder / "killed";
  const std::size_t total = read_cells(folder / "once").cells.size();
  EXPECT_EQ(total, 4U * 3U * 3U);
  const auto lines = [&] {
    const std::string text = test::read(out + "/cells.jsonl");
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  };
  {
    Child child(folder, with({"compare"}, with(campaign_of_tiny, {"--out", out, "--restarts", "1", "--jobs", "1"})));
    ASSERT_TRUE(eventually([&] { return lines() >= 5; }));
    child.signal(SIGKILL);
    EXPECT_EQ(child.wait(), -SIGKILL);
  }
  std::size_t before = lines();
  EXPECT_LT(before, total);
  {
    Child child(folder, {"compare", "--out", out, "--resume"});
    ASSERT_TRUE(eventually([&] { return lines() >= before + 5; }));
    child.signal(SIGKILL);
    EXPECT_EQ(child.wait(), -SIGKILL);
  }
  before = lines();
  EXPECT_LT(before, total);
  // Also what a dying machine does: a changed byte in the middle and a line that ends too early.
  std::string text = test::read(out + "/cells.jsonl");
  text[text.find('\n') + 40] ^= 1;
  test::write(out + "/cells.jsonl", text + R"({"cell":{"method":"pa)");
  const Finished last = compare(folder, {"--out", out, "--resume"});
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("line 2: its CRC"));
  EXPECT_THAT(last.err, HasSubstr("torn"));
  EXPECT_EQ(test::read(out + "/outcomes.csv"), test::read(folder / "once/outcomes.csv"));
  EXPECT_EQ(lines(), total + 1) << "one line for every cell, and the one with the changed byte";
  EXPECT_FALSE(std::filesystem::exists(out + "/work"));
  const Finished again = compare(folder, {"--out", out, "--resume"});
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(lines(), total + 1) << "nothing is left to do";
  EXPECT_THAT(again.err, HasSubstr("1 at a time")) << "as it was begun, on a machine with however many cores";
  EXPECT_THAT(compare(folder, {"--out", out, "--resume", "--jobs", "3"}).err,
              HasSubstr("begun with 1 run, now 3 at a time: times do not compare"));
  EXPECT_THAT(once.out, HasSubstr("failures after restarts"));
}

// Seven shards, of which one is killed with -9 and resumed, joined: the outcomes are those of the whole, byte by byte.
// Catches a cell that no shard or two shards run, and one whose outcome depends on the others of its campaign.
TEST(CompareRun, ShardsAreTheWhole) {
  const test::Folder folder;
  ASSERT_EQ(compare(folder, with(campaign_of_tiny, {"--out", folder / "whole"})).code, 0);
  std::vector<std::string> report{"report"};
  for (int k = 1; k <= 7; ++k) {
    const std::string out = folder / fmt::format("part{}", k), shard = fmt::format("{}/7", k);
    if (k == 3) {
      Child child(folder, with({"compare"}, with(campaign_of_tiny, {"--out", out, "--shard", shard, "--jobs", "1"})));
      ASSERT_TRUE(eventually([&] { return test::read(out + "/cells.jsonl").find('\n') != std::string::npos; }));
      child.signal(SIGKILL);
      EXPECT_EQ(child.wait(), -SIGKILL);
      EXPECT_EQ(compare(folder, {"--out", out, "--resume", "--shard", "4/7"}).code, exit_input) << "another shard";
      EXPECT_EQ(compare(folder, {"--out", out, "--resume"}).code, 0);
    } else {
      EXPECT_EQ(compare(folder, with(campaign_of_tiny, {"--out", out, "--shard", shard})).code, 0);
    }
    report.push_back(out);
  }
  const auto joined = [&](const std::vector<std::string>& arguments) {
    Child child(folder, arguments);
    return child.wait();
  };
  EXPECT_EQ(joined(with(report, {"--out", folder / "joined"})), 0);
  EXPECT_EQ(test::read(folder / "joined/outcomes.csv"), test::read(folder / "whole/outcomes.csv"));
  EXPECT_EQ(compare(folder, {"--out", folder / "joined", "--resume"}).code, 0) << "a campaign like others";
  EXPECT_EQ(joined(with(report, {})), 2) << "nobody says where to";
  EXPECT_EQ(joined(with(report, {folder / "part2", "--out", folder / "twice"})), 2) << "a shard is there twice";
  EXPECT_EQ(joined(with(report, {folder / "whole", "--out", folder / "mixed"})), 2) << "not of these shards";
  EXPECT_EQ(joined({"report", folder / "part1", folder / "part2", "--out", folder / "some"}), 0);
}

TEST(CompareRun, ShardsThatAreNone) {
  const test::Folder folder;
  for (const char* shard : {"0/7", "8/7", "3", "3/", "/7", "3/7x", "a/b", "-1/7", "1/1000000"})
    EXPECT_EQ(compare(folder, with(campaign_of_tiny, {"--out", folder / "none", "--shard", shard})).code, exit_input)
        << shard;
}

// Killed while runs that never end are under way: they, and what they run, die with the campaign.
TEST(CompareRun, OrphansDie) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  test::write(folder / "endless.nl", test::endless_nl(3000));
  const std::string peer =
      script(folder, "peer",
             "sleep 1000 & echo $! > " + (folder / "child.pid") + "\necho $$ > " + (folder / "peer.pid") + "\nwait");
  Child child(folder, {"compare", "--methods", "josephy:tol=1e-300:major_iteration_limit=1000000000", "--problems",
                       (folder / "m.nl") + "," + (folder / "endless.nl"), "--out", folder / "out", "--external", peer,
                       "--jobs", "4"});
  ASSERT_TRUE(eventually([&] { return alive(folder / "peer.pid") && alive(folder / "child.pid"); }));
  child.signal(SIGKILL);
  child.wait();
  EXPECT_TRUE(eventually([&] { return !alive(folder / "peer.pid"); }));
  EXPECT_TRUE(eventually([&] { return !alive(folder / "child.pid"); }));
  EXPECT_TRUE(eventually([&] {  // nobody has the folder in its command line any more
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      std::error_code ignored;
      if (!std::filesystem::exists(entry.path() / "cmdline", ignored)) continue;
      if (test::read(entry.path() / "cmdline").find(folder / "out") != std::string::npos) return false;
    }
    return true;
  }));
}

// Ctrl-C: what is finished stays, the message says how to go on, and going on completes it.
TEST(CompareRun, InterruptedAndLocked) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const std::string out = folder / "an out";
  const std::string quick = script(folder, "quick", writes(sol("1.414213562373095", 0)));
  const std::string slow = script(folder, "slow",
                                  "touch " + (folder / "started") + "\nwhile [ ! -e " + (folder / "go") +
                                      " ]; do sleep 0.02; done\n" + writes(sol("1.414213562373095", 0)));
  Child child(folder, {"compare", "--methods", "none", "--problems", folder / "m.nl", "--out", out, "--external", quick,
                       "--external", slow, "--jobs", "1"});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder / "started"); }));
  const test::Folder& same = folder;
  {
    std::filesystem::create_directories(same / "b");
    const std::string command = PERP_PROGRAM " compare --resume --out '" + out + "' 2> " + (folder / "b/err");
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);  // NOLINT(cert-env33-c)
    EXPECT_THAT(test::read(folder / "b/err"), HasSubstr("another campaign is at work"));
  }
  child.signal(SIGINT);
  EXPECT_EQ(child.wait(), 4);
  EXPECT_THAT(child.err(), HasSubstr("1 of 2 cells are done. 'perp compare --out '" + out + "' --resume'"));
  EXPECT_EQ(read_cells(out).cells.size(), 1U);
  test::write(folder / "go", "");
  const Finished resumed = compare(folder, {"--out", out, "--resume"});
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(read_cells(out).cells.size(), 2U);
}

TEST(CompareRun, Refusals) {
  const test::Folder folder;
  const std::string out = folder / "out";
  const auto refused = [&](const std::vector<std::string>& arguments) {
    const Finished finished = compare(folder, arguments);
    EXPECT_EQ(finished.code, 2) << testing::PrintToString(arguments);
    EXPECT_EQ(finished.out, "") << testing::PrintToString(arguments);
    return finished.err;
  };
  EXPECT_THAT(refused({"--problems", "kojshim", "--out", out}), HasSubstr("'kojshin'"));
  EXPECT_THAT(refused({"--methods", "pat", "--out", out}), HasSubstr("'path'"));
  EXPECT_THAT(refused({"--problems", "obstacle:0x3", "--out", out}), HasSubstr("obstacle"));
  EXPECT_THAT(refused({"--problems", "kojshin:3", "--out", out}), HasSubstr("one size"));
  EXPECT_THAT(refused({"--tol", "-1", "--out", out}), HasSubstr("--tol"));
  EXPECT_THAT(refused({"--time-limit", "0", "--out", out}), HasSubstr("--time-limit"));
  EXPECT_THAT(refused({"--jobs", "0", "--out", out}), HasSubstr("--jobs"));
  EXPECT_THAT(refused({"--restarts", "-1", "--out", out}), HasSubstr("--restarts"));
  EXPECT_THAT(refused({"--starts", "none", "--out", out}), HasSubstr("--starts"));
  EXPECT_THAT(refused({"--external", "peer=/no/such", "--out", out}), HasSubstr("no program"));
  EXPECT_THAT(refused({"--baseline", "/no/such.csv", "--out", out}), HasSubstr("/no/such.csv"));
  EXPECT_THAT(refused({"--resume", "--out", out}), HasSubstr("no campaign"));
  test::write(folder / "bad.nl", "g3 1 1 0\n");
  EXPECT_THAT(refused({"--problems", folder / "bad.nl", "--out", out}), HasSubstr("bad.nl"));
  EXPECT_THAT(refused({"--problems", folder / "ba*.nl", "--out", out}), HasSubstr("every file is refused"));
  EXPECT_FALSE(std::filesystem::exists(out)) << "what was refused leaves nothing";
  test::write(folder / "m.nl", test::sqrt2_nl());
  const std::vector<std::string> all{"--problems", folder / "*.nl", "--methods", "path", "--out", folder / "of-all"};
  EXPECT_THAT(compare(folder, all).err, HasSubstr("bad.nl is left out"));
  EXPECT_EQ(compare(folder, with(all, {"--resume"})).code, 0);

  const std::vector<std::string> small{"--problems", "munson1", "--methods", "path", "--out", out};
  ASSERT_EQ(compare(folder, small).code, 0);
  EXPECT_THAT(refused(small), HasSubstr("--resume goes on with it"));
  EXPECT_THAT(refused({"--resume", "--out", out, "--tol", "1e-9"}), HasSubstr("--tol: 1e-06 there, 1e-09 here"));
  EXPECT_THAT(refused({"--resume", "--out", out, "--methods", "miles"}), HasSubstr("methods there but not here: path"));
  EXPECT_EQ(compare(folder, with(small, {"--resume"})).code, 0) << "the same in full";
  const std::string campaign = test::read(out + "/campaign.json");
  test::write(out + "/campaign.json", campaign.substr(0, 100));
  EXPECT_THAT(refused({"--resume", "--out", out}), HasSubstr("campaign.json"));
}

// A file that changes between a campaign and its resumption is another problem.
TEST(CompareRun, ChangedFilesAreNoticed) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  ASSERT_EQ(compare(folder, {"--problems", folder / "m.nl", "--methods", "path", "--out", folder / "out"}).code, 0);
  test::write(folder / "m.nl", test::billups_nl());
  const Finished finished = compare(folder, {"--out", folder / "out", "--resume"});
  EXPECT_EQ(finished.code, 2);
  EXPECT_THAT(finished.err, HasSubstr("content (CRC) of m.nl"));
}

// Exit code 1 and a list where something that was solved is not; the campaign itself is complete.
TEST(CompareRun, RegressionAgainstABaseline) {
  const test::Folder folder;
  test::write(folder / "b.csv", "method,problem,start,outcome\npath,munson1,1,solved\nnewton-min,billups,1,solved\n");
  const std::vector<std::string> small{"--problems", "munson1,billups", "--methods",     "path,newton-min", "--starts",
                                       "1",          "--baseline",      folder / "b.csv"};
  const Finished lost = compare(folder, with(small, {"--out", folder / "lost"}));
  EXPECT_EQ(lost.code, 1) << "Newton's method on min has a local minimum at billups' first start (Billups 1995)";
  EXPECT_THAT(lost.out, HasSubstr("2 cells compared, 1 solved there and not here"));
  test::write(folder / "b.csv", "method,problem,start,outcome\npath,munson1,1,solved\nnewton-min,billups,1,failed\n");
  EXPECT_EQ(compare(folder, with(small, {"--out", folder / "kept"})).code, 0);
}

// The judge's tolerance, options of methods and the machine are written down; times are not in outcomes.csv.
TEST(CompareRun, CampaignJson) {
  const test::Folder folder;
  ASSERT_EQ(compare(folder, {"--problems", "kojshin", "--methods", "semismooth:cfunction=kanzow-kleinmichel:tol=1e-9",
                             "--starts", "3", "--tol", "1e-5", "--out", folder / "out"})
                .code,
            0);
  const Json campaign = parse_json(test::read(folder / "out/campaign.json"));
  EXPECT_EQ(campaign["tol"], 1e-5);
  EXPECT_EQ(campaign["methods"][0]["in_force"]["cfunction"], "kanzow-kleinmichel");
  EXPECT_EQ(campaign["methods"][0]["in_force"]["convergence_tolerance"], "1e-09");
  EXPECT_EQ(campaign["problems"][0]["n"], 4);
  EXPECT_EQ(campaign["problems"][0]["starts"], 3);
  EXPECT_GT(campaign["machine"]["cores"], 0);
  EXPECT_EQ(campaign["command_line"][1], "compare");
  const std::vector<Cell> cells = read_cells(folder / "out").cells;
  ASSERT_EQ(cells.size(), 3U);
  for (const Cell& cell : cells) {
    EXPECT_EQ(cell.outcome, Outcome::Solved);
    EXPECT_LE(cell.natural, 1e-9) << "the method's own tolerance";
    EXPECT_GT(cell.peak_mb, 1);
    EXPECT_GE(cell.curve.size(), 2U);
  }
}

// The process that is run is killed with the thread's process, told before it is killed, and cannot dump core.
TEST(CompareProcess, Limits) {
  const test::Folder folder;
  const auto shell = [&](const std::string& text, ProcessLimits limits) {
    return run_process({.arguments = {"/bin/sh", "-c", text}, .log = folder / "log", .limits = limits}, nullptr);
  };
  ProcessEnd end = shell("echo hello; exit 3", {});
  EXPECT_EQ(end.why, ProcessEnd::Why::Itself);
  EXPECT_EQ(WEXITSTATUS(end.status), 3);
  EXPECT_EQ(test::read(folder / "log"), "hello\n");
  end = shell("trap 'echo told; exit 5' TERM; sleep 100 & wait", {.seconds = 0.2, .grace = 10});
  EXPECT_EQ(end.why, ProcessEnd::Why::TimeLimit);
  EXPECT_EQ(WEXITSTATUS(end.status), 5);
  end = shell("trap '' TERM; while :; do sleep 0.01; done", {.seconds = 0.2, .grace = 0.2});
  EXPECT_EQ(end.why, ProcessEnd::Why::TimeLimit);
  EXPECT_EQ(WTERMSIG(end.status), SIGKILL);
  end = shell("ulimit -c; echo $OPENBLAS_NUM_THREADS", {});
  EXPECT_EQ(test::read(folder / "log"), "0\n1\n");
  std::atomic<bool> interrupt{true};
  end = run_process({.arguments = {"/bin/sleep", "100"}, .log = folder / "log", .limits = {}}, &interrupt);
  EXPECT_EQ(end.why, ProcessEnd::Why::Interrupted);
  end = run_process({.arguments = {"/bin/sleep", "100"}, .log = folder / "no/log", .limits = {}}, nullptr);
  EXPECT_EQ(end.why, ProcessEnd::Why::NotStarted);
}

}  // namespace
}  // namespace perp::app::compare
