// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options described once. Beside each struct of options stands an ordinary function describe(Options&, Fields&), which
/// gives every option its key, range and meaning. The rest follows from that at run time: whether a method makes sense
/// (invalid), key=value of the program, AMPL and option files, the options in force as JSON, the help.
#include <algorithm>
#include <chrono>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "lcp/types.hpp"

namespace perp {

struct Range {
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
  bool open_low = false;  ///< the end does not belong to it
  bool open_high = false;

  bool has(double x) const { return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high); }
};
// Finite numbers.
constexpr Range at_least(double low) { return {.low = low, .open_high = true}; }
constexpr Range above(double low) { return {.low = low, .open_low = true, .open_high = true}; }
constexpr Range between(double low, double high) { return {.low = low, .high = high}; }
constexpr Range strictly_between(double low, double high) {
  return {.low = low, .high = high, .open_low = true, .open_high = true};
}
constexpr Range above_up_to(double low, double high) { return {.low = low, .high = high, .open_low = true}; }

/// One of a few words, each for a value. A second word of one value is taken, with a note that says so.
struct Words {
  std::vector<std::pair<std::string_view, int>> words;
  std::function<int()> get;
  std::function<void(int)> set;
};
/// Yes or no, kept elsewhere than in a bool.
struct Flag {
  std::function<bool()> get;
  std::function<void(bool)> set;
};
/// A number that exists, and whose range is known, only where another option has made its choice.
struct Parameter {
  std::function<std::optional<double>()> get;
  std::function<void(double)> set;  ///< throws std::invalid_argument, saying why, for a value that makes no sense
};
using Seconds = std::chrono::duration<double>;
/// The place that an option sets; a string takes names that only the caller knows.
using Target =
    std::variant<double*, int*, unsigned*, lcp::Index*, Seconds*, bool*, Words, Flag, Parameter, std::string*>;

struct Field {
  std::string_view key;
  std::string_view alias;  ///< another key; empty: none
  std::string_view help;   ///< empty: no option of the program, only checked
  Target target;
  Range range{};               ///< of numbers
  std::string_view inert{};    ///< the value of another option that takes the effect away: "nms = no"
  std::vector<Target> also{};  ///< places of the same option in other parts of a method, set with it
};
/// "a number > 0", "yes or no", "umfpack, klu or eigen".
std::string takes(const Field& field);
/// "umfpack, klu or eigen"
std::string alternatives(const std::vector<std::string_view>& words);

class Fields {
 public:
  enum class Purpose { Describe, Check };
  /// Check: invalid() is all that is asked, and nothing is kept for the rest. A key that is added once more, by another
  /// part of a method, is the same option there (Field::also) if it has the same value; a part whose value differs was
  /// given its own. The part in which its words stand for more values is the one that is shown.
  explicit Fields(Purpose purpose = Purpose::Describe) : checking_(purpose == Purpose::Check) {}

  void add(std::string_view key, Target number, const Range& range, std::string_view help, std::string_view alias = {});
  void add(std::string_view key, Target target, std::string_view help, std::string_view alias = {});
  /// An enumeration. What depends on the choice is described after it.
  template <class E>
  void choice(std::string_view key, E* choice, std::initializer_list<std::pair<std::string_view, E>> names,
              std::string_view help) {
    if (checking_) return;  // every enumerator makes sense
    Words words{
        {}, [choice] { return static_cast<int>(*choice); }, [choice](int value) { *choice = static_cast<E>(value); }};
    for (const auto& [name, value] : names) words.words.emplace_back(name, static_cast<int>(value));
    add(key, Target(std::move(words)), help);
  }
  /// One of a catalogue by its name.
  template <class T>
  void choice(std::string_view key, T* chosen, std::span<const T> all, std::string_view help) {
    if (checking_) return;
    Words words{
        {},
        [chosen, all] { return static_cast<int>(std::ranges::find(all, chosen->name, &T::name) - all.begin()); },
        [chosen, all](int place) { *chosen = all[static_cast<std::size_t>(place)]; }};
    for (const T& one : all) words.words.emplace_back(one.name, static_cast<int>(words.words.size()));
    add(key, Target(std::move(words)), help);
  }
  /// Those that `described` adds have an effect only if `effect`; else `because`, "nms = no", takes it away.
  template <class Described>
  void when(bool effect, std::string_view because, const Described& described) {
    const std::string_view outer = inert_;
    if (!effect && outer.empty()) inert_ = because;
    described();
    inert_ = outer;
  }

  /// Only checked from now on: no option of the program.
  void hide(std::string_view key);
  bool checking() const { return checking_; }

  // What a range cannot say.
  void check(bool holds, std::string_view why);
  void check(bool holds, std::string_view key, double value, std::string_view must_be);

  /// But for those that are only checked.
  std::vector<Field> options() const;
  const Field* find(std::string_view key) const;  ///< of options(); nullptr if there is none
  /// Why a value makes no sense, with its key, if one does not.
  std::optional<std::string> invalid() const;

 private:
  /// Adds another place of an option.
  static void join(Field& field, Field other);

  std::vector<Field> all_;
  std::unordered_map<std::string_view, std::size_t> place_;  // of each key in all_
  bool checking_;
  std::string_view inert_;
  std::string bad_number_;  // where checking
  std::string complaint_;
};

/// Throws std::invalid_argument, beginning with `who`, for options that make no sense.
template <class Options>
void refuse_invalid(const std::string& who, Options options) {
  Fields fields(Fields::Purpose::Check);
  describe(options, fields);
  if (const auto why = fields.invalid()) throw std::invalid_argument(who + ": " + *why);
}

}  // namespace perp
