/// The options table and the ways to write options. Expectations come from the contract in app/options.hpp and, for
/// PATH's names, from AMPL's list "PATH Directives for AMPL".
#include "app/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "support.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

Applied applied(std::vector<Assignment> assignments, Unknown unknown = Unknown::Refuse) {
  for (Assignment& given : assignments)
    if (given.source.empty()) given.source = "test";
  return apply_options(assignments, unknown);
}

std::string refusal(const std::vector<Assignment>& assignments) {
  try {
    applied(assignments);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const Option& option(std::string_view key) {
  for (const Option& entry : options())
    if (entry.key == key) return entry;
  throw std::out_of_range(std::string(key));
}

// Would catch a key that sets nothing, or the field of another key: each value differs from the default, arrives in its
// field, and leaves every other option alone.
TEST(Options, EachKeySetsItsFieldAndNoOther) {
  const std::vector<std::array<const char*, 3>> values{{"convergence_tolerance", "1e-05", "semismooth"},
                                                       {"major_iteration_limit", "17", "semismooth"},
                                                       {"time_limit", "2.5", "semismooth"},
                                                       {"check_derivatives", "yes", "semismooth"},
                                                       {"output", "no", "semismooth"},
                                                       {"nms_memory_size", "9", "semismooth"},
                                                       {"sigma", "0.25", "semismooth"},
                                                       {"beta", "0.75", "semismooth"},
                                                       {"max_backtracks", "7", "semismooth"},
                                                       {"descent_rho", "0.001", "semismooth"},
                                                       {"descent_p", "3", "semismooth"},
                                                       {"escape_rounds", "3", "semismooth"},
                                                       {"escape_lambda", "5", "semismooth"},
                                                       {"lu", "klu", "semismooth"},
                                                       {"lu", "eigen", "josephy"},
                                                       {"minor_iteration_limit", "55", "josephy"},
                                                       {"lemke_start", "always", "josephy"},
                                                       {"pivot_tolerance", "1e-06", "josephy"},
                                                       {"lemke_perturbation", "0.5", "josephy"},
                                                       {"lemke_cover", "spread", "josephy"},
                                                       {"lemke_seed", "42", "josephy"},
                                                       {"refactor_every", "5", "josephy"},
                                                       {"sideineq", "2", "semismooth"},
                                                       {"wantsol", "8", "semismooth"}};
  std::vector<std::string> covered{"method"};
  for (const auto& [key, value, method] : values) {
    covered.emplace_back(key);
    Settings defaults = applied({{"method", method, ""}}).settings;
    Settings settings = applied({{"method", method, ""}, {key, value, ""}}).settings;
    for (const Option& other : options()) {
      const std::string before = value_text(other.field(defaults));
      const std::string after = value_text(other.field(settings));
      if (other.key == key) {
        EXPECT_EQ(after, value) << key;
        EXPECT_NE(before, after) << key << ": the test must not set the default";
      } else {
        EXPECT_EQ(before, after) << key << " changed " << other.key;
      }
    }
  }
  for (const Option& entry : options())
    EXPECT_THAT(covered, testing::Contains(std::string(entry.key))) << "a new option needs a line in this test";
}

// Would catch a table entry wired to a field that the solver does not read by that name.
TEST(Options, ReachTheMethodsStructs) {
  const Settings settings =
      applied({{"tol", "1e-3", ""}, {"max_iterations", "4", ""}, {"memory", "2", ""}, {"lu", "KLU", ""}}).settings;
  const auto& method = std::get<ncp::SemismoothNewton>(settings.method);
  EXPECT_EQ(method.stop.tol, 1e-3);
  EXPECT_EQ(method.stop.max_iterations, 4);
  EXPECT_EQ(method.search.memory, 2);
  EXPECT_EQ(method.lu, lcp::LuBackend::Klu);

  const Settings pivoting =
      applied({{"lemke_start", "always", ""}, {"time_limit", "9", ""}, {"method", "josephy", ""}}).settings;
  const auto& josephy = std::get<ncp::NewtonJosephy>(pivoting.method);
  EXPECT_EQ(josephy.lemke.start, lcp::LemkeStart::Ray);
  EXPECT_EQ(josephy.stop.max_time.count(), 9);
  EXPECT_EQ(std::get<ncp::SemismoothNewton>(applied({{"method", "semismooth-min", ""}}).settings.method).cfunction.name,
            ncp::natural_min().name);
}

TEST(Options, LastValueWins) {
  Settings settings =
      applied({{"tol", "1e-3", ""}, {"convergence_tolerance", "1e-4", ""}, {"conv", "1e-5", ""}}).settings;
  EXPECT_EQ(ncp::stop(settings.method).tol, 1e-5);
}

// Would catch prefixes that resolve to the first match, or exact keys refused because a longer key shares them.
TEST(Options, UniquePrefixesAndExactKeys) {
  EXPECT_EQ(ncp::stop(applied({{"major", "3", ""}}).settings.method).max_iterations, 3);
  EXPECT_EQ(ncp::stop(applied({{"TIME", "3", ""}}).settings.method).max_time.count(), 3);
  EXPECT_FALSE(applied({{"output", "no", ""}}).settings.output);  // though output_errors and others begin with it
  EXPECT_THAT(refusal({{"ma", "3", ""}}),
              testing::AllOf(HasSubstr("ambiguous"), HasSubstr("major_iteration_limit"), HasSubstr("max_backtracks")));
  EXPECT_THAT(applied({{"crash_met", "none", ""}}, Unknown::Refuse).notes, testing::SizeIs(1));
}

// Would catch values that are clamped or half read ("1e-3x") in place of a refusal with key, value, range and source.
TEST(Options, BadValuesAreRefusedByName) {
  const std::vector<std::array<std::string, 3>> bad{
      {"tol", "0", "a number > 0"},
      {"tol", "-1", "> 0"},
      {"tol", "1e-3x", "> 0"},
      {"tol", "nan", "> 0"},
      {"tol", "", "(nothing)"},
      {"sigma", "1", "in (0, 1)"},
      {"sigma", "0", "in (0, 1)"},
      {"beta", "2", "in (0, 1)"},
      {"major", "2.5", "an integer"},
      {"major", "-1", ">= 0"},
      {"time_limit", "inf", "1e+09"},
      {"lemke_seed", "-3", ">= 0"},
      {"output", "maybe", "yes or no"},
      {"lu", "lapack", "umfpack, klu or eigen"},
      {"method", "newton", "semismooth, semismooth-min, josephy, auto, lemke"},
      {"lemke_start", "never", "automatic, always or first"},
      {"sideineq", "3", "in [1, 2]"},
      {"major", "99999999999", ">= 0"},
      {"descent_p", "2", "> 2"}};
  for (const auto& [key, value, range] : bad)
    EXPECT_THAT(refusal({{key, value, "here:7"}}),
                testing::AllOf(HasSubstr("here:7"), HasSubstr(key), HasSubstr(value), HasSubstr(range)))
        << key << '=' << value;
}

// A bad value must not pass because the chosen method has no such field.
TEST(Options, WithoutEffectOnTheMethodIsSaidAndStillChecked) {
  EXPECT_THAT(applied({{"lemke_start", "always", ""}}).notes,
              testing::ElementsAre(HasSubstr("lemke_start has no effect on method semismooth")));
  EXPECT_THAT(refusal({{"lemke_start", "never", ""}}), HasSubstr("lemke_start"));
}

TEST(Options, PathOptionsWithoutCounterpartAreAcceptedAndNamed) {
  const Applied result = applied({{"crash_method", "none", ""}, {"restart_limit", "3", ""}});
  EXPECT_THAT(result.notes, testing::ElementsAre(testing::AllOf(HasSubstr("without effect"), HasSubstr("crash_method"),
                                                                HasSubstr("restart_limit"))));
  EXPECT_THAT(applied({{"lemke_start", "first", ""}, {"method", "josephy", ""}}).notes,
              testing::ElementsAre(HasSubstr("automatic")));
}

TEST(Options, UnknownKeysAreRefusedOrReported) {
  EXPECT_THAT(refusal({{"tolerance_of_convergence", "1", ""}}), HasSubstr("tolerance_of_convergence"));
  EXPECT_THAT(refusal({{"sigmb", "0.1", "--option"}}), testing::AllOf(HasSubstr("--option"), HasSubstr("'sigma'")));
  const Applied reported = applied({{"sigmb", "0.1", ""}, {"tol", "1e-2", ""}}, Unknown::Report);
  EXPECT_THAT(reported.unknown, testing::ElementsAre(HasSubstr("sigmb")));
  EXPECT_EQ(ncp::stop(reported.settings.method).tol, 1e-2);
}

TEST(OptionsText, AssignmentSplitsAtTheFirstEqualsSign) {
  const Assignment given = parse_assignment(" tol = a=b ", "x");
  EXPECT_EQ(given.key, "tol");
  EXPECT_EQ(given.value, "a=b");
  EXPECT_THROW(parse_assignment("tol", "x"), InputError);
  EXPECT_THROW(parse_assignment("=1", "x"), InputError);
}

std::string pairs(const std::vector<Assignment>& all) {
  std::string text;
  for (const Assignment& given : all) text += given.key + ":" + given.value + ";";
  return text;
}

// AMPL's drivers accept all four forms (ASL's getstub); Pyomo quotes values.
TEST(OptionsText, AmplsForms) {
  EXPECT_EQ(pairs(parse_words("a=1 b 2 c = 3 d= 4 e =5", "env")), "a:1;b:2;c:3;d:4;e:5;");
  EXPECT_EQ(pairs(parse_words("f=\"x y\" 'g'='z w'  h", "env")), "f:x y;g:z w;h:;");
  EXPECT_EQ(pairs(parse_words("a b=1", "env")), "a:;b:1;") << "an assignment is not the value of the word before it";
  EXPECT_THAT(parse_words("  ", "env"), IsEmpty());
}

TEST(OptionsText, FileWithCommentsAndLineNumbers) {
  std::istringstream in("# comment\n\n* another\ntol 1e-4\nmethod = josephy  # and why\nlu=klu;\r\n");
  const std::vector<Assignment> all = parse_options_file(in, "path.opt");
  EXPECT_EQ(pairs(all), "tol:1e-4;method:josephy;lu:klu;");
  EXPECT_EQ(all[0].source, "path.opt:4");
  EXPECT_EQ(all[2].source, "path.opt:6");
}

TEST(OptionsText, FileErrorsNameTheLine) {
  for (const char* content : {"tol 1e-4\ntol\n", "tol 1e-4\ntol 1 2 3\n", "tol 1e-4\ntol=\n"}) {
    std::istringstream in(content);
    try {
      parse_options_file(in, "path.opt");
      ADD_FAILURE() << content;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("path.opt:2")) << content;
    }
  }
  std::istringstream in("\nsigma 7\n");
  EXPECT_THAT(refusal(parse_options_file(in, "path.opt")),
              testing::AllOf(HasSubstr("path.opt:2"), HasSubstr("sigma = 7")));
  EXPECT_THROW(read_options_file("no/such/file"), InputError);
  EXPECT_THROW(read_options_file("/"), InputError);
}

TEST(Options, EveryMethodStandsInTheTableOnce) {
  for (const MethodEntry& entry : methods()) {
    EXPECT_EQ(find_method(entry.name), &entry);
    EXPECT_FALSE(ncp::invalid(entry.method)) << entry.name;
    EXPECT_FALSE(entry.reference.empty());
  }
  EXPECT_NE(find_method(default_method), nullptr);
  EXPECT_EQ(find_method("none"), nullptr);
  EXPECT_EQ(Settings{}.method_name, default_method);
  EXPECT_EQ(option("convergence_tolerance").aliases.front(), "tol");
}

}  // namespace
}  // namespace perp::app
