// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Input that somebody can mend, and words that may have been meant.
#include <fmt/format.h>

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace perp::settings {

/// Input that is refused; what() names the file, key or value and says why.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The same in fmt's words.
template <class... T>
InputError input_error(fmt::format_string<T...> text, T&&... parts) {
  return InputError(fmt::format(text, std::forward<T>(parts)...));
}

/// " Did you mean 'x' or 'y'?" for the candidates at a small edit distance from `word`, or "" if there is none.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace perp::settings
