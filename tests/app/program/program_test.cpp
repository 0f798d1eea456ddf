// SPDX-License-Identifier: Apache-2.0
/// Suggestions, versions, and the agreement of help, man page and completion with the tables.
#include "app/program/program.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <regex>

#include "app/commands/commands.hpp"
#include "app/commands/solve.hpp"
#include "app/options/methods.hpp"
#include "app/options/options.hpp"
#include "app/support.hpp"
#include "collection/collection.hpp"
#include "lcp/gpl.hpp"
#include "ncp/reformulation/cfunction.hpp"
#include "ncp/reformulation/smoothing_function.hpp"

namespace perp::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(DidYouMean, NearNamesOnly) {
  constexpr std::array<std::string_view, 3> names{"josephy", "semismooth", "semismooth-min"};
  EXPECT_THAT(did_you_mean("josefy", names), HasSubstr("'josephy'"));
  EXPECT_THAT(did_you_mean("SEMISMOTH", names), testing::StartsWith(" Did you mean 'semismooth'"));
  EXPECT_EQ(did_you_mean("xyz", names), "");
  EXPECT_EQ(did_you_mean("", names), "");
  constexpr std::array<std::string_view, 2> commands{"solve", "list"};
  EXPECT_EQ(did_you_mean("slove", commands), " Did you mean 'solve'?") << "neighbours exchanged, in a short word";
  EXPECT_EQ(did_you_mean("volse", commands), "");
}

// A file of options may have a line of any length. Would catch one that is compared with every key letter by letter,
// half a minute long and deaf to limits.
TEST(DidYouMean, LongWordsAreNotComparedLetterByLetter) {
  const std::vector<std::string_view> names(100, "convergence_tolerance");
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_EQ(did_you_mean(std::string(10'000'000, 'e'), names), "");
  EXPECT_TRUE(ncp::collection::similar(std::string(10'000'000, 'e')).empty());
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
}

// Pyomo takes the first number of the form x.y[.z] in the output of -v for the version (its _extract_version).
TEST(Version, FirstNumberIsOurs) {
  std::smatch match;
  const std::string line = version_line();
  ASSERT_TRUE(std::regex_search(line, match, std::regex(R"([0-9]+(\.[0-9]+){1,3})")));
  EXPECT_EQ(match[0], std::string(version_number()));
  EXPECT_EQ(line.find('\n'), std::string::npos);
  for (const char* part : {"Eigen 3.", "KLU of SuiteSparse 5.", "AMPL solver library of 20"})
    EXPECT_THAT(version_text(), HasSubstr(part));
}

// Who hands the program on must know under which licence. Catches a build that names the other's.
TEST(Version, SaysTheLicenceOfThisBuild) {
  EXPECT_THAT(version_text(), HasSubstr(licence_line()));
  EXPECT_THAT(licence_line(), HasSubstr("Apache License 2.0"));
  if (lcp::gpl_linked()) {
    EXPECT_THAT(licence_line(), HasSubstr("GNU GPL, version 3"));
    EXPECT_THAT(version_text(), HasSubstr("UMFPACK and KLU of"));
  } else {
    EXPECT_THAT(licence_line(),
                AllOf(HasSubstr("LGPL"), HasSubstr("MPFI"), HasSubstr("BSD"), Not(HasSubstr("UMFPACK"))));
    EXPECT_THAT(version_text(), Not(HasSubstr("UMFPACK")));
  }
}

// Would catch a method or an option that was added without a word to the user.
TEST(Help, MethodsCommandNamesEverything) {
  test::Captured captured;
  EXPECT_EQ(print_methods(captured.streams), exit_solved);
  const std::string text = std::regex_replace(captured.out.str(), std::regex("\n      (?! )"), " ");  // unwrapped
  for (const MethodEntry& entry : methods()) {
    EXPECT_THAT(text, HasSubstr(std::string(entry.name)));
    EXPECT_THAT(text, HasSubstr(std::string(entry.reference)));
  }
  for (const Option& option : options()) {
    EXPECT_THAT(text, HasSubstr("\n  " + std::string(option.key)));
    EXPECT_THAT(text, HasSubstr(std::string(option.help)));
  }
  EXPECT_THAT(text, HasSubstr("crash_method"));
  // Neither a sentence that breaks off nor a word said twice, where a part of it is empty or repeats what is before.
  EXPECT_FALSE(std::regex_search(text, std::regex("; *\n\n|(\\b[a-z]+: )\\1"))) << text;
}

// Would catch a C-function or a smoothing without its line, and a range that is not printed.
TEST(Help, CFunctionsCommandNamesEverything) {
  test::Captured captured;
  EXPECT_EQ(print_cfunctions(captured.streams), exit_solved);
  const std::string text = captured.out.str();
  for (const ncp::CFunction& c : ncp::cfunctions())
    for (const std::string& part : {c.name, c.formula, c.reference, c.properties.level_sets,
                                    c.properties.stationary_points, c.parameter ? c.parameter->name : c.name})
      EXPECT_THAT(text, HasSubstr(part));
  for (const ncp::SmoothingFunction& s : ncp::smoothing_functions())
    for (const std::string& part : {s.name, s.formula, s.reference}) EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(text, HasSubstr("lambda in (0, 4), default 2"));
  EXPECT_THAT(text, HasSubstr("rho > 0, default 1"));
}

// Would catch a list that the build does not fill in.
TEST(Help, ManPageNamesEveryOptionMethodAndLevel) {
  const std::string page = test::read(PERP_MAN_PAGE);
  ASSERT_FALSE(page.empty());
  for (const Option& option : options()) {
    EXPECT_THAT(page, HasSubstr(std::string(option.key)));
    EXPECT_THAT(page, HasSubstr(std::string(option.alias)));
  }
  for (const MethodEntry& entry : methods()) EXPECT_THAT(page, HasSubstr(std::string(entry.name)));
  EXPECT_THAT(page, Not(HasSubstr("@")));
  for (const std::string_view level : log_level_names()) EXPECT_THAT(page, HasSubstr(std::string(level)));
}

TEST(Help, CompletionKnowsMethodsOptionsAndLevels) {
  for (const char* words : {"solve --method ''", "methods --show ''"}) {
    const std::string names = test::offered(words);
    for (const MethodEntry& entry : methods()) EXPECT_THAT(names, HasSubstr(fmt::format(" {} ", entry.name)));
    EXPECT_EQ(std::ranges::count(names, ' '), std::ssize(methods()) + 1) << "and no other word: " << names;
  }
  const std::string keys = test::offered("solve --option ''");
  for (const Option& option : options()) EXPECT_THAT(keys, HasSubstr(fmt::format(" {}= ", option.key)));
  const std::string levels = test::offered("solve --log-level ''");
  for (const std::string_view level : log_level_names()) EXPECT_THAT(levels, HasSubstr(fmt::format(" {} ", level)));
}

// Would catch an option of another method, or the default of one that has no effect.
TEST(Help, OneMethodWithItsOptions) {
  test::Captured captured;
  EXPECT_EQ(show_method("semismooth", captured.streams), exit_solved);
  EXPECT_THAT(captured.out.str(), AllOf(HasSubstr("sigma\n"), HasSubstr("a number in (0, 1); default 0.0001"),
                                        Not(HasSubstr("escape_rounds")), Not(HasSubstr("crash_method"))));
}

}  // namespace
}  // namespace perp::app
