// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The variants of contact/solvers/variant.hpp as the program asks for them: by flags, with options of their methods.
#include <optional>
#include <string>
#include <vector>

#include "contact/solvers/variant.hpp"

namespace perp::app::contacts {

struct Variant : contact::Variant {
  std::vector<std::string> options{};  ///< key=value (method_options.cpp), applied to the solver; in no text
  std::vector<std::string> notes{};    ///< those without effect, and why
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
/// Throws InputError naming flag and value: what contact::variant_of and set_options() refuse.
Variant parse_variant(const VariantRequest& request);
/// Of contact::variant_of's text.
Variant parse_variant(const std::string& text);
/// Of a comma-separated list, with the stars of contact::variants_of; refuses repetitions.
std::vector<Variant> parse_variants(const std::string& list);

// Options of a variant's method, key=value (`--option`): those of `perp methods` for methods of ncp/ and lcp/, and of
// contact/ its own (contact::describe): of auto, of homotopy, and of glocker by another method.

/// Sets what the variant's options say in its solver, and the notes. Throws InputError naming key, value and what is
/// known: no such key, a value that makes no sense, an option that a flag sets (--method, --tol, --time-limit), a
/// variant whose method has none.
void set_options(Variant& variant);

/// The keys of auto beside the homotopy's, of the homotopy, and of Glocker's NCP, as --help writes them.
std::string auto_keys();
std::string homotopy_keys();
std::string glocker_keys();
/// The methods of formulation coulomb, and "of NAME KEYS" of each.
std::string classic_names();
std::string classic_keys();

}  // namespace perp::app::contacts
