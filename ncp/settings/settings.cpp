// SPDX-License-Identifier: Apache-2.0
#include "ncp/settings/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <tuple>

#include "ncp/path/pivot_limit.hpp"

namespace perp::settings {

namespace {

/// Those of the program alone.
void describe(Settings& settings, ncp::Fields& f) {
  f.add("verify", &settings.verify,
        "prove by interval arithmetic that exactly one solution is near the point found, and how near");
  f.add("sideineq", &settings.sideineq, ncp::between(1, 2),
        "a model's side inequalities: 1 accepts them, with an extra variable each; 2 refuses the model");
  f.add("wantsol", &settings.wantsol, ncp::between(0, 15),
        "AMPL's: 8 does not print the closing message (the .sol file is written whatever the value)");
  describe(settings.output, f);
}

/// What the methods mean by a key; where that differs, each by its name.
struct Meanings {
  std::vector<std::pair<std::string_view, std::vector<std::string>>> texts;

  void add(std::string_view text, const std::string& method) {
    auto known = std::ranges::find(texts, text, [](const auto& one) { return one.first; });
    if (known == texts.end()) known = texts.insert(texts.end(), {text, {}});
    if (std::ranges::find(known->second, method) == known->second.end()) known->second.push_back(method);
  }
  std::string all() const {
    if (texts.size() == 1) return std::string(texts[0].first);
    std::string result;
    for (const auto& [text, methods] : texts)
      result += fmt::format("{}{}: {}", result.empty() ? "" : "; ", fmt::join(methods, ", "), text);
    return result;
  }
};

std::vector<Option> all_options() {
  std::vector<Option> all{{.key = "method",
                           .alias = {},
                           .help = "the method that runs; the other options apply to it, whatever their order",
                           .takes = ncp::alternatives(method_names()),
                           .method = {}}};
  std::vector<Meanings> meanings(1);
  for (const MethodEntry& entry : methods()) {
    ncp::Method method = entry.method;
    ncp::Fields fields;
    ncp::describe(method, fields);
    for (const ncp::Field& field : fields.options()) {
      auto known = std::ranges::find(all, field.key, &Option::key);
      if (known == all.end()) {
        known = all.insert(all.end(), {field.key, field.alias, "", takes(field), entry.method});
        meanings.emplace_back();
      }
      meanings[static_cast<std::size_t>(known - all.begin())].add(field.help, ncp::name(method));
    }
  }
  for (std::size_t k = 1; k < all.size(); ++k) all[k].help = meanings[k].all();
  Settings settings;
  ncp::Fields own;
  describe(settings, own);
  for (const ncp::Field& field : own.options())
    all.push_back({field.key, field.alias, std::string(field.help), takes(field), settings.method});
  return all;
}

}  // namespace

namespace {

void describe_method_name(Settings& settings, ncp::Fields& fields) {
  fields.add("method", &settings.method_name, "the method that runs");
}

}  // namespace

ncp::Fields fields_of(Settings& settings) {
  ncp::Fields fields;
  describe_method_name(settings, fields);
  ncp::describe(settings.method, fields);
  describe(settings, fields);
  return fields;
}

std::span<const Option> options() {
  static const std::vector<Option> table = all_options();
  return table;
}

// Values.

namespace {

/// A number's text without the '+' that from_chars does not take.
template <class T>
bool parse_number(std::string_view text, T& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

[[noreturn]] void refuse(const Assignment& given, std::string_view option, std::string_view takes,
                         std::span<const std::string_view> words = {}) {
  const std::string key = lowercase(given.key) == option ? given.key : fmt::format("{} ({})", given.key, option);
  throw input_error("{}: {} = {} is refused; it takes {}{}", given.source, key,
                    given.value.empty() ? "(nothing)" : given.value, takes,
                    words.empty() ? "" : "." + did_you_mean(lowercase(given.value), words));
}

template <class T>
T number_in_range(const Assignment& given, const ncp::Field& field) {
  T value{};
  if (!parse_number(given.value, value) || !field.range.has(static_cast<double>(value)))
    refuse(given, field.key, takes(field));
  return value;
}

bool yes_or_no(const Assignment& given, const ncp::Field& field) {
  const std::string word = lowercase(given.value);
  for (const char* yes : {"yes", "true", "on", "1"})
    if (word == yes) return true;
  for (const char* no : {"no", "false", "off", "0"})
    if (word == no) return false;
  refuse(given, field.key, takes(field), std::array<std::string_view, 6>{"yes", "no", "true", "false", "on", "off"});
}

/// The first name of the value; "?" if it has none.
std::string_view word_of(const ncp::Words& words) {
  const auto found = std::ranges::find(words.words, words.get(), [](const auto& word) { return word.second; });
  return found == words.words.end() ? "?" : found->first;
}

void set_word(const ncp::Words& words, const ncp::Field& field, const Assignment& given,
              std::vector<std::string>& notes) {
  const auto name = [](const auto& word) { return word.first; };
  const auto chosen = std::ranges::find(words.words, lowercase(given.value), name);
  if (chosen == words.words.end()) {
    std::vector<std::string_view> names(words.words.size());
    std::ranges::transform(words.words, names.begin(), name);
    refuse(given, field.key, takes(field), names);
  }
  words.set(chosen->second);
  if (word_of(words) != chosen->first)
    notes.push_back(fmt::format("{}: {} = {} is taken as {}", given.source, field.key, chosen->first, word_of(words)));
}

}  // namespace

namespace {

void set_at(const ncp::Target& place, const ncp::Field& field, const Assignment& given,
            std::vector<std::string>& notes) {
  std::visit(
      [&](const auto& target) {
        using T = std::remove_cvref_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string*>) {
          const std::string name = lowercase(given.value);
          if (!method_named(name)) refuse(given, field.key, ncp::alternatives(method_names()), method_names());
          *target = name;
        } else if constexpr (std::is_same_v<T, bool*>) {
          *target = yes_or_no(given, field);
        } else if constexpr (std::is_same_v<T, ncp::Flag>) {
          target.set(yes_or_no(given, field));
        } else if constexpr (std::is_same_v<T, ncp::Words>) {
          set_word(target, field, given, notes);
        } else if constexpr (std::is_same_v<T, ncp::Seconds*>) {
          *target = ncp::Seconds(number_in_range<double>(given, field));
        } else if constexpr (std::is_same_v<T, ncp::Parameter>) {
          const auto value = number_in_range<double>(given, field);
          try {
            target.set(value);
          } catch (const std::invalid_argument& error) {
            throw input_error("{}: {} = {} is refused: {}", given.source, field.key, given.value, error.what());
          }
        } else {
          *target = number_in_range<std::remove_pointer_t<T>>(given, field);
        }
      },
      place);
}

}  // namespace

void set(const ncp::Field& field, const Assignment& given, std::vector<std::string>& notes) {
  set_at(field.target, field, given, notes);
  std::vector<std::string> said_already;
  for (const ncp::Target& place : field.also) set_at(place, field, given, said_already);
}

std::string value_text(const ncp::Field& field) {
  if (!field.inert.empty()) return "-";
  return std::visit(
      [](const auto& target) -> std::string {
        using T = std::remove_cvref_t<decltype(target)>;
        if constexpr (std::is_same_v<T, ncp::Words>)
          return std::string(word_of(target));
        else if constexpr (std::is_same_v<T, bool*>)
          return *target ? "yes" : "no";
        else if constexpr (std::is_same_v<T, ncp::Flag>)
          return target.get() ? "yes" : "no";
        else if constexpr (std::is_same_v<T, ncp::Parameter>)
          return target.get() ? fmt::format("{}", *target.get()) : "-";
        else if constexpr (std::is_same_v<T, ncp::Seconds*>)
          return fmt::format("{}", target->count());
        else
          return fmt::format("{}", *target);
      },
      field.target);
}

// Keys.

namespace {

struct Found {
  std::string_view key{};               ///< of the option; empty: there is none
  const ncp::Method* method = nullptr;  ///< one that has it
  std::string part{};                   ///< of the method, that the key names; empty: all of it
  std::string_view ignored{};           ///< a key of ignored_options()
};

/// An option of the program or of its default method, by its whole name: most are, and the table of all options takes
/// as long as a small problem.
Found find_at_once(std::string_view key) {
  static const std::vector<std::string_view> keys = [] {
    Settings settings;
    std::vector<std::string_view> names;
    for (const ncp::Field& field : fields_of(settings).options()) names.push_back(field.key);
    return names;
  }();
  const auto known = std::ranges::find(keys, key);
  return known == keys.end() ? Found{} : Found{.key = *known, .method = &find_method(default_method)->method};
}

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
  const std::string key = lowercase(given.key);
  if (key.empty()) return {};
  if (const std::size_t dot = key.rfind('.'); dot != std::string::npos) {
    Found found = find_option({key.substr(dot + 1), given.value, given.source});
    found.part = key.substr(0, dot);
    return found;
  }
  if (const Found found = find_at_once(key); !found.key.empty()) return found;
  const auto found = [](const Option& option) { return Found{.key = option.key, .method = &option.method}; };
  std::vector<std::pair<std::string_view, const Option*>> fits;
  const auto look = [&](std::string_view name, const Option* option) {
    if (abbreviates(key, name)) fits.emplace_back(name, option);
    return name == key;
  };
  for (const Option& option : options()) {
    if (look(option.key, &option)) return found(option);
    if (!option.alias.empty() && look(option.alias, &option)) return found(option);
  }
  for (const std::string_view name : ignored_options())
    if (look(name, nullptr)) return {.ignored = name};
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
    return option == nullptr ? Found{.ignored = name} : found(*option);
  std::vector<std::string_view> names(fits.size());
  std::ranges::transform(fits, names.begin(), [](const auto& fit) { return fit.first; });
  throw input_error("{}: '{}' is ambiguous: {}", given.source, given.key, ncp::alternatives(names));
}

std::string unknown_key(const Assignment& given) {
  std::vector<std::string_view> names;
  for (const Option& option : options()) {
    names.push_back(option.key);
    if (!option.alias.empty()) names.push_back(option.alias);
  }
  return fmt::format("{}: there is no option '{}'.{}", given.source, given.key, did_you_mean(given.key, names));
}

/// Sets it in the parts of the method that it names.
void apply_to_parts(const Found& option, const Assignment& given, Applied& result) {
  const std::vector<ncp::Method*> parts = ncp::parts_named(result.settings.method, option.part);
  if (parts.empty())
    throw input_error("{}: {}: method {} has no part '{}'", given.source, given.key, result.settings.method_name,
                      option.part);
  const Assignment inner{given.key.substr(given.key.rfind('.') + 1), given.value, given.source};
  bool done = false;
  for (ncp::Method* part : parts) {
    ncp::Fields fields;
    ncp::describe(*part, fields);
    const ncp::Field* field = fields.find(option.key);
    if (field == nullptr || !field->inert.empty()) continue;
    set(*field, inner, result.notes);
    done = true;
  }
  if (!done) result.notes.push_back(fmt::format("{}: {} has no effect on {}", given.source, option.key, option.part));
}

void apply_method(const Assignment& given, Applied& result) {
  ncp::Fields fields;
  describe_method_name(result.settings, fields);
  set(*fields.find("method"), given, result.notes);
}

/// Sets it; where the settings have it not, or another option takes its effect away, that is noted. `fields` are those
/// of the settings, or none yet: real numbers change none of them, the others may.
void apply(const Found& option, const Assignment& given, std::optional<ncp::Fields>& fields, Applied& result) {
  if (!option.part.empty()) return apply_to_parts(option, given, result);
  if (!fields) fields = fields_of(result.settings);
  const ncp::Field* field = fields->find(option.key);
  if (field != nullptr && field->inert.empty()) {
    set(*field, given, result.notes);
    const bool real =
        std::holds_alternative<double*>(field->target) || std::holds_alternative<ncp::Seconds*>(field->target);
    if (!real) fields.reset();
    return;
  }
  Settings other = result.settings;  // the value is checked all the same
  if (field == nullptr) other.method = *option.method;
  const ncp::Fields others = fields_of(other);
  if (const ncp::Field& there = *others.find(option.key); !std::holds_alternative<ncp::Parameter>(there.target))
    set(there, given, result.notes);
  result.notes.push_back(fmt::format("{}: {} has no effect on method {}{}", given.source, option.key,
                                     result.settings.method_name,
                                     field == nullptr ? "" : fmt::format(" with {}", field->inert)));
}

}  // namespace

namespace {

std::optional<int> pivots_of(ncp::Method method) {
  ncp::Fields fields;
  ncp::describe(method, fields);
  const ncp::Field* field = fields.find("minor_iteration_limit");
  return field == nullptr ? std::nullopt : std::optional(*std::get<int*>(field->target));
}

}  // namespace

Applied apply_options(std::span<const Assignment> assignments, Unknown unknown) {
  Applied result;
  Settings& settings = result.settings;
  std::vector<std::pair<Found, const Assignment*>> given_options;
  std::vector<std::string_view> ignored;
  for (const Assignment& given : assignments) {
    const Found found = find_option(given);
    if (found.key == "method" && found.part.empty())
      apply_method(given, result);
    else if (!found.key.empty())
      given_options.emplace_back(found, &given);
    else if (!found.ignored.empty())
      ignored.push_back(found.ignored);
    else if (unknown == Unknown::Refuse)
      throw UnknownOption(unknown_key(given) + " 'perp methods' lists them all.");
    else
      result.unknown.push_back(unknown_key(given));
  }
  settings.method = *method_named(settings.method_name);
  if (!given_options.empty()) {
    std::optional<ncp::Fields> fields = fields_of(settings);
    // Values for a part are set after those for all, and so win.
    const auto place = [&](const auto& one) {  // in the order of the fields, others last
      const ncp::Field* field = fields->find(one.first.key);
      return std::tuple(!one.first.part.empty(), field == nullptr, field);
    };
    std::ranges::stable_sort(given_options, {}, place);
    for (const auto& [option, given] : given_options) apply(option, *given, fields, result);
  }
  if (!ignored.empty())
    result.notes.push_back(fmt::format("accepted, but without effect in this version: {}", fmt::join(ignored, ", ")));
  if (const auto why = ncp::invalid(settings.method)) throw InputError(*why);
  const bool limits_pivots =
      std::ranges::any_of(given_options, [](const auto& one) { return one.first.key == "minor_iteration_limit"; });
  if (limits_pivots && !std::holds_alternative<ncp::Affine>(settings.method))  // they take the limit as it is
    if (const auto pivots = pivots_of(settings.method); pivots != pivots_of(*method_named(settings.method_name)))
      result.pivots = pivots;
  return result;
}

void note_limits_of_size(ncp::Index n, Applied& options) {
  const int most = ncp::worthwhile_pivots(n);
  if (!options.pivots || *options.pivots <= most) return;
  options.notes.push_back(
      fmt::format("minor_iteration_limit = {} is taken as {}, which is 1000 + 20 n: a longer path leads nowhere",
                  *options.pivots, most));
}

}  // namespace perp::settings
