#pragma once
/// Integers out of JSON that somebody else may have written. Private to app/.
#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "app/program/program.hpp"
#include "app/text/json_parts.hpp"

namespace perp::app {

/// Json::get<int>() takes other numbers modulo 2^32 and, of doubles beyond an int, whatever: here these are refused.
/// Throws InputError naming `key`: no integer, or not in [least, most].
template <class Int>
Int json_integer(const Json& value, std::string_view key, Int least = std::numeric_limits<Int>::min(),
                 Int most = std::numeric_limits<Int>::max()) {
  if (!value.is_number_integer()) throw InputError(fmt::format("'{}' is no integer", key));
  const auto within = [&](auto number) {
    return std::cmp_less_equal(least, number) && std::cmp_less_equal(number, most);
  };
  if (value.is_number_unsigned() ? !within(value.get<std::uint64_t>()) : !within(value.get<std::int64_t>()))
    throw InputError(fmt::format("'{}' is not within {} and {}", key, least, most));
  return value.get<Int>();
}

}  // namespace perp::app
