// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Structs as JSON objects, by one list of keys that serves writing and reading:
///
///     struct Row {
///       std::string name{};
///       int steps = -1;
///       static void fields(auto& f, auto& row) {
///         f("name", row.name);
///         f.count("steps", row.steps);
///       }
///     };
///
/// json_of(row) is {"name": ..., "steps": ...}, and row_of<Row>() reads it back. Private to app/.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/program/program.hpp"
#include "app/text/json_parts.hpp"

namespace perp::app {

/// Json::get<int>() takes other numbers modulo 2^32 and, of doubles beyond an int, whatever: here these are refused.
/// Throws InputError naming `key`: no integer, or not in [least, most].
template <class Int>
Int json_integer(const Json& value, std::string_view key, Int least = std::numeric_limits<Int>::min(),
                 Int most = std::numeric_limits<Int>::max()) {
  if (!value.is_number_integer()) throw input_error("'{}' is no integer", key);
  const auto within = [&](auto number) {
    return std::cmp_less_equal(least, number) && std::cmp_less_equal(number, most);
  };
  if (value.is_number_unsigned() ? !within(value.get<std::uint64_t>()) : !within(value.get<std::int64_t>()))
    throw input_error("'{}' is not within {} and {}", key, least, most);
  return value.get<Int>();
}

/// A number as json_number() and json_known() write it; null is NaN. Throws InputError naming `key`.
double json_real(const Json& value, std::string_view key);
/// What a text holds. Throws InputError: no JSON, or no object.
Json json_object(std::string_view text);
/// What the object has under `key`. Throws InputError if that is nothing.
const Json& json_member(const Json& object, const char* key);
/// In one line without spaces; bytes that are no UTF-8 are replaced.
std::string line_of(const Json& json);
/// A value as a field of CSV, not quoted: null is empty, and truth is yes or no.
std::string field_text(const Json& value);

template <class T>
Json json_of(const T& value);
template <class T>
void read_json(const Json& value, std::string_view key, T& target);

class JsonWriter {
 public:
  explicit JsonWriter(Json begun = Json::object()) : json(std::move(begun)) {}

  /// `range`: least and most that are read.
  template <class T>
  void operator()(const char* key, const T& value, auto... /*range*/) {
    json[key] = json_of(value);
  }
  /// Negative: not known, null.
  void count(const char* key, long n) { json[key] = n < 0 ? Json(nullptr) : Json(n); }
  /// NaN: not known, null.
  void known(const char* key, double value) { json[key] = json_known(value); }
  /// Zero is that word.
  void or_zero(const char* key, int n, const char* word) { json[key] = n == 0 ? Json(word) : Json(n); }
  /// Left out if it is empty.
  void optional(const char* key, const std::string& text) {
    if (!text.empty()) json[key] = text;
  }
  /// Follows from the others: is not read.
  template <class T>
  void derived(const char* key, const T& value) {
    json[key] = value;
  }
  /// An enumerator, by the names of all.
  template <class Enum>
  void word(const char* key, Enum value, std::span<const std::string_view> names) {
    json[key] = names[static_cast<std::size_t>(value)];
  }
  /// An object of texts.
  void pairs(const char* key, const std::vector<std::pair<std::string, std::string>>& all) {
    Json& object = json[key] = Json::object();
    for (const auto& [name, value] : all) object[name] = value;
  }

  Json json;
};

/// The same list of keys, read. All of it throws InputError naming the key: missing, or of another type.
class JsonReader {
 public:
  explicit JsonReader(const Json& json) : json_(json) {}

  template <class T>
  void operator()(const char* key, T& value) {
    read_json(json_member(json_, key), key, value);
  }
  template <class Int>
  void operator()(const char* key, Int& value, Int least, Int most = std::numeric_limits<Int>::max()) {
    value = json_integer(json_member(json_, key), key, least, most);
  }
  template <class Int>
  void count(const char* key, Int& n) {
    const Json& value = json_member(json_, key);
    n = value.is_null() ? -1 : json_integer<Int>(value, key);
  }
  void known(const char* key, double& value) { (*this)(key, value); }
  void or_zero(const char* key, int& n, const char* /*word*/) {
    const Json& value = json_member(json_, key);
    n = value.is_string() ? 0 : json_integer(value, key, 0);
  }
  void optional(const char* key, std::string& text) {
    if (json_.contains(key)) (*this)(key, text);
  }
  template <class T>
  void derived(const char* /*key*/, const T& /*value*/) {}
  template <class Enum>
  void word(const char* key, Enum& value, std::span<const std::string_view> names) {
    std::string name;
    (*this)(key, name);
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) throw input_error("'{}' is no {}", name, key);
    value = static_cast<Enum>(found - names.begin());
  }
  void pairs(const char* key, std::vector<std::pair<std::string, std::string>>& all) {
    for (const auto& [name, value] : json_member(json_, key).items())
      read_json(value, name, all.emplace_back(name, "").second);
  }

 private:
  const Json& json_;
};

template <class T>
Json json_of(const T& value) {
  if constexpr (std::is_same_v<T, double>) {
    return json_number(value);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    return value;
  } else if constexpr (requires { value.begin(); }) {
    Json array = Json::array();
    for (const auto& item : value) array.push_back(json_of(item));
    return array;
  } else {
    JsonWriter writer;
    T::fields(writer, value);
    return writer.json;
  }
}

template <class T>
void read_json(const Json& value, std::string_view key, T& target) {
  const auto check = [key](bool fits, const char* otherwise) {
    if (!fits) throw input_error("'{}' is {}", key, otherwise);
  };
  if constexpr (std::is_same_v<T, bool>) {
    check(value.is_boolean(), "neither true nor false");
    target = value.get<bool>();
  } else if constexpr (std::is_integral_v<T>) {
    target = json_integer<T>(value, key);
  } else if constexpr (std::is_same_v<T, double>) {
    target = json_real(value, key);
  } else if constexpr (std::is_same_v<T, std::string>) {
    check(value.is_string(), "no text");
    target = value.get<std::string>();
  } else if constexpr (requires { target.emplace_back(); }) {
    check(value.is_array(), "no array");
    for (const Json& item : value) read_json(item, key, target.emplace_back());
  } else {
    check(value.is_object(), "no object");
    JsonReader reader(value);
    T::fields(reader, target);
  }
}

template <class T>
T row_of(const Json& object) {
  T row;
  read_json(object, "it", row);
  return row;
}

}  // namespace perp::app
