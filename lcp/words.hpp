// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small things that several folders write tables and visits with. Private to Perp.
#include <algorithm>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace perp {

/// The word of a value in a table of {value, word}; "?" if it has none.
template <class Value, std::size_t n>
constexpr std::string_view word_of(Value value, const std::pair<Value, std::string_view> (&table)[n]) {
  const auto* found = std::ranges::find(table, value, &std::pair<Value, std::string_view>::first);
  return found == table + n ? "?" : found->second;
}

/// What streams make of the parts, one after the other.
template <class... Parts>
std::string text_of(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// "1 iteration", "3 iterations".
inline std::string quantity(long long n, std::string_view noun) { return text_of(n, ' ', noun, n == 1 ? "" : "s"); }

/// Throws std::invalid_argument saying that.
template <class... Parts>
[[noreturn]] void refuse_input(const Parts&... parts) {
  throw std::invalid_argument(text_of(parts...));
}

/// Functions of several types as one, for std::visit.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace perp
