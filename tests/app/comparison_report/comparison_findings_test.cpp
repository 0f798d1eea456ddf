// SPDX-License-Identifier: Apache-2.0
/// What a report says in words, its robustness table and its sign test, on made-up campaigns.
#include "app/findings/findings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "app/compare/campaign_support.hpp"
#include "app/findings/robustness.hpp"
#include "app/findings/summary.hpp"

namespace perp::app::comparison {
namespace {

using test::MadeUp;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// The text of a topic; "" if nothing is said of it.
std::string said(const MadeUp& made_up, const std::string& topic) {
  const CampaignData data = made_up.data();
  for (const Finding& finding : findings(data, comparisons(data)))
    if (finding.topic == topic) return finding.text;
  return "";
}

/// By hand: 2 P(X <= min) for X ~ B(n, 1/2). Would catch one-sided values and the tail without its end.
TEST(Duel, SignTestByHand) {
  EXPECT_DOUBLE_EQ((Duel{5, 0}).p_value(), 2.0 / 32);
  EXPECT_DOUBLE_EQ((Duel{0, 6}).p_value(), 2.0 / 64);
  EXPECT_DOUBLE_EQ((Duel{8, 1}).p_value(), 2 * (1 + 9) / 512.0);
  EXPECT_EQ((Duel{0, 0}).p_value(), 1);
  EXPECT_EQ((Duel{7, 7}).p_value(), 1);
  EXPECT_FALSE((Duel{5, 0}).clear());
  EXPECT_TRUE((Duel{6, 0}).clear());
  EXPECT_NEAR((Duel{3000, 2800}).p_value(), 0.009, 0.001) << "2^-5800 underflows; the normal approximation says 0.0090";
}

/// Another BLAS moves what two methods solve by up to 2 % of the pairs: a lead of 9 on 460 is none, though all 9 pairs
/// speak for it, and one of 10 is.
TEST(Duel, LeadsThatRoundingMayMakeAreNotClear) {
  EXPECT_LT((Duel{9, 0}).p_value(), 0.05);
  EXPECT_FALSE((Duel{9, 0, 460}).clear());
  EXPECT_TRUE((Duel{10, 0, 460}).clear());
  EXPECT_FALSE((Duel{0, 12, 600}).clear());
  EXPECT_FALSE((Duel{60, 50, 460}).clear()) << "beyond rounding, but the pairs speak for both";
  MadeUp made_up;
  made_up.method("path").method("miles").problems("tiny", 460);
  made_up.runs("path", "tiny", 460, 460).runs("miles", "tiny", 460, 451);
  EXPECT_THAT(said(made_up, "Most solved"), HasSubstr("Not clearly behind it: miles"));
}

/// Billups, Dirkse & Ferris' counts by hand. Would catch: pairs that do not apply counted as failures, unfinished ones
/// counted, failures after restarts taken from runs that had solved, problems without a solution among the failures.
TEST(Robustness, CountsByHand) {
  MadeUp made_up;
  made_up.method("a").method("b").problem("p", "tiny", 4, 2).problem("q", "lcp").problem("none", "lcp", 2, 1, "x < 0");
  made_up.run("a", "p", Outcome::Solved);
  made_up.run("a", "p", Outcome::TimeLimit).start = 2;
  made_up.cells.back().outcome_after_restarts = Outcome::Solved;
  made_up.run("a", "q", Outcome::Unclaimed);
  made_up.run("a", "none", Outcome::Infeasible);
  made_up.run("b", "p", Outcome::NotApplicable);
  made_up.run("b", "q", Outcome::Solved);
  made_up.run("b", "none", Outcome::FalseConvergence);

  const Robustness table = robustness(made_up.data());
  EXPECT_THAT(table.classes, ElementsAre("lcp", "tiny"));
  EXPECT_THAT(table.pairs, ElementsAre(1, 2));
  ASSERT_EQ(table.rows.size(), 2U);
  const RobustnessRow& a = table.rows[0];
  EXPECT_EQ(a.method, 0U) << "methods for some problems only come last";
  EXPECT_EQ(text(a.by_class[0]), "1 (1)");
  EXPECT_EQ(text(a.by_class[1]), "1 (0)");
  EXPECT_EQ(text(a.total), "2 (1)");
  EXPECT_EQ(a.total.pairs, 3U);
  const RobustnessRow& b = table.rows[1];
  EXPECT_EQ(text(b.by_class[0]), "0");
  EXPECT_EQ(text(b.by_class[1]), "-");
  EXPECT_EQ(b.not_applicable, 1U);
  EXPECT_EQ(b.unfinished, 1U);

  const std::vector<UnsolvableRow> without = unsolvable(made_up.data());
  ASSERT_EQ(without.size(), 2U);
  EXPECT_EQ(without[0].method, 0U);
  EXPECT_EQ(without[0].infeasible, 1U);
  EXPECT_EQ(without[1].wrong, 1U);
}

/// Which comparisons there are, who takes part, and which pairs count. Would catch: methods for affine problems that
/// pull down the general comparison, pairs somebody has not finished.
TEST(Comparisons, WhoIsComparedOnWhat) {
  MadeUp made_up;
  made_up.method("path").method("smooth").method("lemke").method("semismooth", "fb").method("semismooth:cfunction=min");
  made_up.problem("l", "lcp").problem("t", "tiny").problem("open", "tiny").problem("large", "lcp");
  for (const char* method : {"path", "smooth", "semismooth", "semismooth:cfunction=min"})
    made_up.run(method, "l", Outcome::Solved), made_up.run(method, "t", Outcome::Solved);
  made_up.run("lemke", "l", Outcome::Solved);
  made_up.run("lemke", "t", Outcome::NotApplicable);
  for (const auto& method : made_up.campaign.methods) made_up.run(method.label, "large", Outcome::Solved);
  made_up.cells[made_up.cells.size() - 4].outcome = Outcome::NotApplicable;  // smooth, too large for it
  const CampaignData data = made_up.data();
  const std::vector<Comparison> all = comparisons(data);
  std::vector<std::string> ids(all.size());
  std::ranges::transform(all, ids.begin(), &Comparison::id);
  EXPECT_THAT(ids, ElementsAre("general", "affine", "cfunctions-semismooth"))
      << "the three of 1997 are all general methods there are";
  EXPECT_THAT(all[0].methods, testing::UnorderedElementsAre(0, 1, 3));
  EXPECT_THAT(all[0].pairs, ElementsAre(0, 1, 3));
  EXPECT_EQ(all[0].unfinished, 1U);
  EXPECT_THAT(all[1].methods, testing::UnorderedElementsAre(0, 1, 2, 3));
  EXPECT_THAT(all[1].pairs, ElementsAre(0, 3)) << "lemke applies to these; nobody has finished the third";
  EXPECT_THAT(all[2].methods, testing::UnorderedElementsAre(3, 4)) << "the default is one of the C-functions";
  EXPECT_EQ(name_in(data, all[2], 3), "fb (default)");
  EXPECT_EQ(name_in(data, all[2], 4), "min");
}

/// A program that says of a pair that it is not for it: left out of the robustness table, as a method for affine
/// problems is; in profiles it has not solved the pair; and it does not come into the comparison of the methods for
/// all.
TEST(Comparisons, ProgramsThatRefuseSomePairs) {
  MadeUp made_up;
  made_up.method("path").method("peer").problem("p", "nl").problem("q", "nl").problem("r", "nl");
  made_up.campaign.methods.back().command = "peer";
  for (const char* name : {"p", "q", "r"}) made_up.run("path", name, Outcome::Solved, 0.04);
  made_up.run("peer", "p", Outcome::Solved, 0.02);
  made_up.run("peer", "q", Outcome::NotApplicable);
  made_up.run("peer", "r", Outcome::Failed);
  const CampaignData data = made_up.data();
  const Robustness table = robustness(data);
  EXPECT_EQ(table.rows[1].total.pairs, 2U);
  EXPECT_EQ(table.rows[1].total.failures, 1U);
  EXPECT_EQ(table.rows[1].not_applicable, 1U);
  const std::vector<Comparison> all = comparisons(data);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_THAT(all[0].methods, ElementsAre(0));
  EXPECT_EQ(all[1].id, "external");
  EXPECT_THAT(all[1].pairs, ElementsAre(0, 2)) << "those that a program was for";
  EXPECT_EQ(all[1].profiles[0].performance[1].count(1), 1U);
  EXPECT_EQ(all[1].profiles[0].performance[1].problems, 2U);
  made_up.method("other").campaign.methods.back().command = "other";
  for (const char* name : {"p", "q", "r"}) made_up.run("other", name, Outcome::Solved, 0.01);
  made_up.run("other", "p", Outcome::NotApplicable);
  const std::vector<Comparison> three = comparisons(made_up.data());
  EXPECT_THAT(three[1].pairs, ElementsAre(0, 1, 2));
  const MeasureProfiles& time = three[1].profiles[0];
  const auto peer = std::ranges::find(time.methods, 1U) - time.methods.begin();
  EXPECT_EQ(time.performance[static_cast<std::size_t>(peer)].solved(), 1U) << "q is not for it, r it fails";
  EXPECT_EQ(time.performance[static_cast<std::size_t>(peer)].problems, 3U);
}

/// Costs below the floor tie, and a cost that is not known leaves the method out of that profile only.
TEST(Comparisons, FloorsAndUnknownCosts) {
  MadeUp made_up;
  made_up.method("a").method("b").problem("p", "tiny", 9);
  made_up.run("a", "p", Outcome::Solved, 0, 0, 0);
  made_up.run("b", "p", Outcome::Solved, 9e-4, -1, 1);
  const Comparison general = comparisons(made_up.data())[0];
  EXPECT_EQ(general.profiles[0].performance[0].first(), 1U);
  EXPECT_EQ(general.profiles[0].performance[1].first(), 1U);
  EXPECT_THAT(general.profiles[1].methods, ElementsAre(0));
  EXPECT_THAT(general.profiles[1].left_out, ElementsAre(1));
  EXPECT_EQ(general.profiles[1].data[0].steps[0].x, 0.1) << "1 evaluation in units of n + 1 = 10";
  EXPECT_EQ(general.profiles[2].performance[1].first(), 1U);
}

/// Would catch: a lead of one called a win, ties broken by the order of the methods.
TEST(Findings, LeadsAndTies) {
  MadeUp clear;
  clear.method("a").method("b").problems("tiny", 20).runs("a", "tiny", 20, 20).runs("b", "tiny", 20, 8);
  EXPECT_THAT(said(clear, "Most solved"), AllOf(HasSubstr("a solves the most: 20 of 20 pairs (100 %)"),
                                                HasSubstr("next comes b with 8"), Not(HasSubstr("Not clearly"))));
  MadeUp close;
  close.method("a").method("b").problems("tiny", 20).runs("a", "tiny", 20, 20).runs("b", "tiny", 20, 19);
  EXPECT_THAT(said(close, "Most solved"), HasSubstr("Not clearly behind it: b."));
  close.problems("games", 1).runs("a", "games", 1, 1).runs("b", "games", 1, 1);
  EXPECT_THAT(said(close, "Class by class"), HasSubstr("tiny: a alone (20 of 20, next b 19: no clear lead)"));
  MadeUp tie;
  tie.method("a").method("b").problems("tiny", 20).runs("a", "tiny", 20, 7).runs("b", "tiny", 20, 7);
  EXPECT_THAT(said(tie, "Most solved"), HasSubstr("All 2 methods solve as many, 7 of 20 pairs (35.0 %)."));
  EXPECT_THAT(said(tie, "Least cost"), HasSubstr("Quickest most often are a and b (on 7"));
  MadeUp last;
  last.method("a").method("b").method("c").method("d").problems("tiny", 9);
  last.runs("a", "tiny", 9, 9).runs("b", "tiny", 9, 5).runs("c", "tiny", 9, 2).runs("d", "tiny", 9, 2);
  EXPECT_THAT(said(last, "Most solved"),
              HasSubstr("next comes b with 5. Not clearly behind it: b. Fewest: c and d with 2."));
  MadeUp nothing;
  nothing.method("a").method("b").problems("tiny", 3).runs("a", "tiny", 3, 0).runs("b", "tiny", 3, 0);
  EXPECT_THAT(said(nothing, "Most solved"), HasSubstr("No method solves any of the 3 pairs"));
  EXPECT_EQ(said(nothing, "Least cost"), "");
}

/// Methods for affine problems are named with what they solve, and do not come into what is said of all.
TEST(Findings, MethodsForAffineProblems) {
  MadeUp made_up;
  made_up.method("a").method("lemke").problems("lcp", 6).problems("tiny", 6);
  made_up.runs("a", "lcp", 6, 6).runs("a", "tiny", 6, 6).runs("lemke", "lcp", 6, 4);
  for (int k = 1; k <= 6; ++k) made_up.run("lemke", "tiny" + std::to_string(k), Outcome::NotApplicable);
  EXPECT_EQ(said(made_up, "Most solved"), "a solves 12 of 12 pairs (100 %) of a problem with a solution and a start.");
  EXPECT_THAT(said(made_up, "Affine problems"), AllOf(HasSubstr("a solves the most: 6 of 6 pairs"),
                                                      HasSubstr("The methods for affine problems: lemke 4.")));
}

/// Would catch: verdicts about a class of two pairs.
TEST(Findings, FewPairsAreNotJudged) {
  MadeUp made_up;
  made_up.method("a").method("b").problems("games", 4).problems("lcp", 5);
  made_up.runs("a", "games", 4, 4).runs("b", "games", 4, 0).runs("a", "lcp", 5, 5).runs("b", "lcp", 5, 2);
  EXPECT_THAT(said(made_up, "Class by class"), AllOf(HasSubstr("lcp: a alone (5 of 5"),
                                                     HasSubstr("too few to tell: games"), Not(HasSubstr("games: a"))));
}

TEST(Findings, TheLecturesRanking) {
  const auto campaign = [](int ahead, int behind) {
    MadeUp made_up;
    made_up.problems("tiny", 20);
    for (const char* name : {"miles", "nesqp", "semicomp"}) made_up.method(name).runs(name, "tiny", 20, behind);
    for (const char* name : {"proxi", "path", "smooth"}) made_up.method(name).runs(name, "tiny", 20, ahead);
    return said(made_up, "The lecture's ranking");
  };
  EXPECT_THAT(campaign(20, 5),
              AllOf(HasSubstr("its ranking holds on these data"), HasSubstr("9 of 9 comparisons (9 clearly)")));
  EXPECT_THAT(campaign(5, 20), HasSubstr("these data turn its ranking round"));
  EXPECT_THAT(campaign(9, 9), HasSubstr("no difference between them is clear"));
  EXPECT_THAT(campaign(10, 9), HasSubstr("no difference between them is clear")) << "a lead of one pair";
  MadeUp two;
  two.problems("tiny", 20).method("path").runs("path", "tiny", 20, 20).method("miles").runs("miles", "tiny", 20, 5);
  EXPECT_EQ(
      said(two, "The lecture's ranking"),
      "The 1997 comparison of the lecture puts path ahead of miles: its ranking holds on these data. Solved of 20 "
      "pairs: path 20, miles 5. These are this program's presets, with what was added since: presolve, rescalings, "
      "restarts by other methods.");
  EXPECT_EQ(said(two, "The lecture's ranking, as published"), "");
  MadeUp both;
  both.problems("tiny", 20).method("path").method("miles").method("path-1997").method("miles-1997");
  both.runs("path", "tiny", 20, 20).runs("miles", "tiny", 20, 5);
  both.runs("path-1997", "tiny", 20, 9).runs("miles-1997", "tiny", 20, 9);
  EXPECT_EQ(
      said(both, "The lecture's ranking, as published"),
      "The 1997 comparison of the lecture puts path-1997 ahead of miles-1997: no difference between them is clear "
      "on these data. Solved of 20 pairs: path-1997 9, miles-1997 9.");
  EXPECT_EQ(said(two, "Class by class"), "") << "there is but one";
  MadeUp without;
  without.method("path").problems("tiny", 20).runs("path", "tiny", 20, 20);
  EXPECT_EQ(said(without, "The lecture's ranking"), "");
}

TEST(Findings, CFunctions) {
  MadeUp made_up;
  made_up.method("semismooth", "fischer-burmeister").method("semismooth:cfunction=min", "min").problems("tiny", 20);
  made_up.runs("semismooth", "tiny", 20, 20, 30).runs("semismooth:cfunction=min", "tiny", 20, 18, 12);
  EXPECT_THAT(
      said(made_up, "C-functions in semismooth"),
      AllOf(HasSubstr("fischer-burmeister (default) solves the most, 20 of 20 pairs (100 %)"),
            HasSubstr("next comes min with 18 (no clear lead)"),
            HasSubstr("On the 18 pairs that all solve min needs the fewest evaluations of F (geometric mean 12)"),
            HasSubstr("fischer-burmeister (default) the most (30)")));
}

TEST(Findings, FalseClaimsAndProblemsWithoutASolution) {
  MadeUp made_up;
  made_up.method("a").method("b").problem("p", "tiny").problem("none", "lcp", 2, 1, "row 1 is negative");
  made_up.run("a", "p", Outcome::FalseInfeasible);
  made_up.run("b", "p", Outcome::Solved);
  made_up.run("a", "none", Outcome::Infeasible);
  made_up.run("b", "none", Outcome::Failed);
  EXPECT_THAT(said(made_up, "False claims"), "1 cell claims what is not so: a 1.");
  EXPECT_THAT(said(made_up, "Problems without a solution"),
              "a recognises the most: 1 of 1 pair; none claims a solution.");
  made_up.cells[0].outcome = Outcome::Failed;
  EXPECT_THAT(said(made_up, "False claims"), "No method claimed what is not so.");
}

TEST(Findings, CampaignsThatAreNotFinished) {
  MadeUp made_up;
  made_up.method("a").method("b").problems("tiny", 6);
  EXPECT_THAT(said(made_up, "What ran"), HasSubstr("nothing can be said yet"));
  made_up.runs("a", "tiny", 6, 6).runs("b", "tiny", 3, 0);
  EXPECT_THAT(said(made_up, "What ran"), HasSubstr("3 of them are not finished"));
  EXPECT_THAT(said(made_up, "Most solved"), HasSubstr("a solves the most: 3 of 3 pairs"));
  made_up.method("not begun");
  EXPECT_THAT(said(made_up, "Most solved"), HasSubstr("a solves the most: 3 of 3 pairs"));
}

/// 99.96 % is not 100 %.
TEST(Words, SharesAndLists) {
  EXPECT_EQ(percent(2499, 2500), "99.9 %");
  EXPECT_EQ(percent(1, 2500), "0.1 %");
  EXPECT_EQ(percent(5, 5), "100 %");
  EXPECT_EQ(percent(0, 5), "0 %");
  EXPECT_EQ(percent(0, 0), "-");
  EXPECT_EQ(listed({}), "none");
  EXPECT_EQ(listed({"a", "b", "c", "d", "e"}), "a, b, c, d and e");
  EXPECT_EQ(listed({"a", "b", "c", "d", "e", "f"}), "a, b, c and 3 others");
}

}  // namespace
}  // namespace perp::app::comparison
