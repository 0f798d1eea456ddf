// SPDX-License-Identifier: Apache-2.0
/// `perp contact ball`: what it prints and writes, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <regex>

#include "app/contact/ball.hpp"
#include "app/json.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;
using testing::Not;

struct Output {
  ExitCode code = exit_internal;
  std::string out, err;
};

Output run(const BallRequest& request) {
  std::ostringstream out;
  std::ostringstream err;
  const ExitCode code = ball(request, {out, err});
  return {code, out.str(), err.str()};
}

BallRequest quick() {
  BallRequest request;
  request.ball.h = 0.05;
  request.ball.cycles = 2;
  return request;
}

BallScene scene_of(double load, std::initializer_list<int> facets) {
  BallScene scene{.ball = {.load = load, .cycles = 2, .h = 0.05}};
  for (const int K : facets) scene.paths.push_back(run_ball(scene.ball, {contact::FrictionLaw::Kind::Inner, K}));
  scene.paths.push_back(run_ball(scene.ball, {}));
  return scene;
}

// Without a word: the lecture's load and a larger one, four polygons and the exact law, which alone is 0 from itself.
TEST(BallCommand, SaysHowFarFacetsLeadAstray) {
  const Output output = run(quick());
  EXPECT_EQ(output.code, exit_solved) << output.err;
  for (const char* words : {"Load 1 mu m g", "Load 1.5 mu m g", "inner:4", "inner:16", "exact", "drift"})
    EXPECT_THAT(output.out, HasSubstr(words));
  EXPECT_THAT(output.out, Not(HasSubstr("-0.000")));
  EXPECT_THAT(output.out, Not(HasSubstr("unsolved")));
}

// The keys of docs/schema/contact-ball.json, and that JSON says what contact::run_ball does.
TEST(BallCommand, JsonHasPathsAndEnergies) {
  BallRequest request = quick();
  request.facets = "4";
  request.exact = true;
  request.loads = "1.5";
  request.json = "-";
  const Output output = run(request);
  ASSERT_EQ(output.code, exit_solved) << output.err;
  EXPECT_THAT(output.err, HasSubstr("inner:4"));
  const Json root = parse_json(output.out);
  EXPECT_EQ(root["problem"], "ball");
  EXPECT_EQ(root["exit_code"], 0);
  const Json& paths = root["loads"][0]["paths"];
  ASSERT_EQ(paths.size(), 2U);
  EXPECT_EQ(paths[0]["law"], "inner:4");
  EXPECT_EQ(paths[1]["law"], "exact");
  EXPECT_EQ(paths[1]["from_exact"], 0);
  EXPECT_GT(paths[0]["from_exact"], 10);
  const BallScene scene = scene_of(1.5, {4});
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(paths[k]["end"][0], scene.paths[k].centres.back().x());
    EXPECT_EQ(paths[k]["path"].size(), paths[k]["steps"].get<std::size_t>() + 1);
    EXPECT_EQ(paths[k]["path"].back()[1], paths[k]["end"][0]);
    EXPECT_NEAR(paths[k]["energy"]["kinetic"].get<double>() + paths[k]["energy"]["friction"].get<double>(),
                paths[k]["energy"]["work"], 1e-6);
  }
}

// More steps than points: every other one and the last.
TEST(BallCommand, LongPathsAreThinned) {
  BallRequest request = quick();
  request.exact = true;
  request.loads = "1.5";
  request.json = "-";
  request.ball.h = 0.025;
  const Json path = parse_json(run(request).out)["loads"][0]["paths"][0];
  EXPECT_EQ(path["steps"], 1200);
  EXPECT_EQ(path["path"].size(), 601U);
  EXPECT_EQ(path["path"].back()[0], 30.0);
}

TEST(BallCommand, PolygonsOrTheExactLawAlone) {
  BallRequest request = quick();
  request.exact = true;
  EXPECT_THAT(run(request).out, Not(HasSubstr("inner")));
  request.exact = false;
  request.facets = "8";
  request.outer = true;
  const Output output = run(request);
  EXPECT_THAT(output.out, HasSubstr("outer:8"));
  EXPECT_THAT(output.out, Not(HasSubstr("\n  exact")));
}

TEST(BallCommand, RefusesWithFlagAndValue) {
  const auto why = [](auto change) {
    BallRequest request = quick();
    change(request);
    const Output output = run(request);
    EXPECT_EQ(output.code, exit_input);
    EXPECT_EQ(output.out, "");
    return output.err;
  };
  EXPECT_THAT(why([](BallRequest& r) { r.facets = "4,2"; }), HasSubstr("--facets 4,2: 2 is not in [3, 1000]"));
  EXPECT_THAT(why([](BallRequest& r) { r.facets = "4,x"; }), HasSubstr("'x' is no number"));
  EXPECT_THAT(why([](BallRequest& r) { r.facets = ""; }), HasSubstr("--facets"));
  EXPECT_THAT(why([](BallRequest& r) { r.facets = "8,8"; }), HasSubstr("8 stands there twice"));
  EXPECT_THAT(why([](BallRequest& r) { r.loads = "-1"; }), HasSubstr("--load -1"));
  EXPECT_THAT(why([](BallRequest& r) { r.loads = "nan"; }), HasSubstr("--load nan"));
  EXPECT_THAT(why([](BallRequest& r) { r.loads = "1,2,3,4,5,6,7"; }), HasSubstr("7 loads"));
  EXPECT_THAT(why([](BallRequest& r) { r.frame = std::numeric_limits<double>::infinity(); }), HasSubstr("--frame inf"));
  EXPECT_THAT(why([](BallRequest& r) { r.ball.mu = -1; }), HasSubstr("mu is -1"));
  EXPECT_THAT(why([](BallRequest& r) { r.ball.h = 0; }), HasSubstr("h is 0"));
  EXPECT_THAT(why([](BallRequest& r) { r.ball.theta = 2; }), HasSubstr("theta is 2"));
  EXPECT_THAT(why([](BallRequest& r) { r.json = "/no/such/folder/x.json"; }), HasSubstr("no folder"));
}

TEST(BallCommand, InterruptedIsNotSolved) {
  const std::atomic<bool> interrupt = true;
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(ball(quick(), {out, err}, &interrupt), exit_unsolved);
  EXPECT_THAT(out.str(), HasSubstr("interrupted"));
}

// The program: `ball` is a command after `contact`, with flags of its own and nothing before it.
TEST(BallCommand, IsAPartOfContact) {
  const test::Folder folder;
  const auto program = [&](const std::string& arguments) {
    const std::string command =
        std::string("'") + PERP_PROGRAM + "' contact " + arguments + " > '" + (folder / "text") + "' 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  EXPECT_EQ(program("ball --facets 4,8 --exact --cycles 1 --step 0.1"), 0);
  EXPECT_THAT(test::read(folder / "text"), HasSubstr("inner:8"));
  EXPECT_EQ(program("ball --help"), 0);
  EXPECT_THAT(test::read(folder / "text"), HasSubstr("--rolling"));
  EXPECT_EQ(program("stack:4 ball"), exit_input);
  EXPECT_THAT(test::read(folder / "text"), HasSubstr("stands before 'ball'"));
  EXPECT_EQ(program("ball --facet 4"), exit_input);
  EXPECT_THAT(test::read(folder / "text"), HasSubstr("perp contact ball: there is no flag '--facet'. Did you mean"));
}

// Would catch a flag that was added without a word in the man page or to the shell.
TEST(BallCommand, ManPageAndCompletionKnowEveryFlag) {
  const test::Folder folder;
  const std::string text = folder / "help";
  ASSERT_EQ(std::system((std::string("'") + PERP_PROGRAM + "' contact ball --help > '" + text + "'").c_str()), 0);
  const std::string help = test::read(text);
  std::string page = test::read(PERP_MAN_PAGE);
  page = page.substr(page.find(".Ss perp contact ball"));
  page = page.substr(0, page.find("\n.Ss ", 1));
  const std::string completion = test::offered("contact ball --");
  const std::regex flag("--([a-z]+)");
  int flags = 0;
  for (std::sregex_iterator it(help.begin(), help.end(), flag), end; it != end; ++it, ++flags) {
    if ((*it)[1] != "help") {
      EXPECT_THAT(page, HasSubstr("Fl -" + it->str(1)));
    }
    EXPECT_THAT(completion, HasSubstr(it->str()));
  }
  EXPECT_GE(flags, 13);
}

}  // namespace
}  // namespace perp::app::contacts
