// SPDX-License-Identifier: Apache-2.0
/// Proofs that a problem has no solution, of which nobody knew before.
#include "app/campaign/settle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/compare/baseline.hpp"
#include "app/comparison_report/write_report.hpp"
#include "app/findings/robustness.hpp"
#include "app/problem/problem.hpp"
#include "app/worker/external.hpp"
#include "app/worker/run_cell.hpp"
#include "campaign_support.hpp"
#include "compare_process_support.hpp"
#include "ncp/ampl/nl_writer.hpp"

namespace perp::app::compare {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// lemke denies that m.nl has a solution, from its first start.
test::MadeUp denied(Outcome path, Outcome peer) {
  test::MadeUp made_up;
  made_up.method("lemke").method("path").method("peer").problem("m.nl", "nl", 2, 2).problem("p", "tiny");
  made_up.campaign.methods.back().command = "peer";
  made_up.run("lemke", "m.nl", Outcome::Infeasible).message = "a certificate";
  made_up.run("lemke", "m.nl", Outcome::Failed).start = 2;
  for (const int start : {1, 2}) {
    made_up.run("path", "m.nl", start == 1 ? Outcome::Failed : path).start = start;
    made_up.run("peer", "m.nl", start == 1 ? Outcome::Failed : peer).start = start;
  }
  for (const char* method : {"lemke", "path", "peer"}) made_up.run(method, "p", Outcome::Solved);
  return made_up;
}

Outcome of(const comparison::CampaignData& data, std::size_t method, std::size_t pair) {
  return data.at(method, pair)->outcome;
}

// Nobody has a solution: the problem has none, no failure on it counts, and who claims one is wrong. Would catch: a
// proof among the failures, and failures of others where there is nothing to solve.
TEST(Settle, AProofThatNobodyRefutesMovesTheProblem) {
  const test::MadeUp made_up = denied(Outcome::Failed, Outcome::FalseConvergence);
  const comparison::CampaignData data = made_up.data();
  EXPECT_FALSE(data.problem(0).solvable());
  EXPECT_EQ(data.problem(0).denied_by, "lemke");
  EXPECT_TRUE(data.problem(2).solvable());
  EXPECT_EQ(of(data, 0, 0), Outcome::Infeasible);
  for (const comparison::RobustnessRow& row : comparison::robustness(data).rows) {
    EXPECT_EQ(row.total.pairs, 1U);
    EXPECT_EQ(row.total.failures, 0U);
  }
  const auto without = comparison::unsolvable(data);
  ASSERT_EQ(without.size(), 3U);
  EXPECT_EQ(without[0].method, 0U);
  EXPECT_EQ(without[0].infeasible, 1U);
  EXPECT_EQ(without[1].honest, 2U);
  EXPECT_EQ(without[2].wrong, 1U);
  const test::Folder folder;
  made_up.write(folder);
  write_report(folder / "");
  EXPECT_THAT(test::read(folder / "report.html"), HasSubstr("proven in this campaign: m.nl (by lemke)"));
  EXPECT_THAT(test::read(folder / "pairs.csv"), HasSubstr("m.nl,1,nl,2,2,no,"));
}

// Another method has a solution, be it from another start, unclaimed, or after restarts only: the denial is a false
// claim, on top of the page in red, and the problem stays among those to be solved.
TEST(Settle, ADenialOfWhatAnotherSolvesIsFalse) {
  for (const Outcome outcome : {Outcome::Solved, Outcome::Unclaimed}) {
    const test::MadeUp made_up = denied(outcome, Outcome::Failed);
    const comparison::CampaignData data = made_up.data();
    EXPECT_TRUE(data.problem(0).solvable());
    EXPECT_EQ(of(data, 0, 0), Outcome::FalseInfeasible);
    EXPECT_EQ(of(data, 1, 0), Outcome::Failed);
    EXPECT_EQ(data.at(0, 0)->message, "path has a solution; it says: a certificate");
    EXPECT_EQ(made_up.cells[0].outcome, Outcome::Infeasible) << "cells.jsonl keeps what the run said";
    const test::Folder folder;
    made_up.write(folder);
    write_report(folder / "");
    EXPECT_THAT(test::read(folder / "report.html"), HasSubstr("<td class=\"bad\">false-infeasible</td>"));
    EXPECT_THAT(test::read(folder / "false_claims.csv"), HasSubstr("lemke,m.nl,1,false-infeasible"));
    EXPECT_THAT(test::read(folder / "robustness.csv"), HasSubstr("lemke,nl,2,2,2"));
  }
  test::MadeUp later = denied(Outcome::Failed, Outcome::Failed);
  later.cells[2].outcome_after_restarts = Outcome::Solved;
  EXPECT_EQ(of(later.data(), 0, 0), Outcome::FalseInfeasible);
  later = denied(Outcome::Failed, Outcome::TimeLimit);
  later.cells[5].natural = 1e-7;  // the point at which the time limit found it
  EXPECT_EQ(of(later.data(), 0, 0), Outcome::FalseInfeasible);
}

// A baseline's solution that is now denied is lost, though `infeasible` is a good end elsewhere.
TEST(Settle, DenialOfWhatABaselineHasSolvedIsARegression) {
  const test::MadeUp made_up = denied(Outcome::Failed, Outcome::Failed);
  const CellKey key{.method = "lemke", .problem = "m.nl"};
  const auto compared = [&](Outcome before) { return compare_with({{.key = key, .outcome = before}}, made_up.cells); };
  EXPECT_EQ(compared(Outcome::Solved).regressions.size(), 1U);
  EXPECT_EQ(compared(Outcome::Infeasible).regressions.size(), 0U);
}

TEST(Settle, OutcomeOfAProof) {
  const Campaign campaign{};
  RunEnd end;
  end.answer.complete = end.answer.infeasible = end.answer.proven = true;
  end.natural = 1;
  const AskedProblem file{.name = "a.nl", .file = "/a.nl"};
  EXPECT_EQ(outcome_of_run(end, file, campaign), Outcome::Infeasible);
  AskedProblem listed{.name = "a"};
  EXPECT_EQ(outcome_of_run(end, listed, campaign), Outcome::Infeasible) << "no solution is listed";
  listed.known_solutions = 1;
  EXPECT_EQ(outcome_of_run(end, listed, campaign), Outcome::FalseInfeasible);
  end.natural = 1e-9;
  EXPECT_EQ(outcome_of_run(end, file, campaign), Outcome::FalseInfeasible) << "its own point is a solution";
}

// infeasible-own as a file of which nobody knows. Our methods prove it; peers that deny it without a proof, or are
// honest, stay `failed`, and all of them are right in the table of problems without a solution.
TEST(CompareRun, OurProofsOfFiles) {
  const test::Folder folder;
  const LoadedProblem problem = load_problem("infeasible-own");
  test::write(folder / "m.nl", ncp::ampl::nl_text(*problem.mcp, problem.x0).value());
  const auto peer = [&](const char* name, const char* code) {
    const std::string sol = R"(printf 'p\n\nOptions\n3\n1\n1\n0\n%d\n0\n%d\n0\nobjno 0 )";
    return script(folder, name, "n=$(sed -n 2p $1.nl | cut -d' ' -f3); " + sol + code + "\n' $n $n > $1.sol");
  };
  const Finished finished =
      compare(folder, {"--methods", "lemke,path,semismooth", "--problems", folder / "m.nl", "--out", folder / "out",
                       "--external", peer("denies", "200"), "--external", peer("honest", "500")});
  EXPECT_EQ(finished.code, 0) << finished.err;
  const std::string outcomes = test::read(folder / "out/outcomes.csv");
  for (const char* line : {"lemke,m.nl,1,infeasible,", "path,m.nl,1,infeasible,", "semismooth,m.nl,1,failed,",
                           "denies,m.nl,1,failed,", "honest,m.nl,1,failed,"})
    EXPECT_THAT(outcomes, HasSubstr(line));
  EXPECT_THAT(finished.out, AllOf(HasSubstr("infeasible, it says so; honest, it does not claim one."),
                                  Not(HasSubstr("false claim"))));
  EXPECT_THAT(test::read(folder / "out/unsolvable.csv"), HasSubstr("lemke,1,0,0,0,0,0"));
  EXPECT_THAT(test::read(folder / "out/unsolvable.csv"), HasSubstr("denies,0,1,0,0,0,0"));
  const Finished again = compare(folder, {"--out", folder / "out", "--resume"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(test::read(folder / "out/outcomes.csv"), outcomes);
}

}  // namespace
}  // namespace perp::app::compare
