/// What the table of options leaves out, and whether it tells the truth: every field of a method has a key or a reason,
/// ranges are the library's, what has no effect is not shown.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "app/options.hpp"
#include "app/report.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

Applied applied(std::vector<Assignment> assignments) {
  for (Assignment& given : assignments) given.source = "test";
  return apply_options(assignments);
}

const Option& option(std::string_view key) { return *std::ranges::find(options(), key, &Option::key); }

// Options that another one makes inert are neither listed nor silently taken, and the order of the two does not matter.
// Would catch `rescalings=2` among the options of a method without escapes.
TEST(Options, InertOnesAreNotShown) {
  const auto effect = [](std::vector<Assignment> given, const char* key) {
    Settings settings = applied(std::move(given)).settings;
    return value_text(option(key).field(settings));
  };
  struct Case {
    const char* method;
    const char* key;
    const char* value;
    const char* by;
    const char* off;
    const char* on;
  };
  for (const Case& c :
       {Case{"semismooth", "rescalings", "1", "escape_rounds", "0", "9"},
        Case{"interior", "escape_lambda", "3", "escape_rounds", "0", "9"},
        Case{"semismooth", "forcing_max", "0.5", "linear_solver", "direct", "krylov"},
        Case{"path", "crash_iteration_limit", "7", "crash_method", "none", "pnewton"},
        Case{"auto", "nms_maximum_watchdogs", "1", "nms", "no", "yes"},
        Case{"smooth", "smoothing_neighbourhood", "50", "smoothing_schedule", "newton-armijo", "predictor-corrector"},
        Case{"smooth", "smoothing_shrink", "0.25", "smoothing_schedule", "predictor-corrector", "newton-armijo"}}) {
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
  EXPECT_EQ(effect({{"method", "semismooth", ""}}, "rescalings"), "-");
  EXPECT_EQ(effect({{"method", "semicomp", ""}}, "rescalings"), "2");
}

// The Fischer-Burmeister function has no parameter: "-" is no value of an option.
TEST(Options, AreListedWithValuesOnly) {
  const auto listed = [](const char* method) {
    std::ostringstream out;
    print_options(out, applied({{"method", method, ""}}).settings);
    return out.str();
  };
  EXPECT_THAT(listed("semismooth"), testing::Not(testing::AnyOf(HasSubstr("cfunction_parameter"), HasSubstr("=-"))));
  EXPECT_THAT(listed("semismooth"), testing::Not(HasSubstr("rescalings")));
  EXPECT_THAT(listed("semismooth-penalised"), HasSubstr("cfunction_parameter="));
}

// What the help says of a range is what is checked: its ends, and what lies beyond its lower one. Would catch a range
// that invites a value which the library then refuses (crash_least_step = 0), or keeps one back that it takes.
TEST(Options, RangesAreThoseOfTheLibrary) {
  // Where the end of the range depends on another option, or is the first value with an effect.
  const std::vector<std::string_view> apart{"smoothing_neighbourhood", "gsl_mu_end", "minor_iteration_limit"};
  const auto library = [](const MethodEntry& entry, const Option& tried, double value) {
    Settings settings{.method_name = std::string(entry.name), .method = entry.method};
    if (tried.key == "gsl_mu") std::get<ncp::Multiroot>(settings.method).mu_end = 1e-300;
    const Field field = tried.field(settings);
    std::visit(
        [&](auto target) {
          using T = std::remove_pointer_t<decltype(target)>;
          if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
            *target = static_cast<T>(value);
          else if constexpr (std::is_same_v<T, std::chrono::duration<double>>)
            *target = T(value);
        },
        field);
    return !ncp::invalid(settings.method);
  };
  for (const MethodEntry& entry : methods()) {
    if (entry.affine()) continue;  // these check when they run
    for (const Option& tried : options()) {
      Settings settings{.method_name = std::string(entry.name), .method = entry.method};
      const Field field = tried.field(settings);
      const bool integer = std::holds_alternative<int*>(field) || std::holds_alternative<ncp::Index*>(field);
      const bool real =
          std::holds_alternative<double*>(field) || std::holds_alternative<std::chrono::duration<double>*>(field);
      if (!(integer || real) || std::ranges::find(apart, tried.key) != apart.end()) continue;
      if (tried.key == "sideineq" || tried.key == "wantsol" || tried.key.starts_with("output_")) continue;
      SCOPED_TRACE(std::string(entry.name) + ": " + std::string(tried.key));
      const Range& range = tried.range;
      if (tried.key != "time_limit" && tried.key != "crash_minimum_dimension" && tried.key != "crash_nbchange_limit") {
        EXPECT_EQ(library(entry, tried, range.low), !range.open);
        EXPECT_FALSE(library(entry, tried, integer ? range.low - 1 : range.low - 1e-3));
      }
      const bool bounded = range.high <= 2;  // else a limit that nobody comes to
      if (bounded) {
        EXPECT_EQ(library(entry, tried, range.high), !range.open_high);
        EXPECT_FALSE(library(entry, tried, integer ? range.high + 1 : range.high + 1e-3));
      }
    }
  }
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

struct Member {
  std::string_view name;
  std::string_view key;  ///< of options(); in parentheses why there is none
};
struct Known {
  const char* name;
  std::size_t count;
  std::vector<Member> members;
};

// Each member of each option struct of the nonlinear methods has a key, or a reason why not. Would catch a new member
// that nobody can set: the counts then differ.
TEST(Options, ReachEveryField) {
  constexpr std::string_view part = "(a struct of this list)";
  constexpr std::string_view inner = "(an inner tolerance that no run was seen to depend on)";
  constexpr std::string_view code = "(for programs: a callback, a pointer, data of the problem's size)";
  constexpr std::string_view preset = "(a method of its own on the command line)";
  const std::vector<Known> structs{
      {"Stop",
       members<ncp::Stop>(),
       {{"tol", "convergence_tolerance"},
        {"tol_relative", "relative_tolerance"},
        {"max_iterations", "major_iteration_limit"},
        {"max_F_evals", "evaluation_limit"},
        {"max_time", "time_limit"},
        {"interrupt", code},
        {"check_derivatives", "check_derivatives"}}},
      {"Armijo",
       members<ncp::Armijo>(),
       {{"sigma", "sigma"}, {"beta", "beta"}, {"max_backtracks", "max_backtracks"}, {"memory", "nms_memory_size"}}},
      {"Escape",
       members<ncp::Escape>(),
       {{"rounds", "escape_rounds"},
        {"lambda", "escape_lambda"},
        {"grow", "escape_grow"},
        {"shrink", "escape_shrink"},
        {"accept", "escape_accept"},
        {"trial_iterations", "escape_trial_iterations"},
        {"perturbed_tol", "escape_tolerance"},
        {"perturbed_iterations", "escape_iteration_limit"},
        {"rescalings", "rescalings"}}},
      {"Auto",
       members<ncp::Auto>(),
       {{"stop", part}, {"large", "auto_large"}, {"path", part}, {"semismooth", "(set where semismooth is named)"}}},
      {"Forcing",
       members<ncp::Forcing>(),
       {{"eta_max", "forcing_max"},
        {"gamma", "forcing_gamma"},
        {"alpha", "forcing_alpha"},
        {"max_iterations", "krylov_iteration_limit"},
        {"chord_steps", "chord_steps"}}},
      {"SemismoothNewton",
       members<ncp::SemismoothNewton>(),
       {{"stop", part},
        {"cfunction", "cfunction"},
        {"search", part},
        {"descent_rho", "descent_rho"},
        {"descent_p", "descent_p"},
        {"levenberg_marquardt", "levenberg_marquardt"},
        {"escape", part},
        {"linear", "linear_solver"},
        {"forcing", part},
        {"lu", "lu"}}},
      {"MinNewton",
       members<ncp::MinNewton>(),
       {{"stop", part}, {"direction", preset}, {"search", part}, {"escape", part}, {"lu", "lu"}}},
      {"Smoothing",
       members<ncp::Smoothing>(),
       {{"stop", part},
        {"function", "smoothing_function"},
        {"schedule", "smoothing_schedule"},
        {"search", part},
        {"shrink", "smoothing_shrink"},
        {"centring", "smoothing_centring"},
        {"neighbourhood", "smoothing_neighbourhood"},
        {"finish", "smoothing_finish"},
        {"restarts", "smoothing_restarts"},
        {"patience", "patience"},
        {"rescalings", "rescalings"},
        {"lu", "lu"}}},
      {"InteriorPoint",
       members<ncp::InteriorPoint>(),
       {{"stop", part},
        {"to_boundary", "interior_to_boundary"},
        {"neighbourhood", "interior_neighbourhood"},
        {"least_centring", "interior_centring"},
        {"growth", "interior_growth"},
        {"margin", "interior_margin"},
        {"finish", "interior_finish"},
        {"restarts", "interior_restarts"},
        {"patience", "patience"},
        {"escape", part},
        {"lu", "lu"},
        {"follow", code}}},
      {"NewtonJosephy",
       members<ncp::NewtonJosephy>(),
       {{"stop", part},
        {"search", part},
        {"escape", part},
        {"subproblem", "subproblem"},
        {"chord_steps", "chord_steps"},
        {"lemke", part}}},
      {"NewtonRobinson", members<ncp::NewtonRobinson>(), {{"stop", part}, {"lemke", part}}},
      {"Crash",
       members<ncp::Crash>(),
       {{"on", "crash_method"},
        {"iteration_limit", "crash_iteration_limit"},
        {"minimum_dimension", "crash_minimum_dimension"},
        {"nbchange_limit", "crash_nbchange_limit"},
        {"least_step", "crash_least_step"}}},
      {"Nms",
       members<ncp::Nms>(),
       {{"on", "nms"},
        {"memory", "nms_memory_size"},
        {"mstep_frequency", "nms_mstep_frequency"},
        {"initial_reference_factor", "nms_initial_reference_factor"},
        {"maximum_watchdogs", "nms_maximum_watchdogs"},
        {"distance_decrease", "distance_decrease"}}},
      {"PathSearch",
       members<ncp::PathSearch>(),
       {{"stop", part},
        {"merit", "merit_function"},
        {"search", "nms_searchtype"},
        {"sigma", "sigma"},
        {"beta", "beta"},
        {"max_backtracks", "max_backtracks"},
        {"crash", part},
        {"nms", part},
        {"start", "lemke_start"},
        {"chord_steps", "chord_steps"},
        {"proximal_perturbation", "proximal_perturbation"},
        {"proximal_adaptive", "proximal_adaptive"},
        {"gradient_step_limit", "gradient_step_limit"},
        {"restarts", "restarts"},
        {"restart_limit", "restart_limit"},
        {"cumulative_iteration_limit", "cumulative_iteration_limit"},
        {"patience", "patience"},
        {"preprocess", "preprocess"},
        {"scaling", "scaling"},
        {"lemke", part},
        {"basis", "(--warm-start)"}}},
      {"LemkeOptions",
       members<lcp::LemkeOptions>(),
       {{"start", "lemke_start"},
        {"cover", "lemke_cover"},
        {"covering", code},
        {"cells", code},
        {"max_pivots", "minor_iteration_limit"},
        {"residual_tol", "(the run's own)"},
        {"pivot_tol", "pivot_tolerance"},
        {"doubtful_pivot", inner},
        {"feasibility_tol", inner},
        {"perturbation", "lemke_perturbation"},
        {"seed", "lemke_seed"},
        {"singular_rcond", inner},
        {"keep_basis", code},
        {"keep_path", code},
        {"path_limit", code},
        {"basis", part},
        {"interrupted", code},
        {"deadline", "time_limit"}}},
      {"BasisOptions",
       members<lcp::BasisOptions>(),
       {{"lu", "lu"},
        {"refactor_every", "refactor_every"},
        {"fill_limit", inner},
        {"growth_limit", inner},
        {"work_limit", inner},
        {"drift_limit", inner},
        {"unstable_tol", inner},
        {"singular_tol", inner},
        {"dependent_tol", inner}}},
      {"Multiroot",
       members<ncp::Multiroot>(),
       {{"stop", part},
        {"solver", "gsl_solver"},
        {"mu", "gsl_mu"},
        {"shrink", "gsl_shrink"},
        {"mu_end", "gsl_mu_end"},
        {"max_size", "gsl_max_size"}}},
      {"Affine", members<ncp::Affine>(), {{"stop", part}, {"method", preset}}}};
  for (const Known& known : structs) {
    EXPECT_EQ(known.members.size(), known.count) << known.name << " has a member that is not in this list";
    for (const auto& [name, key] : known.members)
      EXPECT_TRUE(key.starts_with('(') || std::ranges::find(options(), key, &Option::key) != options().end())
          << known.name << "::" << name << " has no key " << key;
  }
}

}  // namespace
}  // namespace perp::app
