// SPDX-License-Identifier: Apache-2.0
/// The options table and the ways to write options. Expectations come from the contract in ncp/settings/settings.hpp
/// and, for PATH's names, from AMPL's list "PATH Directives for AMPL".
#include "app/options/options.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "app/support.hpp"
#include "options_support.hpp"

namespace perp::app {
namespace {

using test::applied;
using testing::HasSubstr;
using testing::IsEmpty;

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

/// Another value that the field takes.
std::string another_value(const ncp::Field& field) {
  return std::visit(
      [&](const auto& target) -> std::string {
        using T = std::remove_cvref_t<decltype(target)>;
        if constexpr (std::is_same_v<T, bool*> || std::is_same_v<T, ncp::Flag>) {
          return value_text(field) == "yes" ? "no" : "yes";
        } else if constexpr (std::is_same_v<T, ncp::Words>) {
          return std::string(
              std::ranges::find_if(target.words, [&](const auto& word) { return word.second != target.get(); })->first);
        } else if constexpr (std::is_same_v<T, ncp::Parameter>) {
          return fmt::format("{}", *target.get() / 2);
        } else if constexpr (std::is_same_v<T, std::string*>) {
          return "semismooth";
        } else if constexpr (std::is_same_v<T, double*> || std::is_same_v<T, ncp::Seconds*>) {
          double value = 0;
          if constexpr (std::is_same_v<T, double*>)
            value = *target;
          else
            value = target->count();
          for (const double other : {value / 2, 2 * value, 0.25, (field.range.low + field.range.high) / 2})
            if (other != value && std::isfinite(other) && field.range.has(other)) return fmt::format("{}", other);
          return "";
        } else {
          return fmt::format("{}", field.range.has(static_cast<double>(*target) - 1) ? *target - 1 : *target + 1);
        }
      },
      field.target);
}

std::map<std::string, std::pair<std::string, std::string>> values_and_inert(Settings settings) {
  std::map<std::string, std::pair<std::string, std::string>> values;
  for (const ncp::Field& field : fields_of(settings).options())
    values[std::string(field.key)] = {value_text(field), std::string(field.inert)};
  return values;
}

// Would catch a key that sets nothing, or the field of another key: with every method each value differs from the
// default, arrives in its field, and leaves every other option alone.
TEST(Options, EachKeySetsItsFieldAndNoOther) {
  std::vector<std::string> covered{"method", "output"};  // they change others
  std::vector<std::vector<Assignment>> bases{
      {{"method", "smooth", ""}, {"smoothing_schedule", "predictor-corrector", ""}}};
  for (const MethodEntry& entry : methods()) bases.push_back({{"method", std::string(entry.name), ""}});
  for (const std::vector<Assignment>& base : bases) {
    Settings settings = applied(base).settings;
    const auto before = values_and_inert(settings);
    for (const ncp::Field& field : fields_of(settings).options()) {
      const std::string key(field.key);
      if (key == "method" || key == "output" || value_text(field) == "-") continue;
      SCOPED_TRACE(base[0].value + ": " + key);
      const std::string value = another_value(field);
      EXPECT_NE(value, before.at(key).first) << "the test must not set the default";
      std::vector<Assignment> given = base;
      given.push_back({key, value, ""});
      for (const auto& [other, after] : values_and_inert(applied(given).settings)) {
        const auto& [first, inert] = before.at(other);
        if (after.second.starts_with(key) || inert.starts_with(key)) continue;  // takes the other's effect away
        if (key == "cfunction" && other == "cfunction_parameter") continue;     // the function's own
        EXPECT_EQ(after.first, other == key ? value : first) << other;
      }
      covered.push_back(key);
    }
  }
  for (const Option& entry : options()) EXPECT_THAT(covered, testing::Contains(std::string(entry.key)));
}

// The parameter belongs to the function, whatever the order in which the two are given. Would catch a number that is
// shown but not used by phi, one of another function, and a refusal without the range.
TEST(Options, CFunctionsTakeTheirParameter) {
  const std::vector<Assignment> given{{"cfunction_parameter", "0.5", ""},
                                      {"method", "semismooth", ""},
                                      {"cfunction", "penalised-fischer-burmeister", ""}};
  const auto method = std::get<ncp::SemismoothNewton>(applied(given).settings.method);
  EXPECT_EQ(method.cfunction.parameter->value, 0.5);
  EXPECT_EQ(method.cfunction.at(3, 4, 1, 1).phi, 7);  // (2 + 12) / 2
  const std::vector<Assignment> too_large{
      {"method", "semismooth", ""}, {"cfunction", "kanzow-kleinmichel", ""}, {"cfunction_parameter", "4", ""}};
  EXPECT_THAT(refusal(too_large), HasSubstr("lambda is 4; it must be in (0, 4)"));
  EXPECT_THAT(refusal({{"method", "semismooth", ""}, {"cfunction_parameter", "1", ""}}),
              HasSubstr("fischer-burmeister has no parameter"));
  EXPECT_THAT(refusal({{"cfunction", "fisher", ""}}), HasSubstr("fischer-burmeister"));
  EXPECT_THAT(applied({{"method", "josephy", ""}, {"cfunction", "min", ""}, {"cfunction_parameter", "1", ""}}).notes,
              testing::SizeIs(2));
}

// Would catch a table entry wired to a field that the solver does not read by that name.
TEST(Options, ReachTheMethodsStructs) {
  const Settings settings = applied({{"method", "semismooth", ""},
                                     {"tol", "1e-3", ""},
                                     {"max_iterations", "4", ""},
                                     {"memory", "2", ""},
                                     {"lu", "KLU", ""}})
                                .settings;
  const auto& method = std::get<ncp::SemismoothNewton>(settings.method);
  EXPECT_EQ(method.stop.tol, 1e-3);
  EXPECT_EQ(method.stop.max_iterations, 4);
  EXPECT_EQ(method.search.memory, 2);
  EXPECT_EQ(method.lu, lcp::LuBackend::Klu);

  const Settings pivoting =
      applied({{"lemke_start", "always", ""}, {"time_limit", "9", ""}, {"method", "josephy", ""}}).settings;
  const auto& josephy = std::get<ncp::NewtonJosephy>(*std::get<ncp::First>(pivoting.method).entries.front().method);
  EXPECT_EQ(josephy.lemke.start, lcp::LemkeStart::Ray);
  EXPECT_EQ(ncp::stop(pivoting.method).max_time.count(), 9);
  EXPECT_EQ(std::get<ncp::SemismoothNewton>(applied({{"method", "semismooth-min", ""}}).settings.method).cfunction.name,
            ncp::natural_min().name);
}

// PATH's names and the fields of PathSearch, by its manual. Would catch two of them exchanged.
TEST(Options, PathsNamesReachPathSearch) {
  EXPECT_FALSE(ncp::path_of(applied({{"crash_method", "none", ""}}).settings.method)->crash.on);
  const Settings settings = applied({{"crash_nbchange_limit", "4", ""},
                                     {"nms_searchtype", "Line", ""},
                                     {"nms_initial_reference_factor", "3", ""},
                                     {"nms_memory_size", "6", ""},
                                     {"merit_function", "NORMAL", ""},
                                     {"lemke_start", "first", ""},
                                     {"proximal_perturbation", "0.5", ""},
                                     {"restart_limit", "0", ""},
                                     {"minor_iteration_limit", "7", ""},
                                     {"cumulative_iteration_limit", "70", ""}})
                                .settings;
  const ncp::PathSearch& path = *ncp::path_of(settings.method);
  EXPECT_EQ(path.crash.nbchange_limit, 4);
  EXPECT_EQ(path.search, ncp::Searchtype::Line);
  EXPECT_EQ(path.nms.initial_reference_factor, 3);
  EXPECT_EQ(path.nms.memory, 6);
  EXPECT_EQ(path.merit, ncp::PathMerit::NormalMap);
  EXPECT_EQ(path.start, ncp::PathStart::First);
  EXPECT_EQ(path.lemke.start, lcp::LemkeStart::Regular) << "that would start every iteration from a ray";
  EXPECT_EQ(path.proximal_perturbation, 0.5);
  EXPECT_EQ(path.lemke.max_pivots, 7);
  EXPECT_EQ(ncp::stop(settings.method).max_pivots, 70);
  Settings copy = settings;
  EXPECT_EQ(value_text(*fields_of(copy).find("restart_limit")), "0");
}

// "PART.key" reaches the parts of that name alone, "key" every method in a composition. Would catch options that a
// composition swallows.
TEST(Options, ReachThePartsOfACompositionByName) {
  const Assignment method{"method", "first(path, on(scaled, smooth), escape(semismooth))", ""};
  const auto beta = [](const Settings& settings, std::string_view name) {
    ncp::Method all = settings.method;
    ncp::Fields fields;
    ncp::describe(*ncp::parts_named(all, name).front(), fields);
    return value_text(*fields.find("beta"));
  };
  const Settings every = applied({method, {"beta", "0.25", ""}}).settings;
  EXPECT_EQ(beta(every, "path"), "0.25");
  EXPECT_EQ(beta(every, "semismooth"), "0.25");
  const Settings one = applied({method, {"path.beta", "0.125", ""}, {"beta", "0.25", ""}}).settings;
  EXPECT_EQ(beta(one, "path"), "0.125");
  EXPECT_FALSE(ncp::path_of(applied({method, {"path.crash_method", "none", ""}}).settings.method)->crash.on);
  EXPECT_THROW(applied({method, {"josie.beta", "0.25", ""}}), InputError);
}

// PATH's manual: output turns everything off, and parts can be turned on again, in any order.
TEST(Options, OutputSwitches) {
  const auto output = [](const std::vector<Assignment>& given) { return applied(given).settings.output; };
  const Output usual = output({});
  EXPECT_TRUE(usual.shows(usual.major_iterations) && usual.shows(usual.crash_iterations) && usual.table());
  EXPECT_FALSE(usual.shows(usual.options));
  const Output none = output({{"output", "no", ""}});
  EXPECT_FALSE(none.table() || none.shows(none.final_statistics) || none.shows(none.final_summary));
  for (const auto& order : {std::array{0, 1}, std::array{1, 0}}) {
    const std::array given{Assignment{"output", "no", ""}, Assignment{"output_major_iterations", "on", ""}};
    const Output some =
        output({given.at(static_cast<std::size_t>(order[0])), given.at(static_cast<std::size_t>(order[1]))});
    EXPECT_TRUE(some.shows(some.major_iterations) && some.table());
    EXPECT_FALSE(some.shows(some.crash_iterations));
  }
  const Output without = output({{"output_crash_iterations", "no", ""}});
  EXPECT_TRUE(without.shows(without.major_iterations));
  EXPECT_FALSE(without.shows(without.crash_iterations));
}

TEST(Options, LastValueWins) {
  Settings settings =
      applied({{"tol", "1e-3", ""}, {"convergence_tolerance", "1e-4", ""}, {"conv", "1e-5", ""}}).settings;
  EXPECT_EQ(ncp::stop(settings.method).tol, 1e-5);
}

// Would catch abbreviations that resolve to the first match, or exact keys refused because a longer key shares them.
TEST(Options, AbbreviationsAndExactKeys) {
  EXPECT_EQ(ncp::stop(applied({{"major", "3", ""}}).settings.method).max_iterations, 3);
  EXPECT_EQ(ncp::stop(applied({{"TIME", "3", ""}}).settings.method).max_time.count(), 3);
  EXPECT_FALSE(applied({{"output", "no", ""}}).settings.output.all);  // though output_errors and others begin with it
  Settings monotone = applied({{"nms", "no", ""}}).settings;
  EXPECT_FALSE(ncp::path_of(monotone.method)->nms.on);
  EXPECT_THAT(refusal({{"nms_m", "3", ""}}),
              testing::AllOf(HasSubstr("ambiguous"), HasSubstr("nms_memory_size"), HasSubstr("nms_maximum_watchdogs")));
  EXPECT_THAT(refusal({{"max", "3", ""}}), testing::AllOf(HasSubstr("max_backtracks"), HasSubstr("max_iterations")));
  EXPECT_THAT(refusal({{"_limit", "3", ""}}), HasSubstr("no option"));
}

// Word by word, as PATH's users write them; each means the option of PATH, whatever names of ours it fits as well.
TEST(Options, WordsAreAbbreviatedAsPathsUsersDo) {
  for (const auto& [key, full, value] :
       std::vector<std::array<const char*, 3>>{{"conv_tol", "convergence_tolerance", "0.001"},
                                               {"maj_iter", "major_iteration_limit", "5"},
                                               {"MAJ_ITER_LIM", "major_iteration_limit", "5"},
                                               {"minor", "minor_iteration_limit", "5"},
                                               {"cum_iter", "cumulative_iteration_limit", "5"},
                                               {"cra_meth", "crash_method", "none"},
                                               {"crash_iter", "crash_iteration_limit", "5"},
                                               {"prox_pert", "proximal_perturbation", "0.1"},
                                               {"prox", "proximal_perturbation", "0.1"},
                                               {"nms_mem", "nms_memory_size", "5"},
                                               {"nms_init_ref", "nms_initial_reference_factor", "5"},
                                               {"nms_ms_freq", "nms_mstep_frequency", "5"},
                                               {"nms_s", "nms_searchtype", "line"},
                                               {"lem_start", "lemke_start", "always"},
                                               {"mer_func", "merit_function", "normal"},
                                               {"grad_step", "gradient_step_limit", "1"},
                                               {"res_lim", "restart_limit", "2"},
                                               {"prep", "preprocess", "no"},
                                               {"out_maj_iter_freq", "output_major_iterations_frequency", "10"}}) {
    Settings settings = applied({{key, value, ""}}).settings;
    const ncp::Fields fields = fields_of(settings);
    ASSERT_NE(fields.find(full), nullptr) << full;
    EXPECT_EQ(value_text(*fields.find(full)), value) << key;
  }
}

// Every option of PATH's manual is accepted by its name. Would catch one lost when an option of ours takes its place.
TEST(Options, AllOfPathsNamesAreKnown) {
  EXPECT_GE(path_options().size(), 55U);
  for (const std::string_view name : path_options()) {
    const bool ignored = std::ranges::find(ignored_options(), name) != ignored_options().end();
    bool ours = false;
    for (const Option& entry : options()) ours = ours || entry.key == name || entry.alias == name;
    EXPECT_NE(ignored, ours) << name;
  }
  for (const char* name : {"nms", "crash_method", "merit_function", "restart_limit", "output_major_iterations"})
    EXPECT_THAT(ignored_options(), testing::Not(testing::Contains(std::string_view(name))));
}

// Would catch values that are clamped or half read ("1e-3x") in place of a refusal with key, value, range and source.
TEST(Options, BadValuesAreRefusedByName) {
  const std::vector<std::array<std::string, 3>> bad{{"tol", "0", "a number > 0"},
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
                                                    {"lu", "lapack", ", klu, eigen"},
                                                    {"method", "newton", "auto, path, miles, nesqp, qpcomp"},
                                                    {"method", "semismoth", "Did you mean 'semismooth'"},
                                                    {"cfunction", "fisher-burmeister", "'fischer-burmeister'"},
                                                    {"crash_method", "newton", "pnewton or none"},
                                                    {"nms_searchtype", "curve", "path, line or arc"},
                                                    {"nms_initial_reference_factor", "0.5", "in [1"},
                                                    {"restart_limit", "-1", ">= 0"},
                                                    {"output_major_iterations", "maybe", "yes or no"},
                                                    {"lemke_start", "never", "automatic, first or always"},
                                                    {"sideineq", "3", "in [1, 2]"},
                                                    {"major", "99999999999", ">= 0"}};
  for (const auto& [key, value, range] : bad)
    EXPECT_THAT(refusal({{key, value, "here:7"}}),
                testing::AllOf(HasSubstr("here:7"), HasSubstr(key), HasSubstr(value), HasSubstr(range)))
        << key << '=' << value;
}

// A bad value must not pass because the chosen method has no such field.
TEST(Options, WithoutEffectOnTheMethodIsSaidAndStillChecked) {
  EXPECT_THAT(applied({{"method", "semismooth", ""}, {"lemke_start", "always", ""}}).notes,
              testing::ElementsAre(HasSubstr("lemke_start has no effect on method semismooth")));
  EXPECT_THAT(refusal({{"method", "semismooth", ""}, {"lemke_start", "never", ""}}), HasSubstr("lemke_start"));
  EXPECT_THAT(applied({{"method", "semismooth", ""}, {"nms", "no", ""}}).notes,
              testing::ElementsAre(HasSubstr("nms has no effect on method semismooth")));
}

TEST(Options, PathOptionsWithoutCounterpartAreAcceptedAndNamed) {
  const Applied result = applied({{"crash_perturb", "no", ""}, {"logfile", "x.log", ""}});
  EXPECT_THAT(result.notes, testing::ElementsAre(testing::AllOf(HasSubstr("without effect"), HasSubstr("crash_perturb"),
                                                                HasSubstr("logfile"))));
  EXPECT_THAT(applied({{"lemke_start", "first", ""}, {"method", "josephy", ""}}).notes,
              testing::ElementsAre(HasSubstr("automatic")));
  EXPECT_THAT(applied({{"lemke_start", "first", ""}}).notes, IsEmpty());
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
  std::istringstream in("# comment\n\n* another\ntol 1e-4\nmethod = josephy  # and why\nlu=klu;\r\nprox_pert 0.1;\n");
  const std::vector<Assignment> all = parse_options_file(in, "path.opt");
  EXPECT_EQ(pairs(all), "tol:1e-4;method:josephy;lu:klu;prox_pert:0.1;");
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
  EXPECT_EQ(option("convergence_tolerance").alias, "tol");
}

}  // namespace
}  // namespace perp::app
