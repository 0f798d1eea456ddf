#pragma once
/// Options as people, option files and AMPL write them: key=value, with PATH's names where PATH has them. One table
/// says what each key sets; nothing else in the program knows an option by name.
///
/// A key may be shortened word by word as long as it is unique (maj_iter for major_iteration_limit; PATH's options go
/// before ours, and names of as many words before longer ones), and is read without regard to case. When a key is given
/// more than once, the last value wins; the order is: environment (AMPL only: perp_options, path_options,
/// pathampl_options), options file, then the command line from left to right.
#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/methods.hpp"
#include "app/options_text.hpp"
#include "app/program.hpp"
#include "ncp/solve.hpp"

namespace perp::app {

/// One of PATH's output switches. Where it is not given, `output` decides.
struct Switch {
  bool usual = true;  ///< part of the usual output
  std::optional<bool> given{};
};

/// What of the log is printed.
struct Output {
  bool all = true;
  Switch crash_iterations{};
  Switch major_iterations{};
  Switch restart_log{};
  Switch initial_statistics{.usual = false};
  Switch final_statistics{};
  Switch final_summary{};
  Switch options{.usual = false};
  int crash_frequency = 1;
  int major_frequency = 1;

  bool shows(const Switch& part) const { return part.given.value_or(all && part.usual); }
  /// Does a table of iterations?
  bool table() const { return shows(crash_iterations) || shows(major_iterations) || shows(restart_log); }
};

/// What options set: a method with its fields, and a few things that concern the program alone.
struct Settings {
  std::string method_name{default_method};
  ncp::Method method = find_method(default_method)->method;  ///< methods()' entry of that name, the options applied
  std::optional<int> solutions{};                            ///< several, by deflation: at most so many
  Output output{};
  int sideineq = 1;  ///< 1 accept side inequalities of a model, 2 refuse it for them
  int wantsol = 1;   ///< AMPL's bits; of them 8 (do not print the message) means something
};

struct Choice {
  enum class Role {
    Name,     ///< of the value
    Synonym,  ///< accepted
    StandIn   ///< the value is taken for want of what the word asks for: worth a note
  };
  std::string_view name;
  int value;
  Role role = Role::Name;
};
/// A place that takes one of a few words.
struct Word {
  std::span<const Choice> choices;
  std::function<int()> get;
  std::function<void(int)> set;
};

/// A number that exists, and whose range is known, only where another option has made its choice.
struct DependentNumber {
  std::function<std::optional<double>()> get;
  std::function<void(double)> set;  ///< throws std::invalid_argument, saying why, for a value that makes no sense
  std::string_view range;           ///< in words
};

/// Instead of a place: the option has no effect on the run's method.
struct NoEffect {
  std::string_view
      because{};  ///< another option's value that takes the effect away; empty: the method has no such thing
};

/// The place an option sets.
using Field = std::variant<NoEffect, std::string*, double*, int*, unsigned*, ncp::Index*, bool*,
                           std::chrono::duration<double>*, Word, DependentNumber>;

struct Range {
  double low = 0;
  double high = lcp::infinity;
  bool open = false;      ///< the ends do not belong to it
  bool open_high = open;  ///< the upper one does not
};

struct Option {
  std::string_view key;
  std::vector<std::string_view> aliases;
  Range range;  ///< of numbers
  std::string_view help;
  Field (*field)(Settings& settings);
};

/// What depends on another option stands after it.
std::span<const Option> options();
/// The options of PATH 4.7 (its manual, table of options).
std::span<const std::string_view> path_options();
/// Those of them that are accepted without effect.
std::span<const std::string_view> ignored_options();

/// "a number > 0", "yes or no", "umfpack, klu or eigen": what the option takes.
std::string values_text(const Option& option);
/// The value in the field, as it would be written; "-" for NoEffect.
std::string value_text(const Field& field);
/// Whether there is something to list: an effect, and of numbers that depend on another option a value.
bool has_value(const Field& field);

/// A key that no option has.
class UnknownOption : public InputError {
 public:
  using InputError::InputError;
};

enum class Unknown {
  Refuse,  ///< an unknown key throws
  Report,  ///< an unknown key is listed in Applied::unknown
};

struct Applied {
  Settings settings;
  std::vector<std::string> notes;    ///< options without effect, and why
  std::vector<std::string> unknown;  ///< messages about unknown keys
};
/// Starts from the defaults of the method named last and applies the assignments in the order of the table, so that
/// what depends on another option finds it set; of several of one key the last one wins. Throws InputError naming
/// source, key, value and range for a value that makes no sense, for an ambiguous key, and for options that contradict
/// each other (ncp::invalid).
Applied apply_options(std::span<const Assignment> assignments, Unknown unknown = Unknown::Refuse);
/// Adds notes on what the size n of the problem takes from the options.
void note_limits_of_size(ncp::Index n, Applied& options);

}  // namespace perp::app
