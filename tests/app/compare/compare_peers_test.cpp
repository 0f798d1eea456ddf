// SPDX-License-Identifier: Apache-2.0
/// Peers of perp compare: what they are given, and how they are shown when they misbehave.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "app/json.hpp"
#include "app/worker/external.hpp"
#include "compare_process_support.hpp"

namespace perp::app::compare {
namespace {

using test::Json;
using test::parse_json;
using testing::ElementsAre;
using testing::HasSubstr;

// Every way a peer can misbehave loses its own cell, shown as exactly that. x^2 - 2 has the solution sqrt(2).
TEST(CompareRun, PeersAreShownAsWhatTheyAre) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const std::string right = sol("1.414213562373095", 0);
  struct Peer {
    std::string name, body;
    Outcome outcome;
    std::string message;
  };
  const std::vector<Peer> peers{
      {"right", "exec " PERP_PROGRAM " \"$@\"", Outcome::Solved, "solution found"},
      {"segv", "kill -SEGV $$", Outcome::Crashed, "signal 11"},
      {"inner-segv", "sh -c 'kill -SEGV $$'\nexit $?", Outcome::Crashed, "signal 11"},
      {"chatter", "head -c 3000000 /dev/urandom\n" + writes(right), Outcome::Solved, "peer"},
      {"garbage", "head -c 3000 /dev/urandom > $1.sol", Outcome::Garbage, ".sol file"},
      {"truncated", writes(right) + "head -c 40 $1.sol > $1.t; mv $1.t $1.sol", Outcome::Garbage, "cut off"},
      {"wrong-size", writes("peer\n\nOptions\n3\n1\n1\n0\n1\n0\n2\n2\n1\n1\nobjno 0 0\n"), Outcome::Garbage,
       "for 2 variables"},
      {"wrong", writes(sol("1.5", 0)), Outcome::FalseConvergence, "peer"},
      {"nan", writes(sol("nan", 0)), Outcome::FalseConvergence, "peer"},
      {"modest", writes(sol("1.414213562373095", 500)), Outcome::Unclaimed, "peer"},
      {"honest", writes(sol("1.5", 500)), Outcome::Failed, "peer"},
      {"denies", writes(sol("1.5", 200)), Outcome::Failed, "peer"},
      {"fails-by-599", writes(sol("1.5", 599)), Outcome::Failed, "peer"},
      {"not-for-it", writes("affine ones only\n\nOptions\n3\n1\n1\n0\n1\n0\n1\n0\nobjno 0 590\n"),
       Outcome::NotApplicable, "affine ones only"},
      {"mute", "echo no licence >&2; exit 1", Outcome::Garbage, "exit code 1; it said: no licence"},
      {"pipe", "mkfifo $1.sol", Outcome::Garbage, ".sol file: there is none"},
      {"forks",
       "sleep 1000 & echo $! > " + (folder / "child1") + "\nsetsid sleep 1000 & echo $! > " + (folder / "child2") +
           "\n" + writes(right),
       Outcome::Solved, "peer"},
  };
  std::vector<std::string> arguments{"--methods",    "none",         "--problems", folder / "m.nl", "--out",
                                     folder / "out", "--time-limit", "20",         "--jobs",        "2"};
  for (const Peer& peer : peers) {
    arguments.emplace_back("--external");
    arguments.push_back(script(folder, peer.name, peer.body));
  }
  const Finished finished = compare(folder, arguments);
  EXPECT_EQ(finished.code, 0) << finished.err;
  const std::vector<Cell> cells = read_cells(folder / "out").cells;
  ASSERT_EQ(cells.size(), peers.size());
  for (const Peer& peer : peers) {
    const Cell cell = only(cells, peer.name);
    EXPECT_EQ(to_string(cell.outcome), to_string(peer.outcome)) << peer.name << ": " << cell.message;
    EXPECT_THAT(cell.message, HasSubstr(peer.message)) << peer.name;
  }
  EXPECT_LT(only(cells, "right").natural, 1e-6);
  EXPECT_NEAR(only(cells, "wrong").natural, 0.25, 1e-9) << "F(1.5) = 1/4";
  EXPECT_FALSE(alive(folder / "child1")) << "left behind in the group";
  EXPECT_FALSE(alive(folder / "child2")) << "left behind in another session";
  EXPECT_THAT(finished.out, HasSubstr("false claim"));
}

// A peer on the collection: affine problems and others with all their starts; restarts change its start.
TEST(CompareRun, PeersOnTheCollection) {
  const test::Folder folder;
  const std::string peer =
      script(folder, "perp-itself", "cp $1.nl " + (folder / "last.nl") + "\nexec " PERP_PROGRAM " \"$@\"");
  const std::string gives_up = script(folder, "gives-up",
                                      "head -2 $1.nl | grep -q '^ 1 1 ' && grep -A1 '^x' $1.nl >> " +
                                          (folder / "starts") + "\n" + writes(sol("1", 500)));
  test::write(folder / "m.nl", test::sqrt2_nl());
  const Finished finished =
      compare(folder, {"--methods", "none", "--problems", "cottle4,kojshin,infeasible-own," + (folder / "m.nl"),
                       "--out", folder / "out", "--external", peer, "--external", gives_up, "--restarts", "2"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  for (const Cell& cell : read_cells(folder / "out").cells) {
    if (cell.method == "perp-itself") {
      const Outcome right = cell.problem == "infeasible-own" ? Outcome::Infeasible : Outcome::Solved;
      EXPECT_EQ(to_string(cell.outcome), to_string(right)) << cell.problem << ": " << cell.message;
    }
    if (cell.method == "gives-up" && cell.problem == "m.nl") {
      EXPECT_EQ(cell.restarts, 2);
      EXPECT_EQ(cell.outcome_after_restarts, Outcome::Failed);
    }
  }
  std::istringstream lines(test::read(folder / "starts"));
  std::set<std::string> starts;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with('x')) starts.insert(line);
  EXPECT_EQ(starts.size(), 3U) << "of m.nl: its own and two others";
}

// What hangs is ended at its limit, and below what grows, children included, however it ignores signals.
TEST(CompareRun, PeersBeyondTheTimeLimit) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const std::string pids = "echo $$ > " + (folder / "hang.pid") + "; ";
  const auto begin = std::chrono::steady_clock::now();
  const Finished finished =
      compare(folder, {"--methods", "none", "--problems", folder / "m.nl", "--out", folder / "out", "--time-limit",
                       "0.6", "--jobs", "4", "--external", script(folder, "hangs", pids + "sleep 1000"), "--external",
                       script(folder, "ignores", "trap '' TERM INT HUP\nwhile :; do sleep 0.1; done"), "--external",
                       script(folder, "answers",
                              "trap '" + std::string("printf \"") +
                                  "p\\n\\nOptions\\n3\\n1\\n1\\n0\\n1\\n0\\n1\\n1\\n1.5\\nobjno 0 "
                                  "400\\n\" > \"$1.sol\"; exit 0' TERM\nsleep 1000 & wait")});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_LT(seconds, 15);
  const std::vector<Cell> cells = read_cells(folder / "out").cells;
  EXPECT_EQ(only(cells, "hangs").outcome, Outcome::TimeLimit);
  EXPECT_EQ(only(cells, "ignores").outcome, Outcome::TimeLimit);
  EXPECT_THAT(only(cells, "ignores").message, HasSubstr("killed after"));
  EXPECT_EQ(only(cells, "answers").outcome, Outcome::TimeLimit);
  EXPECT_NEAR(only(cells, "answers").natural, 0.25, 1e-9) << "its last word is judged";
  EXPECT_FALSE(alive(folder / "hang.pid"));
}

// The limit of time is one that a busy machine does not reach before.
TEST(CompareRun, PeersBeyondTheMemoryLimit) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more memory than the limit";
#endif
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const std::string eats = "perl -e '$s .= \"x\" x 10000000 while 1'";
  const Finished finished = compare(
      folder, {"--methods", "none", "--problems", folder / "m.nl", "--out", folder / "out", "--time-limit", "30",
               "--memory-limit", "150", "--jobs", "2", "--external", script(folder, "eats", "exec " + eats),
               "--external", script(folder, "inner-eats", eats + "; exit 0")});
  EXPECT_EQ(finished.code, 0) << finished.err;
  const std::vector<Cell> cells = read_cells(folder / "out").cells;
  EXPECT_EQ(only(cells, "eats").outcome, Outcome::MemoryLimit);
  EXPECT_EQ(only(cells, "inner-eats").outcome, Outcome::MemoryLimit) << "not a child of the worker itself";
}

// Would catch: a tolerance that loses digits, a shell's own braces that are taken for ours, and only the first of two.
TEST(CompareExternal, ToleranceInTheCommand) {
  EXPECT_EQ(with_tolerance("peer tol={tol} again={tol}", 1e-6), "peer tol=1e-06 again=1e-06");
  EXPECT_EQ(std::stod(with_tolerance("{tol}", 0.1 + 0.2)), 0.1 + 0.2);
  for (const char* shells : {"peer ${tol}", "peer {TOL} {} {a,b} { tol }", "peer tol", ""})
    EXPECT_EQ(with_tolerance(shells, 1e-6), shells);
  EXPECT_EQ(with_tolerance("peer ${tol} {tol}", 0.5), "peer ${tol} 0.5");
  EXPECT_THAT(unfilled_words("peer ${HOME} {a,b} {1..3} {} {tol} x={TOL} {time}"), ElementsAre("{TOL}", "{time}"));
}

// Would catch: a peer that is told another tolerance than the judge has, or none after --resume. The command is written
// down as it was given, so that --resume finds it again; the page shows what was run.
TEST(CompareRun, PeersAreToldTheTolerance) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const std::string peer = script(
      folder, "peer", "echo \"$1\" >> " + (folder / "told") + "\nshift 2\n" + writes(sol("1.414213562373095", 0)));
  const std::vector<std::string> arguments{"--methods",     "none",       "--problems",
                                           folder / "m.nl", "--external", peer + " tol={tol} {Tol}"};
  const std::string out = folder / "out";
  const Finished loose = compare(folder, with(arguments, {"--out", out, "--tol", "1e-3"}));
  EXPECT_EQ(loose.code, 0) << loose.err;
  EXPECT_THAT(loose.err, HasSubstr("note: --external peer: {Tol} is left to the shell as it is"));
  const Finished tight = compare(folder, with(arguments, {"--out", folder / "tight", "--tol", "2.5e-11"}));
  EXPECT_EQ(tight.code, 0) << tight.err;
  EXPECT_EQ(test::read(folder / "told"), "tol=0.001\ntol=2.5e-11\n");
  const Json campaign = parse_json(test::read(out + "/campaign.json"));
  EXPECT_THAT(campaign["methods"][0]["command"].get<std::string>(), HasSubstr(" tol={tol} {Tol}"));
  EXPECT_THAT(test::read(out + "/report.html"), HasSubstr(" tol=0.001 {Tol}")) << "what was run";
  std::filesystem::remove(out + "/cells.jsonl");
  EXPECT_EQ(compare(folder, {"--out", out, "--resume"}).code, 0);
  EXPECT_EQ(test::read(folder / "told"), "tol=0.001\ntol=2.5e-11\ntol=0.001\n") << "resumed as it was begun";
  EXPECT_EQ(compare(folder, with(arguments, {"--out", out, "--tol", "1e-3", "--resume"})).code, 0);
  const Finished other = compare(folder, with(arguments, {"--out", out, "--tol", "1e-4", "--resume"}));
  EXPECT_EQ(other.code, 2);
}

}  // namespace
}  // namespace perp::app::compare
