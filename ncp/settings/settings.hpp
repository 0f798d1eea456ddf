// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options as people, option files and AMPL write them: key=value, with PATH's names where PATH has them. What each key
/// sets is described where the options of a method are (ncp/problem/fields.hpp).
///
/// A key may be shortened word by word as long as it is unique (maj_iter for major_iteration_limit; PATH's options go
/// before ours, and names of as many words before longer ones), and is read without regard to case. "PART.key" sets it
/// in the parts of the method with this name alone: path.crash_method of first(path, smooth). When a key is given more
/// than once, the last value wins; the order is: environment (AMPL only: perp_options, path_options, pathampl_options),
/// options file, then the command line from left to right.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/problem/fields.hpp"
#include "ncp/settings/assignments.hpp"
#include "ncp/settings/input_error.hpp"
#include "ncp/settings/method_table.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::settings {

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

/// What a table shows of it.
ncp::TableOptions table_options(const Output& output);

/// What options set: a method with its fields, and a few things that concern the program alone.
struct Settings {
  std::string method_name{default_method};
  ncp::Method method = find_method(default_method)->method;  ///< methods()' entry of that name, the options applied
  std::vector<lcp::Cell> basis{};                            ///< warm start: Result::basis of a nearby problem
  std::optional<int> solutions{};                            ///< several, by deflation: at most so many
  Output output{};
  int sideineq = 1;     ///< 1 accept side inequalities of a model, 2 refuse it for them
  bool verify = false;  ///< encloses what was found: ncp::verify
  int wantsol = 1;      ///< AMPL's bits; of them 8 (do not print the message) means something
};

/// The options that these settings have: of the method, each after what it depends on, and of the program.
ncp::Fields fields_of(Settings& settings);
/// PATH's output switches.
void describe(Output& output, ncp::Fields& fields);

/// A key of any method, or of the program.
struct Option {
  std::string_view key;
  std::string_view alias;  ///< empty: none
  std::string help;        ///< where the methods mean different things by it, each of them
  std::string takes;       ///< "a number > 0", "yes or no", "umfpack, klu or eigen"
  ncp::Method method;      ///< one that has it
};
std::span<const Option> options();
/// The options of PATH 4.7 (its manual, table of options).
std::span<const std::string_view> path_options();
/// Those of them that are accepted without effect.
std::span<const std::string_view> ignored_options();

/// Sets it to the value of `given`, whose key may be short for the field's. Notes a word that is taken as another one.
/// Throws InputError naming source, key, value and range for a value that makes no sense.
void set(const ncp::Field& field, const Assignment& given, std::vector<std::string>& notes);
/// The value, as it would be written; "-" where there is none to list: another option takes the effect away, or the
/// number exists with another choice only.
std::string value_text(const ncp::Field& field);

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
  std::optional<int> pivots{};       ///< minor_iteration_limit, if it is not the method's own
};
/// Starts from the defaults of the method named last and applies the assignments in the order of fields_of(), so that
/// what depends on another option finds it set; of several of one key the last one wins. Throws InputError naming
/// source, key, value and range for a value that makes no sense, for an ambiguous key, and for options that contradict
/// each other (ncp::invalid).
Applied apply_options(std::span<const Assignment> assignments, Unknown unknown = Unknown::Refuse);
/// Adds notes on what the size n of the problem takes from the options.
void note_limits_of_size(ncp::Index n, Applied& options);

}  // namespace perp::settings
