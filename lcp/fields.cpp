// SPDX-License-Identifier: Apache-2.0
#include "lcp/fields.hpp"

#include <iterator>
#include <type_traits>

#include "lcp/words.hpp"

namespace perp {
namespace {

/// Options of auto and of the program: 72.
constexpr std::size_t of_auto = 80;

/// "a number > 0", "an integer in [1, 2]".
std::string range_text(const Range& range, bool integer) {
  const std::string what = integer ? "an integer " : "a number ";
  if (range.high < (integer ? std::numeric_limits<int>::max() : std::numeric_limits<double>::infinity()))
    return text_of(what, "in ", range.open_low ? '(' : '[', range.low, ", ", range.high, range.open_high ? ')' : ']');
  return text_of(what, range.open_low ? "> " : ">= ", range.low);
}

/// Of a number that is out of its range.
std::optional<double> bad_number(const Target& number, const Range& range) {
  return std::visit(
      [&](const auto& target) -> std::optional<double> {
        using T = std::remove_cvref_t<decltype(target)>;
        if constexpr (std::is_same_v<T, Seconds*>) {  // a run within another one may have no time left
          if (!(target->count() >= 0)) return target->count();
        } else if constexpr (std::is_arithmetic_v<std::remove_pointer_t<T>> && !std::is_same_v<T, bool*>) {
          if (const auto value = static_cast<double>(*target); !range.has(value)) return value;
        }
        return std::nullopt;
      },
      number);
}

bool same_value(const Target& a, const Target& b) {
  return std::visit(
      [&](const auto& one) {
        using T = std::remove_cvref_t<decltype(one)>;
        const T* other = std::get_if<T>(&b);
        if (other == nullptr) return false;
        if constexpr (std::is_pointer_v<T>)
          return *one == **other;
        else
          return one.get() == other->get();
      },
      a);
}

/// How many values the words of an option stand for.
std::size_t meanings(const Target& target) {
  const auto* words = std::get_if<Words>(&target);
  if (words == nullptr) return 0;
  const auto& all = words->words;
  std::size_t first_of_value = 0;
  for (auto word = all.begin(); word != all.end(); ++word)
    first_of_value += std::none_of(all.begin(), word, [&](const auto& other) { return other.second == word->second; });
  return first_of_value;
}

/// "tol is -1; it takes a number > 0"; empty where there is nothing to complain of.
std::string complaint_of(const Field& field) {
  const auto value = bad_number(field.target, field.range);
  return value ? text_of(field.key, " is ", *value, "; it takes ", takes(field)) : std::string();
}

}  // namespace

std::string alternatives(const std::vector<std::string_view>& words) {
  std::string all;
  for (std::size_t k = 0; k < words.size(); ++k)
    all += text_of(k == 0 ? "" : (k + 1 == words.size() ? " or " : ", "), words[k]);
  return all;
}

std::string takes(const Field& field) {
  return std::visit(
      [&](const auto& target) -> std::string {
        using T = std::remove_cvref_t<decltype(target)>;
        if constexpr (std::is_same_v<T, bool*> || std::is_same_v<T, Flag>) {
          return "yes or no";
        } else if constexpr (std::is_same_v<T, Words>) {
          std::vector<std::string_view> names;
          for (const auto& word : target.words) names.push_back(word.first);
          return alternatives(names);
        } else if constexpr (std::is_same_v<T, Parameter>) {
          return "a number in the function's range";
        } else if constexpr (std::is_same_v<T, std::string*>) {
          return "a name";
        } else {
          return range_text(field.range, !std::is_same_v<T, double*> && !std::is_same_v<T, Seconds*>);
        }
      },
      field.target);
}

void Fields::add(std::string_view key, Target number, const Range& range, std::string_view help,
                 std::string_view alias) {
  if (checking_) {
    if (bad_number_.empty() && bad_number(number, range))
      bad_number_ = complaint_of({key, alias, help, std::move(number), range, inert_, {}});
    return;
  }
  Field field{key, alias, help, std::move(number), range, inert_};
  const auto [known, is_new] = place_.try_emplace(key, all_.size());
  if (all_.empty()) all_.reserve(of_auto);
  if (is_new)
    all_.push_back(std::move(field));
  else
    join(all_[known->second], std::move(field));
}

void Fields::join(Field& field, Field other) {
  if (!other.inert.empty()) return;  // it would change nothing there
  if (!field.inert.empty()) return std::swap(field, other);
  const bool same = same_value(field.target, other.target);
  if (meanings(other.target) > meanings(field.target)) {  // its words say more
    std::swap(field, other);
    if (same) field.also = std::move(other.also);
  }
  if (same) field.also.push_back(std::move(other.target));
}

void Fields::add(std::string_view key, Target target, std::string_view help, std::string_view alias) {
  add(key, std::move(target), Range{}, help, alias);
}

void Fields::hide(std::string_view key) {
  for (Field& field : all_)
    if (field.key == key) field.help = {};
}

void Fields::check(bool holds, std::string_view why) {
  if (!holds && complaint_.empty()) complaint_ = why;
}

void Fields::check(bool holds, std::string_view key, double value, std::string_view must_be) {
  if (!holds) check(false, text_of(key, " is ", value, "; it must be ", must_be));
}

std::vector<Field> Fields::options() const {
  std::vector<Field> options;
  std::ranges::copy_if(all_, std::back_inserter(options), [](const Field& field) { return !field.help.empty(); });
  return options;
}

const Field* Fields::find(std::string_view key) const {
  const auto found = place_.find(key);
  return found == place_.end() || all_[found->second].help.empty() ? nullptr : &all_[found->second];
}

std::optional<std::string> Fields::invalid() const {
  for (const Field& field : all_)
    if (std::string why = complaint_of(field); !why.empty()) return why;
  if (!bad_number_.empty()) return bad_number_;
  return complaint_.empty() ? std::nullopt : std::optional(complaint_);
}

}  // namespace perp
