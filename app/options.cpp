#include "app/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <stdexcept>

#include "ncp/pivot_limit.hpp"

namespace perp::app {

// Values.

namespace {

constexpr double max_int = std::numeric_limits<int>::max();

constexpr auto synonym = Choice::Role::Synonym;
constexpr std::array bool_choices{
    Choice{"yes", 1},         Choice{"no", 0},           Choice{"true", 1, synonym}, Choice{"false", 0, synonym},
    Choice{"on", 1, synonym}, Choice{"off", 0, synonym}, Choice{"1", 1, synonym},    Choice{"0", 0, synonym}};

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
  for (const Choice& choice : choices)
    if (choice.role != synonym) names.push_back(choice.name);
  return names;
}

/// "a number > 0", "an integer in [1, 2]".
std::string range_text(const Range& range, bool integer) {
  const auto end = [](double value) { return value == max_int ? "2147483647" : fmt::format("{:g}", value); };
  const std::string what = integer ? "an integer" : "a number";
  if (range.high < (integer ? max_int : lcp::infinity))
    return fmt::format("{} in {}{}, {}{}", what, range.open ? '(' : '[', end(range.low), end(range.high),
                       range.open_high ? ')' : ']');
  return fmt::format("{} {} {}", what, range.open ? ">" : ">=", end(range.low));
}

/// What the option's field holds, whichever method has it.
Field any_field(const Option& option, Settings& settings) {
  Field field = option.field(settings);
  for (const MethodEntry& entry : methods()) {
    if (!std::holds_alternative<NoEffect>(field)) break;
    settings.method = entry.method;
    field = option.field(settings);
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

[[noreturn]] void refuse(const Assignment& given, const Option& option, std::span<const std::string_view> words = {}) {
  const std::string key = lower(given.key) == option.key ? given.key : fmt::format("{} ({})", given.key, option.key);
  throw InputError(fmt::format("{}: {} = {} is refused; it takes {}{}", given.source, key,
                               given.value.empty() ? "(nothing)" : given.value, values_text(option),
                               words.empty() ? "" : "." + did_you_mean(lower(given.value), words)));
}

template <class T>
T number_in_range(const Assignment& given, const Option& option) {
  T value{};
  if (!parse_number(given.value, value)) refuse(given, option);
  const auto x = static_cast<double>(value);
  const Range& range = option.range;
  const bool inside =
      (range.open ? x > range.low : x >= range.low) && (range.open_high ? x < range.high : x <= range.high);
  if (!inside) refuse(given, option);  // also a NaN
  return value;
}

const Choice& one_of(std::span<const Choice> choices, const Assignment& given, const Option& option) {
  const auto choice = std::ranges::find(choices, lower(given.value), &Choice::name);
  if (choice == choices.end()) {
    std::vector<std::string_view> words;
    for (const Choice& c : choices) words.push_back(c.name);
    refuse(given, option, words);
  }
  return *choice;
}

/// The first name of the value; "?" if it has none.
std::string_view word_of(std::span<const Choice> choices, int value) {
  const auto choice = std::ranges::find(choices, value, &Choice::value);
  return choice == choices.end() ? "?" : choice->name;
}

/// Sets the field. Pre: not NoEffect.
void set(const Field& field, const Assignment& given, const Option& option, Applied& result) {
  std::visit(
      [&](auto target) {
        using T = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string>) {
          const std::string name = lower(given.value);
          if (!method_named(name)) refuse(given, option, method_names());
          *target = name;
        } else if constexpr (std::is_same_v<T, double> || (std::is_integral_v<T> && !std::is_same_v<T, bool>)) {
          *target = number_in_range<T>(given, option);
        } else if constexpr (std::is_same_v<T, std::chrono::duration<double>>) {
          *target = T(number_in_range<double>(given, option));
        } else if constexpr (std::is_same_v<T, bool>) {
          *target = one_of(bool_choices, given, option).value != 0;
        } else if constexpr (std::is_same_v<T, DependentNumber>) {
          const auto value = number_in_range<double>(given, option);
          try {
            target.set(value);
          } catch (const std::invalid_argument& error) {
            throw InputError(
                fmt::format("{}: {} = {} is refused: {}", given.source, option.key, given.value, error.what()));
          }
        } else if constexpr (std::is_same_v<T, Word>) {
          const Choice& chosen = one_of(target.choices, given, option);
          target.set(chosen.value);
          if (chosen.role == Choice::Role::StandIn)
            result.notes.push_back(fmt::format("{}: {} = {} is taken as {}", given.source, option.key, chosen.name,
                                               word_of(target.choices, chosen.value)));
        }
      },
      field);
}

}  // namespace

std::string values_text(const Option& option) {
  Settings settings;
  return std::visit(
      [&](auto target) -> std::string {
        using T = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string>)
          return alternatives(method_names());
        else if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::chrono::duration<double>>)
          return range_text(option.range, false);
        else if constexpr (std::is_same_v<T, bool>)
          return "yes or no";
        else if constexpr (std::is_integral_v<T>)
          return range_text(option.range, true);
        else if constexpr (std::is_same_v<T, DependentNumber>)
          return std::string(target.range);
        else if constexpr (std::is_same_v<T, Word>)
          return alternatives(names_of(target.choices));
        else
          return "-";
      },
      any_field(option, settings));
}

std::string value_text(const Field& field) {
  return std::visit(
      [](auto target) -> std::string {
        using T = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string> || (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>))
          return fmt::format("{}", *target);
        else if constexpr (std::is_same_v<T, std::chrono::duration<double>>)
          return fmt::format("{}", target->count());
        else if constexpr (std::is_same_v<T, bool>)
          return *target ? "yes" : "no";
        else if constexpr (std::is_same_v<T, DependentNumber>)
          return target.get() ? fmt::format("{}", *target.get()) : "-";
        else if constexpr (std::is_same_v<T, Word>)
          return std::string(word_of(target.choices, target.get()));
        else
          return "-";
      },
      field);
}

bool has_value(const Field& field) {
  if (const auto* number = std::get_if<DependentNumber>(&field)) return number->get().has_value();
  return !std::holds_alternative<NoEffect>(field);
}

// Keys.

namespace {

struct Found {
  const Option* option = nullptr;
  std::string_view ignored;  // a key of ignored_options()
};

/// "maj_iter" of "major_iteration_limit": every word of the key begins the word in its place.
bool abbreviates(std::string_view key, std::string_view name) {
  while (!key.empty()) {
    const std::string_view part = key.substr(0, key.find('_'));
    if (part.empty() || name.empty() || !name.starts_with(part)) return false;
    key.remove_prefix(std::min(part.size() + 1, key.size()));
    const std::size_t next = name.find('_');
    name = next == std::string_view::npos ? std::string_view{} : name.substr(next + 1);
  }
  return true;
}

bool is_paths(std::string_view name) { return std::ranges::find(path_options(), name) != path_options().end(); }

/// The option a key names: exactly, or abbreviated, where PATH's options go before ours and those of as many words as
/// the key before longer ones. Throws InputError if the abbreviation is not unique.
Found find_option(const Assignment& given) {
  const std::string key = lower(given.key);
  if (key.empty()) return {};
  std::vector<std::pair<std::string_view, const Option*>> fits;
  const auto look = [&](std::string_view name, const Option* option) {
    if (abbreviates(key, name)) fits.emplace_back(name, option);
    return name == key;
  };
  for (const Option& option : options()) {
    if (look(option.key, &option)) return {&option, {}};
    for (const std::string_view alias : option.aliases)
      if (look(alias, &option)) return {&option, {}};
  }
  for (const std::string_view name : ignored_options())
    if (look(name, nullptr)) return {nullptr, name};
  if (std::ranges::any_of(fits, [](const auto& fit) { return is_paths(fit.first); }))
    std::erase_if(fits, [](const auto& fit) { return !is_paths(fit.first); });
  const auto words = [](std::string_view text) { return std::ranges::count(text, '_'); };
  if (std::ranges::any_of(fits, [&](const auto& fit) { return words(fit.first) == words(key); }))
    std::erase_if(fits, [&](const auto& fit) { return words(fit.first) != words(key); });
  if (fits.empty()) return {};
  const auto [name, option] = fits.front();
  if (std::ranges::all_of(fits, [&](const auto& fit) {
        return fit.first == fits.front().first || (fit.second != nullptr && fit.second == fits.front().second);
      }))
    return {option, option == nullptr ? name : std::string_view{}};
  std::vector<std::string_view> names(fits.size());
  std::ranges::transform(fits, names.begin(), [](const auto& fit) { return fit.first; });
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
      set(found.option->field(result.settings), given, *found.option, result);
    else if (found.option != nullptr)
      fields.emplace_back(found.option, &given);
    else if (!found.ignored.empty())
      ignored.push_back(found.ignored);
    else if (unknown == Unknown::Refuse)
      throw UnknownOption(unknown_key(given) + " 'perp methods' lists them all.");
    else
      result.unknown.push_back(unknown_key(given));
  }
  Settings& settings = result.settings;
  settings.method = *method_named(settings.method_name);
  std::ranges::stable_sort(fields, {}, [](const auto& field) { return field.first; });
  for (const auto& [option, given] : fields) {
    const Field field = option->field(settings);
    if (const auto* none = std::get_if<NoEffect>(&field)) {
      Settings other = settings;  // the value is checked all the same
      if (const Field elsewhere = any_field(*option, other); !std::holds_alternative<DependentNumber>(elsewhere))
        set(elsewhere, *given, *option, result);
      result.notes.push_back(fmt::format("{}: {} has no effect on method {}{}", given->source, option->key,
                                         settings.method_name,
                                         none->because.empty() ? "" : fmt::format(" with {}", none->because)));
    } else {
      set(field, *given, *option, result);
    }
  }
  if (!ignored.empty())
    result.notes.push_back(fmt::format("accepted, but without effect in this version: {}", fmt::join(ignored, ", ")));
  if (const auto why = ncp::invalid(settings.method)) throw InputError(*why);
  return result;
}

void note_limits_of_size(ncp::Index n, Applied& options) {
  const auto pivots = [](const ncp::Method& method) -> std::optional<int> {
    if (const ncp::PathSearch* path = ncp::path_of(method)) return path->lemke.max_pivots;
    if (const auto* josephy = std::get_if<ncp::NewtonJosephy>(&method)) return josephy->lemke.max_pivots;
    if (const auto* robinson = std::get_if<ncp::NewtonRobinson>(&method)) return robinson->lemke.max_pivots;
    return std::nullopt;  // the affine methods take the limit as it is
  };
  const std::optional<int> given = pivots(options.settings.method);
  const int most = ncp::worthwhile_pivots(n);
  if (!given || *given <= most || given == pivots(*method_named(options.settings.method_name))) return;
  options.notes.push_back(fmt::format(
      "minor_iteration_limit = {} is taken as {}, which is 1000 + 20 n: a longer path leads nowhere", *given, most));
}

}  // namespace perp::app
