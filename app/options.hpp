#pragma once
/// Options as people, option files and AMPL write them: key=value, with PATH's names where PATH has them. One table
/// says what each key sets; nothing else in the program knows an option by name.
///
/// A key may be shortened to any unique prefix and is read without regard to case. When a key is given more than once,
/// the last value wins; the order is: environment (AMPL only: perp_options, path_options, pathampl_options), options
/// file, then the command line from left to right.
#include <chrono>
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

/// What options set: a method with its fields, and a few things that concern the program alone.
struct Settings {
  std::string method_name{default_method};
  ncp::Method method = ncp::SemismoothNewton{};  ///< methods()' entry of that name, with the options applied
  bool output = true;                            ///< print the iteration table
  int sideineq = 1;                              ///< 1 accept side inequalities of a model, 2 refuse it for them
  int wantsol = 1;                               ///< AMPL's bits; of them 8 (do not print the message) means something
};

/// The place an option sets; monostate: it has no effect on the run's method.
using Field = std::variant<std::monostate, std::string*, double*, int*, unsigned*, bool*,
                           std::chrono::duration<double>*, lcp::LuBackend*, lcp::LemkeStart*, lcp::Cover*>;

struct Range {
  double low = 0;
  double high = lcp::infinity;
  bool open = false;  ///< the ends do not belong to it
};

struct Option {
  std::string_view key;
  std::vector<std::string_view> aliases;
  Range range;  ///< of numbers
  std::string_view help;
  Field (*field)(Settings& settings);
};

std::span<const Option> options();
/// PATH's options that are accepted without effect.
std::span<const std::string_view> ignored_options();

/// "a number > 0", "yes or no", "umfpack, klu or eigen": what the option takes.
std::string values_text(const Option& option);
/// The value in the field, as it would be written; "-" for monostate.
std::string value_text(const Field& field);

enum class Unknown {
  Refuse,  ///< an unknown key throws
  Report,  ///< an unknown key is listed in Applied::unknown
};

struct Applied {
  Settings settings;
  std::vector<std::string> notes;    ///< options without effect, and why
  std::vector<std::string> unknown;  ///< messages about unknown keys
};
/// Starts from the defaults of the method named last and applies the assignments in order. Throws InputError naming
/// source, key, value and range for a value that makes no sense, for an ambiguous key, and for options that contradict
/// each other (ncp::invalid).
Applied apply_options(std::span<const Assignment> assignments, Unknown unknown = Unknown::Refuse);

}  // namespace perp::app
