// SPDX-License-Identifier: Apache-2.0
/// What has no effect is neither shown nor silently taken.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "app/options/options.hpp"
#include "app/report/report.hpp"
#include "options_support.hpp"

namespace perp::app {
namespace {

using test::applied;
using testing::HasSubstr;
using testing::IsEmpty;

// Options that another one makes inert are neither listed nor silently taken, and the order of the two does not matter.
// Would catch an escape's options among those of a method without escapes.
TEST(Options, InertOnesAreNotShown) {
  const auto effect = [](std::vector<Assignment> given, const char* key) {
    Settings settings = applied(std::move(given)).settings;
    const ncp::Fields fields = fields_of(settings);
    const ncp::Field* field = fields.find(key);
    return field == nullptr ? "-" : value_text(*field);
  };
  struct Case {
    const char* method;
    const char* key;
    const char* value;
    const char* by;
    const char* off;
    const char* on;
  };
  for (const Case& c : {Case{"semicomp", "escape_lambda", "3", "escape_rounds", "0", "9"},
                        Case{"semismooth", "chord_steps", "5", "linear_solver", "direct", "krylov"},
                        Case{"path", "crash_iteration_limit", "7", "crash_method", "none", "pnewton"},
                        Case{"auto", "nms_maximum_watchdogs", "1", "nms", "no", "yes"}}) {
    const Assignment method{"method", c.method, ""}, on{c.by, c.on, ""}, off{c.by, c.off, ""}, set{c.key, c.value, ""};
    EXPECT_EQ(effect({method, off}, c.key), "-") << c.key;
    for (const auto& given : {std::vector{method, off, set}, std::vector{method, set, off}})
      EXPECT_THAT(applied(given).notes,
                  testing::ElementsAre(HasSubstr(std::string(c.key) + " has no effect on method " + c.method +
                                                 " with " + c.by + " = " + c.off)));
    for (const auto& given : {std::vector{method, on, set}, std::vector{method, set, on}}) {
      EXPECT_EQ(effect(given, c.key), c.value);
      EXPECT_THAT(applied(given).notes, IsEmpty());
    }
  }
  EXPECT_EQ(effect({{"method", "semismooth", ""}}, "escape_lambda"), "-");
  EXPECT_EQ(effect({{"method", "semicomp", ""}}, "escape_lambda"), "2");
}

// The Fischer-Burmeister function has no parameter: "-" is no value of an option.
TEST(Options, AreListedWithValuesOnly) {
  const auto listed = [](const char* method) {
    std::ostringstream out;
    print_options(out, applied({{"method", method, ""}}).settings);
    return out.str();
  };
  EXPECT_THAT(listed("semismooth"), testing::Not(testing::AnyOf(HasSubstr("cfunction_parameter"), HasSubstr("=-"))));
  EXPECT_THAT(listed("semismooth"), testing::Not(HasSubstr("escape_")));
  EXPECT_THAT(listed("semismooth-penalised"), HasSubstr("cfunction_parameter="));
}

// The size of the problem takes from a limit of pivots; that is said, and only where somebody asked for more.
TEST(Options, PivotLimitAboveWhatTheSizeTakesIsNoted) {
  const auto notes = [](const char* method, std::vector<Assignment> given) {
    given.insert(given.begin(), {"method", method, ""});
    Applied options = applied(given);
    note_limits_of_size(4, options);
    return options.notes;
  };
  for (const char* method : {"path", "auto", "josephy", "robinson"}) {
    EXPECT_THAT(notes(method, {{"minor_iteration_limit", "5000", ""}}),
                testing::ElementsAre(HasSubstr("minor_iteration_limit = 5000 is taken as 1080")))
        << method;
    EXPECT_THAT(notes(method, {{"minor_iteration_limit", "1080", ""}}), IsEmpty()) << method;
    EXPECT_THAT(notes(method, {}), IsEmpty()) << method;
  }
  EXPECT_THAT(notes("lemke", {{"minor_iteration_limit", "5000", ""}}), IsEmpty()) << "takes it as it is";
}

}  // namespace
}  // namespace perp::app
