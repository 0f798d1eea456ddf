// SPDX-License-Identifier: Apache-2.0
/// The LISTs of perp compare and campaign.json.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/campaign/campaign.hpp"
#include "app/campaign/selection.hpp"
#include "app/support.hpp"
#include "ncp/collection/collection.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::app::compare {
namespace {

using test::refused;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<std::string> problems(const std::string& list) {
  std::vector<std::string> names;
  for (const AskedProblem& problem : select_problems(list)) names.push_back(problem.name);
  return names;
}

std::vector<std::string> methods_of(const std::string& list) {
  std::vector<std::string> labels, notes;
  for (const AskedMethod& method : select_methods(list, 1e-6, notes)) labels.push_back(method.label);
  return labels;
}

std::string problems_refusal(const std::string& list) {
  return refused([&] { select_problems(list); });
}
std::string methods_refusal(const std::string& list) {
  return refused([&] { methods_of(list); });
}

TEST(Selection, ProblemsByNameClassPatternAndSize) {
  EXPECT_THAT(problems("kojshin, billups,kojshin"), ElementsAre("kojshin", "billups"));
  EXPECT_EQ(problems("all").size(), ncp::collection::entries().size());
  for (const AskedProblem& problem : select_problems("class:tiny")) EXPECT_EQ(problem.cls, "tiny");
  EXPECT_THAT(problems("class:tiny"), Contains("kojshin"));
  EXPECT_THAT(problems("hs3[45]-kk?"), ElementsAre("hs34-kkt", "hs35-kkt"));
  EXPECT_THAT(problems("obstacle:30x20"), ElementsAre("obstacle:30x20"));
  EXPECT_EQ(select_problems("obstacle:30x20").front().cls, "pde");
}

// Would catch exclusions that only count if they come last, or that exclude from nothing.
TEST(Selection, ExclusionsCountWhereverTheyStand) {
  EXPECT_THAT(problems("-kojshin,class:tiny"), Not(Contains("kojshin")));
  EXPECT_THAT(problems("class:tiny,-hs*,-class:lcp"), Not(Contains("hs34-kkt")));
  const std::vector<std::string> rest = problems("-class:lcp");
  EXPECT_THAT(rest, Contains("kojshin"));
  EXPECT_THAT(rest, Not(Contains("cottle2")));
  EXPECT_THAT(methods_of("presets,-robin*,-path"), Not(Contains("path")));
  EXPECT_THAT(methods_of("presets,-robin*"), Contains("path"));
}

TEST(Selection, UnknownProblemsAreRefusedWithSuggestions) {
  EXPECT_THAT(problems_refusal("kojshim"), HasSubstr("'kojshin'"));
  EXPECT_THAT(problems_refusal("class:tyni"), HasSubstr("tiny"));
  EXPECT_THAT(problems_refusal("zz*"), HasSubstr("fits 'zz*'"));
  EXPECT_THAT(problems_refusal("kojshin,,billups"), HasSubstr("empty"));
  EXPECT_THAT(problems_refusal(""), HasSubstr("empty"));
  EXPECT_THAT(problems_refusal("no/such.nl"), HasSubstr("there is no file 'no/such.nl'"));
  EXPECT_THAT(problems_refusal("kojshin,-kojshin"), HasSubstr("nothing is left"));
  EXPECT_THAT(problems_refusal("-kojshim"), HasSubstr("'kojshin'")) << "also what is taken away must exist";
}

TEST(Selection, FilesAreKnownByTheirNames) {
  const test::Folder folder;
  std::filesystem::create_directories(folder / "other");
  test::write(folder / "a.nl", test::sqrt2_nl());
  test::write(folder / "b.nl", test::sqrt2_nl());
  test::write(folder / "other/a.nl", test::sqrt2_nl());
  const std::vector<AskedProblem> one = select_problems(folder / "a.nl");
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].name, "a.nl");
  EXPECT_EQ(one[0].cls, "nl");
  EXPECT_TRUE(std::filesystem::path(one[0].file).is_absolute());
  EXPECT_THAT(problems(folder / "*.nl"), ElementsAre("a.nl", "b.nl"));
  EXPECT_THAT(problems_refusal((folder / "a.nl") + "," + (folder / "other/a.nl")), HasSubstr("two files"));
}

TEST(Selection, Methods) {
  EXPECT_EQ(methods_of("presets").size(), ncp::presets().size());
  EXPECT_EQ(methods_of("all").size(), app::methods().size());
  EXPECT_EQ(methods_of("cfunctions").size(), ncp::cfunctions().size());
  EXPECT_EQ(methods_of("cfunction-grid").size(), ncp::cfunction_grid().size());
  EXPECT_THAT(methods_of("cfunction-grid"), Contains("semismooth:cfunction=min-rho-b:cfunction_parameter=0.01"));
  EXPECT_THAT(methods_of("none"), IsEmpty());
  EXPECT_THAT(methods_of("semismooth-*"), ElementsAre("semismooth-min", "semismooth-penalised", "semismooth-1997"));
  EXPECT_EQ(methods_of("published").size(), ncp::published().size());
  EXPECT_EQ(methods_of("*-1997").size(), 8U);
}

// The word takes values of parameters, by their names, and options for all. Two functions have a lambda, and 2 lies in
// the range of one of them. Catches a parameter that replaces those of other functions, and a value nobody takes.
TEST(Selection, ParametersOfCFunctions) {
  EXPECT_THAT(
      methods_of("cfunctions:rho=0.01:rho=1e2:lambda=2:lu=klu"),
      ElementsAre("semismooth:cfunction=min:lu=klu", "semismooth:cfunction=min-rho-b:cfunction_parameter=0.01:lu=klu",
                  "semismooth:cfunction=min-rho-b:cfunction_parameter=1e2:lu=klu",
                  "semismooth:cfunction=min-rho-a:cfunction_parameter=0.01:lu=klu",
                  "semismooth:cfunction=min-rho-a:cfunction_parameter=1e2:lu=klu",
                  "semismooth:cfunction=fischer-burmeister:lu=klu",
                  "semismooth:cfunction=penalised-fischer-burmeister:lu=klu",
                  "semismooth:cfunction=evtushenko-purtov:lu=klu",
                  "semismooth:cfunction=kanzow-kleinmichel:cfunction_parameter=2:lu=klu",
                  "semismooth:cfunction=luo-tseng:lu=klu"));
  for (const char* wrong : {"cfunctions:rho=0", "cfunctions:lambda=4", "cfunctions:alpha=x", "cfunctions:rho="})
    EXPECT_THAT(methods_refusal(wrong), HasSubstr("no C-function takes")) << wrong;
  EXPECT_THAT(methods_refusal("cfunctions:roh=1"), HasSubstr("roh"));
  EXPECT_THAT(methods_refusal("cfunctions:rho"), HasSubstr("="));
}

// Options reach the method, the campaign's tolerance only where none is given.
TEST(Selection, OptionsOfMethods) {
  std::vector<std::string> notes;
  const std::string label = "semismooth:cfunction=kanzow-kleinmichel:tol=1e-9";
  const std::vector<AskedMethod> chosen = select_methods(label + ",path", 1e-5, notes);
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_EQ(chosen[0].label, label);
  EXPECT_EQ(chosen[0].name, "semismooth");
  EXPECT_THAT(chosen[0].options, ElementsAre("cfunction=kanzow-kleinmichel", "tol=1e-9"));
  EXPECT_THAT(chosen[0].in_force, Contains(std::pair<std::string, std::string>("cfunction", "kanzow-kleinmichel")));
  EXPECT_EQ(ncp::stop(settings_of(chosen[0], 1e-5).settings.method).tol, 1e-9);
  EXPECT_EQ(ncp::stop(settings_of(chosen[1], 1e-5).settings.method).tol, 1e-5);
  EXPECT_THAT(notes, IsEmpty());
  select_methods("path:cfunction=min", 1e-5, notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("no effect on method path")));
}

TEST(Selection, UnknownMethodsAndOptionsAreRefused) {
  EXPECT_THAT(methods_refusal("semismoth"), HasSubstr("'semismooth'"));
  EXPECT_THAT(methods_refusal("preset"), HasSubstr("'presets'"));
  EXPECT_THAT(methods_refusal("zz*"), HasSubstr("fits 'zz*'"));
  EXPECT_THAT(methods_refusal("path:no_such=3"), HasSubstr("no_such"));
  EXPECT_THAT(methods_refusal("path:tol=-3"), HasSubstr("-3"));
  EXPECT_THAT(methods_refusal("path:tol"), HasSubstr("tol"));
  EXPECT_THAT(methods_refusal("path:method=miles"), HasSubstr("before the first"));
}

TEST(Selection, Externals) {
  const AskedMethod external = parse_external("peer=/bin/sh -c true");
  EXPECT_EQ(external.label, "peer");
  EXPECT_EQ(external.command, "/bin/sh -c true");
  EXPECT_TRUE(external.external());
  EXPECT_EQ(parse_external("sh=sh").command, "sh");
  for (const char* wrong :
       {"peer", "=sh", "peer=", "pe er=sh", "a,b=sh", "path=sh", "peer=/no/such/program", "peer=no-such-program-here"})
    EXPECT_THAT(refused([&] { parse_external(wrong); }), testing::StartsWith("--external")) << wrong;
}

Campaign example_campaign() {
  std::vector<std::string> notes;
  Campaign campaign{.methods = select_methods("path,semismooth:tol=1e-9", 1e-6, notes),
                    .problems = select_problems("kojshin,billups")};
  campaign.problems[0].starts = 8;
  campaign.problems[1].starts = 5;
  campaign.command_line = {"perp", "compare"};
  stamp(campaign);
  return campaign;
}

TEST(CampaignFile, IsReadBack) {
  const Campaign campaign = example_campaign();
  EXPECT_EQ(campaign.cells(), 2U * 13U);
  EXPECT_GT(campaign.machine.cores, 0);
  EXPECT_GT(campaign.machine.memory_mb, 0);
  const Campaign back = parse_campaign(campaign_json(campaign));
  EXPECT_EQ(campaign_json(back), campaign_json(campaign));
  EXPECT_THAT(differences(campaign, back), IsEmpty());
}

TEST(CampaignFile, DamagedOnesAreRefused) {
  const std::string text = campaign_json(example_campaign());
  EXPECT_THROW(parse_campaign(text.substr(0, text.size() / 2)), InputError);
  EXPECT_THROW(parse_campaign("{}"), InputError);
  EXPECT_THROW(parse_campaign("[]"), InputError);
  EXPECT_THROW(parse_campaign(""), InputError);
}

// A damaged campaign.json. Would catch numbers turned into an int that does not hold them (undefined from a double),
// and starts that are believed: a report makes a row of each, `perp compare --resume` a run.
TEST(CampaignFile, NumbersOutOfRangeAreRefused) {
  Campaign campaign;
  campaign.problems = select_problems("kojshin");
  campaign.problems.front().starts = 3;
  campaign.restarts = 5;
  const std::string text = campaign_json(campaign);
  const auto with = [&](const std::string& was, const std::string& is) {
    std::string changed = text;
    const std::size_t at = changed.find(was);
    EXPECT_NE(at, std::string::npos) << was;
    return changed.replace(at, was.size(), is);
  };
  EXPECT_EQ(parse_campaign(with(R"("starts": 3)", R"("starts": 4)")).problems.front().starts, 4);
  for (const char* starts : {"-1", "0", "2000000000", "4294967299", "1e300", "3.5"})
    EXPECT_THROW(parse_campaign(with(R"("starts": 3)", std::string("\"starts\": ") + starts)), InputError) << starts;
  for (const char* starts : {"-1", "1e300"})
    EXPECT_THROW(parse_campaign(with(R"("starts": "all")", std::string("\"starts\": ") + starts)), InputError)
        << starts;
  for (const char* restarts : {"-1", "4294967296", "1e300"})
    EXPECT_THROW(parse_campaign(with(R"("restarts": 5)", std::string("\"restarts\": ") + restarts)), InputError)
        << restarts;
  EXPECT_THROW(parse_campaign(with(R"("memory_limit_mb": 4096)", R"("memory_limit_mb": 1e300)")), InputError);
}

// A short file may ask for more cells than there is memory. Would catch a report that makes a table of them all.
TEST(CampaignFile, MoreCellsThanAnybodyRunsAreRefused) {
  Campaign campaign;
  campaign.methods.assign(1000, {.label = "path", .name = "path"});
  campaign.problems.assign(1000, {.name = "kojshin", .starts = 10});
  EXPECT_EQ(parse_campaign(campaign_json(campaign)).cells(), 10'000'000U);
  campaign.problems.front().starts = 11;
  EXPECT_THROW(parse_campaign(campaign_json(campaign)), InputError);
  campaign.methods.clear();  // nor starts of nobody
  campaign.problems.assign(1001, {.name = "kojshin", .starts = 10'000});
  EXPECT_THROW(parse_campaign(campaign_json(campaign)), InputError);
}

// Each thing that cells depend on is named when it differs, and nothing else is.
TEST(CampaignFile, DifferencesAreNamed) {
  const Campaign before = example_campaign();
  const auto changed = [&](auto change) {
    Campaign now = before;
    change(now);
    return differences(before, now);
  };
  EXPECT_THAT(changed([](Campaign& c) { c.tol = 1e-8; }), ElementsAre("--tol: 1e-06 there, 1e-08 here"));
  EXPECT_THAT(changed([](Campaign& c) { c.time_limit = 1; }), ElementsAre(HasSubstr("--time-limit")));
  EXPECT_THAT(changed([](Campaign& c) { c.memory_mb = 1; }), ElementsAre(HasSubstr("--memory-limit")));
  EXPECT_THAT(changed([](Campaign& c) { c.restarts = 1; }), ElementsAre(HasSubstr("--restarts")));
  EXPECT_THAT(changed([](Campaign& c) { c.seed = 7; }), ElementsAre(HasSubstr("--seed")));
  EXPECT_THAT(changed([](Campaign& c) { c.version = "9"; }), ElementsAre(HasSubstr("version")));
  EXPECT_THAT(changed([](Campaign& c) { c.problems.pop_back(); }), ElementsAre("problems there but not here: billups"));
  EXPECT_THAT(changed([](Campaign& c) { c.problems[0].starts = 1; }),
              ElementsAre("starts of kojshin: 8 there, 1 here"));
  EXPECT_THAT(changed([](Campaign& c) { c.methods[0].label = "path:x=1"; }),
              ElementsAre("methods there but not here: path", "methods here but not there: path:x=1"));
  EXPECT_THAT(changed([](Campaign& c) { c.methods[0].in_force[0].second = "else"; }),
              ElementsAre(HasSubstr("of path")));
  EXPECT_THAT(changed([](Campaign& c) { c.jobs = 17; }), IsEmpty());
}

}  // namespace
}  // namespace perp::app::compare
