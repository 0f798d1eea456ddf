// SPDX-License-Identifier: Apache-2.0
/// Options are described once: what a description says, and that it leaves nothing out.
#include "ncp/problem/fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "ncp/strategy/presets.hpp"

namespace perp::ncp {
namespace {

using testing::Optional;

// Would catch an end of a range that the words give otherwise than the check.
TEST(Fields, WordsAndChecksAgreeOnRanges) {
  double number = 0;
  int integer = 0;
  struct Case {
    Range range;
    std::string words;
    std::vector<double> taken, refused;
  };
  const double inf = std::numeric_limits<double>::infinity();
  for (const Case& c :
       {Case{at_least(1), ">= 1", {1, 5}, {0.5, inf}}, Case{above(0), "> 0", {1e-300, 5}, {0, -1, inf}},
        Case{between(0, 2), "in [0, 2]", {0, 2}, {-1, 3}}, Case{strictly_between(0, 1), "in (0, 1)", {0.5}, {0, 1}},
        Case{above_up_to(0, 1), "in (0, 1]", {0.5, 1}, {0, 1.5}},
        Case{{.low = 0, .open_low = true}, "> 0", {1, inf}, {0}}}) {
    Fields fields;
    fields.add("number", &number, c.range, "some number");
    EXPECT_EQ(takes(*fields.find("number")), "a number " + c.words);
    for (number = 0; const double x : c.taken) {
      number = x;
      EXPECT_EQ(fields.invalid(), std::nullopt) << c.words << ": " << x;
    }
    for (const double x : c.refused) {
      number = x;
      EXPECT_NE(fields.invalid(), std::nullopt) << c.words << ": " << x;
    }
    number = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(fields.invalid(), Optional("number is nan; it takes a number " + c.words));
  }
  Fields fields;
  fields.add("integer", &integer, between(1, 2), "some integer");
  EXPECT_THAT(fields.invalid(), Optional(std::string("integer is 0; it takes an integer in [1, 2]")));
}

// An option without effect now may get it back: it is checked all the same, and so is what no key reaches.
TEST(Fields, WhatIsInertOrHiddenIsChecked) {
  double inner = 2;
  Fields fields;
  fields.when(false, "outer = no", [&] { fields.add("inner", &inner, strictly_between(0, 1), "some number"); });
  fields.add("after", &inner, above(0), "some number");
  EXPECT_EQ(fields.find("inner")->inert, "outer = no");
  EXPECT_EQ(fields.find("after")->inert, "");
  EXPECT_NE(fields.invalid(), std::nullopt);
  fields.hide("inner");
  EXPECT_EQ(fields.find("inner"), nullptr);
  EXPECT_EQ(fields.options().size(), 1U);
  EXPECT_NE(fields.invalid(), std::nullopt);
}

// Members of an aggregate, counted by how many values it can be made from.

struct Anything {
  template <class T>
  operator T() const;
};
template <class T, std::size_t... I>
constexpr bool made_from(std::index_sequence<I...>) {
  return requires { T{(static_cast<void>(I), Anything{})...}; };
}
template <class T, std::size_t N = 40>
constexpr std::size_t members() {
  if constexpr (N == 0 || made_from<T>(std::make_index_sequence<N>{}))
    return N;
  else
    return members<T, N - 1>();
}

/// Options that describe() gives the struct.
template <class T>
std::size_t described() {
  T options{};
  Fields fields;
  describe(options, fields);
  return fields.options().size();
}

// Each member of each option struct has a key, or a reason why not. Would catch a new member that nobody can set.
TEST(Fields, ReachEveryMember) {
  struct Count {
    const char* name;
    std::size_t members, described;
    std::size_t parts;    ///< members that are structs of this list
    std::size_t of_them;  ///< described by these
    std::size_t without;  ///< members without a key, for the reason given
  };
  const std::size_t stop = described<Stop>(), armijo = described<Armijo>(), escape = described<Escape>(),
                    lemke = described<lcp::LemkeOptions>(), crash = described<Crash>(), nms = described<Nms>(),
                    forcing = described<Forcing>(), cfunction = described<CFunction>(),
                    smoothing = described<SmoothingFunction>(), path = described<PathSearch>();
  for (const Count& c :
       {Count{"Stop", members<Stop>(), stop, 0, 0, 1},  // interrupt is for programs
        Count{"Armijo", members<Armijo>(), armijo, 0, 0, 0},
        // trial_iterations is for programs
        Count{"Escape", members<Escape>(), escape, 0, 0, 1},
        // max_iterations is for programs
        Count{"Forcing", members<Forcing>(), forcing, 0, 0, 1},
        // descent_rho is for programs
        Count{"SemismoothNewton", members<SemismoothNewton>(), described<SemismoothNewton>(), 4,
              cfunction + armijo + forcing, 1},
        // direction is a method of its own on the command line
        Count{"MinNewton", members<MinNewton>(), described<MinNewton>(), 2, armijo, 1},
        // restarts is of lists
        Count{"Smoothing", members<Smoothing>(), described<Smoothing>(), 3, smoothing + armijo, 1},
        // follow is for programs
        Count{"InteriorPoint", members<InteriorPoint>(), described<InteriorPoint>(), 1, 0, 1},
        Count{"NewtonJosephy", members<NewtonJosephy>(), described<NewtonJosephy>(), 3, armijo + lemke + 1, 0},
        Count{"NewtonRobinson", members<NewtonRobinson>(), described<NewtonRobinson>(), 2, lemke + 1, 0},
        Count{"Crash", members<Crash>(), crash, 0, 0, 0}, Count{"Nms", members<Nms>(), nms, 0, 0, 0},
        // only_newton_if_affine, proximal_to_residual and proximal_adaptive are of lists and presets
        Count{"PathSearch", members<PathSearch>(), path, 4, crash + nms + lemke, 3},
        // of basis lu; start is described apart; repair is the path search's own; the rest are data,
        // callbacks, limits, inner tolerances that no run was seen to depend on, and whether rays are certified
        Count{"LemkeOptions", members<lcp::LemkeOptions>(), lemke, 1, 1, 17},
        Count{"lcp::LemkeHowson", members<lcp::LemkeHowson>(), described<lcp::LemkeHowson>(), 1, lemke - 1, 1},
        Count{"lcp::InteriorPoint", members<lcp::InteriorPoint>(), described<lcp::InteriorPoint>(), 0, 0, 0},
        Count{"lcp::ProjectedSor", members<lcp::ProjectedSor>(), described<lcp::ProjectedSor>(), 0, 0, 0},
        Count{"lcp::BlockPivoting", members<lcp::BlockPivoting>(), described<lcp::BlockPivoting>(), 0, 0, 2},
        Count{"lcp::PrincipalPivoting", members<lcp::PrincipalPivoting>(), described<lcp::PrincipalPivoting>(), 0, 0,
              0},
        Count{"lcp::BoundQp", members<lcp::BoundQp>(), described<lcp::BoundQp>(), 0, 0, 2},
        // max_solutions bounds memory
        Count{"lcp::Enumeration", members<lcp::Enumeration>(), described<lcp::Enumeration>(), 0, 0, 1},
        Count{"Lmmcp", members<Lmmcp>(), described<Lmmcp>(), 1, 0, 0},
        Count{"Multiroot", members<Multiroot>(), described<Multiroot>(), 1, 0, 0}})
    EXPECT_EQ(c.members, c.parts + (c.described - c.of_them) + c.without)
        << c.name << ": a member has no line in describe(), and no reason here";
  EXPECT_EQ(members<lcp::BasisOptions>(), 10U) << "a new member needs a line in describe(LemkeOptions), or a reason";
}

// A key means one range, whichever method has it: the program's lists give it once.
TEST(Fields, KeysOfSeveralMethodsTakeTheSame) {
  std::vector<std::pair<std::string, std::string>> known;
  std::vector<std::pair<std::string_view, Method>> all;
  for (const auto table : {presets(), published()})
    for (const Preset& preset : table) all.emplace_back(preset.name, preset.method);
  for (const lcp::MethodEntry& entry : lcp::methods()) all.emplace_back(entry.name, Affine{.method = entry.method});
  for (auto& [name, method] : all) {
    Fields fields;
    describe(method, fields);
    for (const Field& field : fields.options()) {
      const std::string key(field.key);
      const auto found = std::ranges::find(known, key, &std::pair<std::string, std::string>::first);
      if (found == known.end())
        known.emplace_back(key, takes(field));
      else
        EXPECT_EQ(takes(field), found->second) << name << ": " << key;
      EXPECT_EQ(std::ranges::count(fields.options(), field.key, &Field::key), 1) << name << ": " << key;
    }
  }
}

}  // namespace
}  // namespace perp::ncp
