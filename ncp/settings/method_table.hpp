// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The methods by name: of ncp/, as published, and of lcp/.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/strategy/solve.hpp"

namespace perp::settings {

/// The method that runs when none is named.
inline constexpr std::string_view default_method = "auto";

struct MethodEntry {
  std::string_view name;
  std::string_view what;  ///< one line
  std::string_view reference;
  ncp::Method method;      ///< with its default options
  bool published = false;  ///< as in its paper, for comparisons
  /// Of lcp/: for affine problems only.
  bool affine() const { return std::holds_alternative<ncp::Affine>(method); }
};

std::span<const MethodEntry> methods();
const MethodEntry* find_method(std::string_view name);  ///< nullptr if there is none
std::vector<std::string_view> method_names();
/// Of a name, or of a strategy in words, "first(path, scaled(smooth))"; nothing if the name has no parenthesis and is
/// none. Throws InputError that says what is wrong with a strategy.
std::optional<ncp::Method> method_named(const std::string& text);

}  // namespace perp::settings
