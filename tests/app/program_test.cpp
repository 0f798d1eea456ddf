/// Suggestions, versions, and the agreement of help, man page and completion with the tables.
#include "app/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <regex>

#include "app/options.hpp"
#include "app/solve.hpp"
#include "support.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;

TEST(DidYouMean, NearNamesOnly) {
  constexpr std::array<std::string_view, 3> names{"josephy", "semismooth", "semismooth-min"};
  EXPECT_THAT(did_you_mean("josefy", names), HasSubstr("'josephy'"));
  EXPECT_THAT(did_you_mean("SEMISMOTH", names), testing::StartsWith(" Did you mean 'semismooth'"));
  EXPECT_EQ(did_you_mean("xyz", names), "");
  EXPECT_EQ(did_you_mean("", names), "");
}

// Pyomo takes the first number of the form x.y[.z] in the output of -v for the version (its _extract_version).
TEST(Version, FirstNumberIsOurs) {
  std::smatch match;
  const std::string line = version_line();
  ASSERT_TRUE(std::regex_search(line, match, std::regex(R"([0-9]+(\.[0-9]+){1,3})")));
  EXPECT_EQ(match[0], std::string(version_number()));
  EXPECT_EQ(line.find('\n'), std::string::npos);
  for (const char* part : {"GPL-3.0-or-later", "Eigen 3.", "SuiteSparse 5.", "AMPL solver library of 20"})
    EXPECT_THAT(version_text(), HasSubstr(part));
}

// Would catch a method or an option that was added without a word to the user.
TEST(Help, MethodsCommandNamesEverything) {
  test::Captured captured;
  EXPECT_EQ(print_methods(captured.streams), exit_solved);
  const std::string text = captured.out.str();
  for (const MethodEntry& entry : methods()) {
    EXPECT_THAT(text, HasSubstr(std::string(entry.name)));
    EXPECT_THAT(text, HasSubstr(std::string(entry.reference)));
  }
  for (const Option& option : options()) {
    EXPECT_THAT(text, HasSubstr("\n  " + std::string(option.key)));
    EXPECT_THAT(text, HasSubstr(std::string(option.help)));
  }
  EXPECT_THAT(text, HasSubstr("crash_method"));
}

TEST(Help, ManPageNamesEveryOptionMethodAndLevel) {
  const std::string page = test::read(PERP_SOURCE_DIR "/app/perp.1");
  ASSERT_FALSE(page.empty());
  for (const Option& option : options()) {
    EXPECT_THAT(page, HasSubstr(std::string(option.key)));
    for (const std::string_view alias : option.aliases) EXPECT_THAT(page, HasSubstr(std::string(alias)));
  }
  for (const MethodEntry& entry : methods()) EXPECT_THAT(page, HasSubstr(std::string(entry.name)));
  for (const std::string_view level : log_level_names()) EXPECT_THAT(page, HasSubstr(std::string(level)));
}

TEST(Help, CompletionKnowsMethodsAndLevels) {
  const std::string completion = test::read(PERP_SOURCE_DIR "/app/perp.bash");
  for (const MethodEntry& entry : methods()) EXPECT_THAT(completion, HasSubstr(std::string(entry.name)));
  for (const std::string_view level : log_level_names()) EXPECT_THAT(completion, HasSubstr(std::string(level)));
}

}  // namespace
}  // namespace perp::app
