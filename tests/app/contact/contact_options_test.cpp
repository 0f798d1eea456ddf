// SPDX-License-Identifier: Apache-2.0
/// `perp contact --option key=value`: options of the homotopy, of Glocker's NCP and of the methods of ncp and lcp.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "app/contact/contact.hpp"
#include "app/contact/run/variant.hpp"
#include "app/json.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using test::Answer;
using test::answer;
using test::Json;
using testing::HasSubstr;
using testing::Not;

std::string why(const VariantRequest& request) {
  return test::refused([&] { parse_variant(request); });
}

// Every key reaches its own field. Would catch two keys on one field.
TEST(ContactOptions, OfTheHomotopy) {
  const auto plain = std::get<contact::Auto>(parse_variant(VariantRequest{}).solver);
  const contact::GlockerHomotopy usual;
  EXPECT_EQ(plain.sweeps, contact::Auto{}.sweeps);
  EXPECT_EQ(plain.homotopy.max_iterations, usual.max_iterations);
  const Variant all =
      parse_variant({.options = {"max_iterations=7", "sweeps=3", "polish=no", "polish_at=0.25", "proximal=0",
                                 "scaling=FALSE", "delta_share=0.2", "eps_share=0.3", "least_centring=0.4",
                                 "to_boundary=0.5", "neighbourhood=0.6", "LU=klu", "sweeps=5"}});
  const auto& whole = std::get<contact::Auto>(all.solver);
  const contact::GlockerHomotopy& m = whole.homotopy;
  EXPECT_EQ(m.max_iterations, 7);
  EXPECT_EQ(whole.sweeps, 5) << "the last one counts";
  EXPECT_FALSE(whole.polish);
  EXPECT_EQ(whole.polish_at, 0.25);
  EXPECT_FALSE(whole.proximal);
  EXPECT_FALSE(m.scaling);
  EXPECT_EQ(m.options.delta_share, 0.2);
  EXPECT_EQ(m.options.eps_share, 0.3);
  EXPECT_EQ(m.options.least_centring, 0.4);
  EXPECT_EQ(m.options.to_boundary, 0.5);
  EXPECT_EQ(m.options.neighbourhood, 0.6);
  EXPECT_EQ(m.options.lu, lcp::LuBackend::Klu);
  const Variant variant = parse_variant({.method = "homotopy", .options = {"max_iterations=9", "eps_share=0.7"}});
  const auto& alone = std::get<contact::GlockerHomotopy>(variant.solver);
  EXPECT_EQ(alone.max_iterations, 9);
  EXPECT_EQ(alone.options.eps_share, 0.7);
}

TEST(ContactOptions, OfGlockersNcp) {
  const Variant variant = parse_variant({.method = "semismooth",
                                         .encoding = "B",
                                         .options = {"delta=1e-7", "eps=1e-8", "stages=2", "scaling=no", "lu=klu"}});
  const auto& ncp = std::get<contact::GlockerNcp>(variant.solver);
  EXPECT_EQ(ncp.formulation.delta, 1e-7);
  EXPECT_EQ(ncp.formulation.eps, 1e-8);
  EXPECT_EQ(ncp.formulation.encoding, contact::Encoding::B);
  EXPECT_EQ(ncp.stages, 2);
  EXPECT_FALSE(ncp.scaling);
  const auto* newton = std::get_if<ncp::SemismoothNewton>(&ncp.method);
  ASSERT_NE(newton, nullptr);
  EXPECT_EQ(newton->lu, lcp::LuBackend::Klu);
}

// What is set is what runs: no sweeps, no Newton steps; one iteration is not enough.
TEST(ContactOptions, ReachTheRun) {
  const Answer bare = answer({.problems = {"spheres:20"}, .variant = {.options = {"sweeps=0", "polish=no"}}});
  EXPECT_EQ(bare.code, exit_solved) << bare.err;
  EXPECT_EQ(bare.result["stats"]["sweeps"], 0);
  EXPECT_EQ(bare.result["stats"]["newton_steps"], 0);
  EXPECT_GT(bare.result["stats"]["iterations"].get<int>(), 3);
  EXPECT_EQ(bare.result["options"], Json::array({"sweeps=0", "polish=no"}));
  EXPECT_THAT(bare.err, HasSubstr("options: sweeps=0, polish=no"));
  const Answer cut = answer({.problems = {"spheres:20"},
                             .variant = {.options = {"sweeps=0", "polish=no", "max_iterations=1", "proximal=no"}}});
  EXPECT_EQ(cut.code, exit_unsolved);
  EXPECT_EQ(cut.result["stats"]["iterations"], 1);
  for (const VariantRequest& variant :
       {VariantRequest{.method = "miles", .options = {"major_iteration_limit=1", "stages=1"}},
        VariantRequest{.formulation = "ncp1", .method = "miles", .options = {"major_iteration_limit=1"}}}) {
    const Answer one = answer({.problems = {"spheres:20"}, .variant = variant});
    EXPECT_EQ(one.code, exit_unsolved) << one.result["variant"];
    EXPECT_LE(one.result["stats"]["iterations"].get<int>(), 1);
  }
  const Answer pivots =
      answer({.problems = {"spheres:20"},
              .variant = {.formulation = "inner:8", .method = "lemke", .options = {"minor_iteration_limit=2"}}});
  EXPECT_EQ(pivots.code, exit_unsolved);
  EXPECT_LE(pivots.result["stats"]["iterations"].get<int>(), 2);
}

TEST(ContactOptions, RefusedWithWhatIsKnown) {
  EXPECT_THAT(why({.options = {"sweep=0"}}),
              testing::AllOf(HasSubstr("'sweep'"), HasSubstr("polish_at"), HasSubstr("Did you mean 'sweeps'")));
  EXPECT_THAT(why({.options = {"sweeps"}}), HasSubstr("key=value"));
  EXPECT_THAT(why({.options = {"sweeps="}}), HasSubstr("(nothing)"));
  EXPECT_THAT(why({.options = {"sweeps=1.5"}}), HasSubstr("it takes an integer"));
  EXPECT_THAT(why({.options = {"sweeps=99999999999"}}), HasSubstr("it takes an integer"));
  EXPECT_THAT(why({.options = {"sweeps=-1"}}), HasSubstr("sweeps = -1 is refused; it takes an integer >= 0"));
  EXPECT_THAT(why({.options = {"polish=maybe"}}), HasSubstr("yes or no"));
  EXPECT_THAT(why({.options = {"lu=mumps"}}), HasSubstr(std::string(to_string(lcp::LuBackend::General)) + ", klu"));
  EXPECT_THAT(why({.options = {"delta_share=nan"}}), HasSubstr("a number in (0, 10)"));
  EXPECT_THAT(why({.options = {"to_boundary=1"}}), HasSubstr("in (0, 1)"));
  EXPECT_THAT(why({.options = {"delta=1e-9"}}), HasSubstr("method auto has no option 'delta'"));
  EXPECT_THAT(why({.method = "homotopy", .options = {"sweeps=0"}}),
              HasSubstr("method homotopy has no option 'sweeps'"));
  const VariantRequest path{.method = "path"};
  const auto why_path = [&](const std::string& option) {
    VariantRequest request = path;
    request.options = {option};
    return why(request);
  };
  EXPECT_THAT(why_path("foo=1"), testing::AllOf(HasSubstr("'foo'"), HasSubstr("delta, eps, stages, scaling")));
  EXPECT_THAT(why_path("delta=0"), HasSubstr("delta = 0 is refused"));
  EXPECT_THAT(why_path("stages=0"), HasSubstr("stages = 0 is refused"));
  EXPECT_THAT(why_path("lu=mumps"), testing::AllOf(HasSubstr(", klu, eigen"), Not(HasSubstr("stages"))));
  EXPECT_THAT(why_path("method=miles"), HasSubstr("--method"));
  EXPECT_EQ(parse_variant(VariantRequest{.method = "path", .options = {"time_limit=2"}}).applied.seconds, 2);
  EXPECT_EQ(parse_variant(VariantRequest{.formulation = "ncp1", .options = {"tol=1e-7"}}).applied.tol, 1e-7);
  EXPECT_EQ(parse_variant(VariantRequest{.options = {"tol=1e-7"}}).applied.tol, 1e-7);
  EXPECT_THAT(why({.formulation = "ncp1", .options = {"stages=2"}}), HasSubstr("'stages'"));
  EXPECT_THAT(why({.formulation = "inner:8", .options = {"lu=klu"}}), HasSubstr("by auto has no options"));
}

TEST(ContactOptions, WithoutEffectIsSaid) {
  test::Captured captured;
  EXPECT_EQ(
      solve_contact({.problems = {"stack:4"},
                     .variant = {.formulation = "inner:4", .method = "lemke", .options = {"sigma=0.1", "output=no"}}},
                    captured.streams),
      exit_solved);
  EXPECT_THAT(captured.err.str(), testing::AllOf(HasSubstr("sigma has no effect on method lemke"),
                                                 HasSubstr("output has no effect on contact problems")));
  // The first NCP has evaluations to limit.
  const auto said = [](const char* formulation, const char* method) {
    test::Captured again;
    solve_contact({.problems = {"stack:4"},
                   .variant = {.formulation = formulation, .method = method, .options = {"evaluation_limit=100000"}}},
                  again.streams);
    return again.err.str();
  };
  EXPECT_THAT(said("ncp1", "miles"), Not(HasSubstr("no effect")));
}

// Would catch a key that was added without a word in the man page, the README or to the shell.
TEST(ContactOptions, AreDocumented) {
  const std::string page = test::read(PERP_MAN_PAGE);
  const std::string readme = test::read(PERP_SOURCE_DIR "/app/README.md");
  const std::string shell = test::offered("contact --option ''");
  const std::string all = contact::own_keys(contact::Auto{}) + ", " + contact::own_keys(contact::GlockerNcp{});
  const std::regex word("[a-z_]+");
  int keys = 0;
  for (std::sregex_iterator it(all.begin(), all.end(), word), end; it != end; ++it, ++keys) {
    EXPECT_THAT(page, HasSubstr(it->str()));
    EXPECT_THAT(readme, HasSubstr(fmt::format("`{}`", it->str())));
    EXPECT_THAT(shell, HasSubstr(fmt::format(" {}= ", it->str())));
  }
  EXPECT_EQ(keys, 17);
}

}  // namespace
}  // namespace perp::app::contacts
