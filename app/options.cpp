#include "app/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>

namespace perp::app {

namespace {

constexpr double max_int = std::numeric_limits<int>::max();
constexpr double years = 1e9;  // of seconds: a limit that no clock overflows with

/// The field that one of `gets` finds in the run's method; a get that does not compile for a method finds nothing.
template <class... Gets>
Field of_method(Run& run, Gets... gets) {
  return std::visit(
      [&](auto& method) {
        Field field;
        const auto look = [&](auto get) {
          if constexpr (std::is_invocable_v<decltype(get), decltype(method)>) field = get(method);
        };
        (look(gets), ...);
        return field;
      },
      run.method);
}

}  // namespace

std::span<const Option> options() {
  static const std::array table{
      Option{"method",
             {},
             {},
             "the method that runs; the other options apply to it, whatever their order",
             [](Run& run) -> Field { return &run.method_name; }},
      Option{"convergence_tolerance",
             {"tol"},
             {0, lcp::infinity, true},
             "tol: solved when the natural residual max_i |x_i - mid(l_i, x_i - F_i(x), u_i)| is at most tol",
             [](Run& run) -> Field { return &ncp::stop(run.method).tol; }},
      Option{"major_iteration_limit",
             {"max_iterations"},
             {0, max_int},
             "iterations (a linearisation each) after which to give up",
             [](Run& run) -> Field { return &ncp::stop(run.method).max_iterations; }},
      Option{"time_limit",
             {"max_time"},
             {0, years, true},
             "seconds after which to give up",
             [](Run& run) -> Field { return &ncp::stop(run.method).max_time; }},
      Option{"check_derivatives",
             {},
             {},
             "compare the Jacobian with differences of F at the start, and refuse a problem whose Jacobian is wrong",
             [](Run& run) -> Field { return &ncp::stop(run.method).check_derivatives; }},
      Option{"output",
             {},
             {},
             "print the iteration table (from AMPL: no, unless asked for)",
             [](Run& run) -> Field { return &run.output; }},
      Option{"nms_memory_size",
             {"memory"},
             {1, 1e6},
             "non-monotone line search: merits remembered, the largest of which must be beaten; 1 is monotone",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.search.memory) { return &m.search.memory; });
             }},
      Option{"sigma",
             {},
             {0, 1, true},
             "line search: share of the predicted decrease of the merit that is demanded",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.search.sigma) { return &m.search.sigma; });
             }},
      Option{
          "beta",
          {},
          {0, 1, true},
          "line search: factor of the step length a trial",
          [](Run& run) { return of_method(run, [](auto& m) -> decltype(&m.search.beta) { return &m.search.beta; }); }},
      Option{"max_backtracks",
             {},
             {0, 1000},
             "line search: trials before the direction is given up",
             [](Run& run) {
               return of_method(run,
                                [](auto& m) -> decltype(&m.search.max_backtracks) { return &m.search.max_backtracks; });
             }},
      Option{
          "descent_rho",
          {},
          {0, lcp::infinity, true},
          "a Newton direction d needs  merit'(x; d) <= -descent_rho |d|^descent_p",
          [](Run& run) { return of_method(run, [](auto& m) -> decltype(&m.descent_rho) { return &m.descent_rho; }); }},
      Option{"descent_p",
             {},
             {2, lcp::infinity, true},
             "see descent_rho",
             [](Run& run) { return of_method(run, [](auto& m) -> decltype(&m.descent_p) { return &m.descent_p; }); }},
      Option{"escape_rounds",
             {},
             {0, max_int},
             "where the method is stuck: proximal problems  F(x) + lambda (x - xbar)  tried to get away; 0: stay stuck",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.escape.rounds) { return &m.escape.rounds; });
             }},
      Option{"escape_lambda",
             {},
             {0, lcp::infinity, true},
             "that lambda, in units of sqrt(|J|_1 |J|_inf)",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.escape.lambda) { return &m.escape.lambda; });
             }},
      Option{"lu",
             {},
             {},
             "the sparse LU factorization used",
             [](Run& run) {
               return of_method(
                   run, [](auto& m) -> decltype(&m.lu) { return &m.lu; },
                   [](auto& m) -> decltype(&m.lemke.basis.lu) { return &m.lemke.basis.lu; });
             }},
      Option{"minor_iteration_limit",
             {"max_pivots"},
             {1, max_int},
             "pivots of one linearised problem",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.lemke.max_pivots) { return &m.lemke.max_pivots; });
             }},
      Option{
          "lemke_start",
          {},
          {},
          "where pivoting starts: automatic (the cell of the current point) or always (a ray, as Lemke's method)",
          [](Run& run) { return of_method(run, [](auto& m) -> decltype(&m.lemke.start) { return &m.lemke.start; }); }},
      Option{"pivot_tolerance",
             {},
             {0, 1, true},
             "smallest pivot, relative to the largest entry of its column",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.lemke.pivot_tol) { return &m.lemke.pivot_tol; });
             }},
      Option{"lemke_perturbation",
             {},
             {0, 1},
             "relative perturbation of the path's start, against ties; 0: none",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.lemke.perturbation) { return &m.lemke.perturbation; });
             }},
      Option{"lemke_seed",
             {"seed"},
             {0, max_int},
             "of that perturbation and of the ray",
             [](Run& run) { return of_method(run, [](auto& m) -> decltype(&m.lemke.seed) { return &m.lemke.seed; }); }},
      Option{"refactor_every",
             {},
             {1, max_int},
             "pivots between fresh factorizations of the basis",
             [](Run& run) {
               return of_method(run, [](auto& m) -> decltype(&m.lemke.basis.refactor_every) {
                 return &m.lemke.basis.refactor_every;
               });
             }},
      Option{"sideineq",
             {},
             {1, 2},
             "a model's side inequalities: 1 accepts them, with an extra variable each; 2 refuses the model",
             [](Run& run) -> Field { return &run.sideineq; }},
      Option{"wantsol",
             {},
             {0, 15},
             "AMPL's: 8 does not print the closing message (the .sol file is written whatever the value)",
             [](Run& run) -> Field { return &run.wantsol; }},
  };
  return table;
}

std::span<const std::string_view> ignored_options() {
  static constexpr auto keys = std::to_array<std::string_view>({"crash_iteration_limit",
                                                                "crash_merit_function",
                                                                "crash_method",
                                                                "crash_minimum_dimension",
                                                                "crash_nbchange_limit",
                                                                "crash_perturb",
                                                                "crash_searchtype",
                                                                "cumulative_iteration_limit",
                                                                "factorization_method",
                                                                "gradient_searchtype",
                                                                "gradient_step_limit",
                                                                "interrupt_limit",
                                                                "lemke_rank_deficiency_iterations",
                                                                "lemke_start_type",
                                                                "logfile",
                                                                "merit_function",
                                                                "nms",
                                                                "nms_initial_reference_factor",
                                                                "nms_maximum_watchdogs",
                                                                "nms_mstep_frequency",
                                                                "nms_searchtype",
                                                                "output_crash_iterations",
                                                                "output_crash_iterations_frequency",
                                                                "output_errors",
                                                                "output_factorization_singularities",
                                                                "output_final_degeneracy_statistics",
                                                                "output_final_point",
                                                                "output_final_point_statistics",
                                                                "output_final_scaling_statistics",
                                                                "output_final_statistics",
                                                                "output_final_summary",
                                                                "output_initial_point",
                                                                "output_initial_point_statistics",
                                                                "output_initial_scaling_statistics",
                                                                "output_initial_statistics",
                                                                "output_initial_summary",
                                                                "output_linear_model",
                                                                "output_major_iterations",
                                                                "output_major_iterations_frequency",
                                                                "output_minor_iterations",
                                                                "output_minor_iterations_frequency",
                                                                "output_model_statistics",
                                                                "output_options",
                                                                "output_preprocess",
                                                                "output_restart_log",
                                                                "output_time",
                                                                "output_warnings",
                                                                "preprocess",
                                                                "proximal_perturbation",
                                                                "restart_limit",
                                                                "return_best_point",
                                                                "statusfile"});
  return keys;
}

// Values.

namespace {

struct Choice {
  std::string_view name;
  int value;
};

constexpr std::array lu_choices{Choice{"umfpack", static_cast<int>(lcp::LuBackend::Umfpack)},
                                Choice{"klu", static_cast<int>(lcp::LuBackend::Klu)},
                                Choice{"eigen", static_cast<int>(lcp::LuBackend::Eigen)}};
// `first` asks for a ray in the first iteration alone, which no method here does: see set().
constexpr std::array start_choices{Choice{"automatic", static_cast<int>(lcp::LemkeStart::Regular)},
                                   Choice{"always", static_cast<int>(lcp::LemkeStart::Ray)},
                                   Choice{"first", static_cast<int>(lcp::LemkeStart::Regular)}};
constexpr std::array bool_choices{Choice{"yes", 1}, Choice{"no", 0},  Choice{"true", 1}, Choice{"false", 0},
                                  Choice{"on", 1},  Choice{"off", 0}, Choice{"1", 1},    Choice{"0", 0}};

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return result;
}

std::string alternatives(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += fmt::format("{}{}", k == 0 ? "" : (k + 1 == names.size() ? " or " : ", "), names[k]);
  return text;
}

std::vector<std::string_view> names_of(std::span<const Choice> choices) {
  std::vector<std::string_view> names;
  for (const Choice& choice : choices) names.push_back(choice.name);
  return names;
}

/// "a number > 0", "an integer in [1, 2]".
std::string range_text(const Range& range, bool integer) {
  const auto end = [](double value) { return value == max_int ? "2147483647" : fmt::format("{:g}", value); };
  const std::string what = integer ? "an integer" : "a number";
  if (range.high < (integer ? max_int : lcp::infinity))
    return fmt::format("{} in {}{}, {}{}", what, range.open ? '(' : '[', end(range.low), end(range.high),
                       range.open ? ')' : ']');
  return fmt::format("{} {} {}", what, range.open ? ">" : ">=", end(range.low));
}

/// What the option's field holds, whichever method has it.
Field any_field(const Option& option, Run& run) {
  Field field = option.field(run);
  for (const MethodEntry& entry : methods()) {
    if (!std::holds_alternative<std::monostate>(field)) break;
    run.method = entry.make();
    field = option.field(run);
  }
  return field;
}

/// A number's text without the '+' that from_chars does not take.
template <class T>
bool parse_number(std::string_view text, T& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

[[noreturn]] void refuse(const Assignment& given, const Option& option) {
  const std::string key = lower(given.key) == option.key ? given.key : fmt::format("{} ({})", given.key, option.key);
  throw InputError(fmt::format("{}: {} = {} is refused; it takes {}", given.source, key,
                               given.value.empty() ? "(nothing)" : given.value, values_text(option)));
}

template <class T>
T number_in_range(const Assignment& given, const Option& option) {
  T value{};
  if (!parse_number(given.value, value)) refuse(given, option);
  const auto x = static_cast<double>(value);
  const Range& range = option.range;
  const bool inside = range.open ? x > range.low && x < range.high : x >= range.low && x <= range.high;
  if (!inside) refuse(given, option);  // also a NaN
  return value;
}

int one_of(std::span<const Choice> choices, const Assignment& given, const Option& option) {
  const auto choice = std::ranges::find(choices, lower(given.value), &Choice::name);
  if (choice == choices.end()) refuse(given, option);
  return choice->value;
}

/// Sets the field. Pre: not monostate.
void set(const Field& field, const Assignment& given, const Option& option, Applied& result) {
  std::visit(
      [&](auto target) {
        using T = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string>) {
          if (find_method(lower(given.value)) == nullptr) refuse(given, option);
          *target = lower(given.value);
        } else if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int> || std::is_same_v<T, unsigned>) {
          *target = number_in_range<T>(given, option);
        } else if constexpr (std::is_same_v<T, std::chrono::duration<double>>) {
          *target = T(number_in_range<double>(given, option));
        } else if constexpr (std::is_same_v<T, bool>) {
          *target = one_of(bool_choices, given, option) != 0;
        } else if constexpr (std::is_same_v<T, lcp::LuBackend>) {
          *target = static_cast<T>(one_of(lu_choices, given, option));
        } else if constexpr (std::is_same_v<T, lcp::LemkeStart>) {
          *target = static_cast<T>(one_of(start_choices, given, option));
          if (lower(given.value) == "first")
            result.notes.emplace_back("lemke_start = first is taken as automatic: no method starts on a ray only once");
        }
      },
      field);
}

}  // namespace

std::string values_text(const Option& option) {
  Run run;
  return std::visit(
      [&](auto target) -> std::string {
        using T = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string>)
          return alternatives(method_names());
        else if constexpr (std::is_same_v<T, double>)
          return range_text(option.range, false);
        else if constexpr (std::is_same_v<T, int> || std::is_same_v<T, unsigned>)
          return range_text(option.range, true);
        else if constexpr (std::is_same_v<T, std::chrono::duration<double>>)
          return range_text(option.range, false);
        else if constexpr (std::is_same_v<T, bool>)
          return "yes or no";
        else if constexpr (std::is_same_v<T, lcp::LuBackend>)
          return alternatives(names_of(lu_choices));
        else if constexpr (std::is_same_v<T, lcp::LemkeStart>)
          return alternatives(names_of(start_choices));
        else
          return "-";
      },
      any_field(option, run));
}

std::string value_text(const Field& field) {
  return std::visit(
      [](auto target) -> std::string {
        using T = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, int> || std::is_same_v<T, unsigned>)
          return fmt::format("{}", *target);
        else if constexpr (std::is_same_v<T, double>)
          return fmt::format("{}", *target);
        else if constexpr (std::is_same_v<T, std::chrono::duration<double>>)
          return fmt::format("{:g}", target->count());
        else if constexpr (std::is_same_v<T, bool>)
          return *target ? "yes" : "no";
        else if constexpr (std::is_same_v<T, lcp::LuBackend>)
          return std::string(lcp::to_string(*target));
        else if constexpr (std::is_same_v<T, lcp::LemkeStart>)
          return *target == lcp::LemkeStart::Ray ? "always" : "automatic";
        else
          return "-";
      },
      field);
}

// Keys.

namespace {

struct Found {
  const Option* option = nullptr;
  std::string_view ignored;  // a key of ignored_options()
};

/// The option a key names: exactly, or as a unique prefix. Throws InputError if the prefix is not unique.
Found find_option(const Assignment& given) {
  const std::string key = lower(given.key);
  std::vector<std::pair<std::string_view, const Option*>> prefixed;
  const auto look = [&](std::string_view name, const Option* option) {
    if (name.starts_with(key)) prefixed.emplace_back(name, option);
    return name == key;
  };
  for (const Option& option : options()) {
    if (look(option.key, &option)) return {&option, {}};
    for (const std::string_view alias : option.aliases)
      if (look(alias, &option)) return {&option, {}};
  }
  for (const std::string_view name : ignored_options())
    if (look(name, nullptr)) return {nullptr, name};
  if (prefixed.empty()) return {};
  const auto& [name, option] = prefixed.front();
  const bool one_option = std::ranges::all_of(prefixed, [&](const auto& other) {
    return other.second == option && (option != nullptr || other.first == name);
  });
  if (one_option) return {option, option == nullptr ? name : std::string_view{}};
  std::vector<std::string_view> names;
  for (const auto& other : prefixed) names.push_back(other.first);
  throw InputError(fmt::format("{}: '{}' is ambiguous: {}", given.source, given.key, alternatives(names)));
}

std::string unknown_key(const Assignment& given) {
  std::vector<std::string_view> names;
  for (const Option& option : options()) {
    names.push_back(option.key);
    names.insert(names.end(), option.aliases.begin(), option.aliases.end());
  }
  return fmt::format("{}: there is no option '{}'.{}", given.source, given.key, did_you_mean(given.key, names));
}

}  // namespace

Applied apply_options(std::span<const Assignment> assignments, Unknown unknown) {
  Applied result;
  std::vector<std::pair<const Option*, const Assignment*>> fields;
  std::vector<std::string_view> ignored;
  for (const Assignment& given : assignments) {
    const Found found = find_option(given);
    if (found.option != nullptr && found.option->key == "method")
      set(found.option->field(result.run), given, *found.option, result);
    else if (found.option != nullptr)
      fields.emplace_back(found.option, &given);
    else if (!found.ignored.empty())
      ignored.push_back(found.ignored);
    else if (unknown == Unknown::Refuse)
      throw InputError(unknown_key(given) + " 'perp methods' lists them all.");
    else
      result.unknown.push_back(unknown_key(given));
  }
  Run& run = result.run;
  run.method = find_method(run.method_name)->make();
  for (const auto& [option, given] : fields) {
    const Field field = option->field(run);
    if (std::holds_alternative<std::monostate>(field)) {
      Run other = run;  // the value is checked all the same
      set(any_field(*option, other), *given, *option, result);
      result.notes.push_back(
          fmt::format("{}: {} has no effect on method {}", given->source, option->key, run.method_name));
    } else {
      set(field, *given, *option, result);
    }
  }
  if (!ignored.empty())
    result.notes.push_back(fmt::format("accepted, but without effect in this version: {}", fmt::join(ignored, ", ")));
  if (const auto why = ncp::invalid(run.method)) throw InputError(*why);
  return result;
}

}  // namespace perp::app
