// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The variants of contact/solvers/variant.hpp as the program asks for them: by flags, with options of their methods.
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "contact/solvers/named_options.hpp"
#include "contact/solvers/variant.hpp"

namespace perp::app::contacts {

struct Variant : contact::Variant {
  std::vector<std::string> options{};  ///< key=value, applied to the solver; in no text
  contact::AppliedOptions applied{};   ///< what they set beside
  /// The flags of `perp contact` that ask for it.
  std::vector<std::string> flags() const;
};

/// What flags say; what is not given follows from the rest.
struct VariantRequest {
  std::string formulation = "glocker";
  std::optional<std::string> method{};
  std::optional<std::string> encoding{};
  std::optional<std::string> row{};
  std::optional<std::string> form{};
  std::optional<double> rotation{};  ///< of the polygon [rad]
  std::vector<std::string> options{};
};
/// Throws InputError naming flag and value: what contact::variant_of and contact::apply_options refuse.
Variant parse_variant(const VariantRequest& request);
/// Of contact::variant_of's text.
Variant parse_variant(const std::string& text);
/// Of a comma-separated list, with the stars of contact::variants_of; refuses repetitions.
std::vector<Variant> parse_variants(const std::string& list);

/// The methods of formulation coulomb, and "of NAME KEYS" of each.
std::string classic_names();
std::string classic_keys();
/// Prints what the variant's method tries in turn, and its options.
void show(std::ostream& out, Variant variant);

}  // namespace perp::app::contacts
