#pragma once
/// One way to solve a contact problem: a law of friction, its form, and a method. As text
///     FORMULATION[+METHOD][/WORD]...
/// "glocker", "glocker+homotopy", "glocker+path/B/original", "inner:8", "outer:16+lemke/mixed", "frictionless",
/// "ncp1+semismooth".
#include <optional>
#include <string>
#include <vector>

#include "contact/affine_encoding.hpp"
#include "contact/glocker.hpp"

namespace perp::app::contacts {

struct Variant {
  enum class Law { Glocker, Ncp1, Inner, Outer, Frictionless };
  Law law = Law::Glocker;
  int facets = 0;        ///< K of Inner and Outer
  std::string method{};  ///< "auto", what contact/ tries one after another: of Glocker contact::Auto, of the affine
                         ///< laws Lemke's from the encoding's own start and more; "homotopy" of Glocker alone; or a
                         ///< name of `perp methods`
  contact::Encoding encoding = contact::GlockerOptions{}.encoding;  ///< of Glocker by a method of `perp methods`
  contact::DiskRow row = contact::DiskRow::Normalised;
  contact::Form form = contact::Form::Reduced;  ///< of Inner and Outer
  double rotation = 0;                          ///< of their polygons [rad]; in no text
  std::vector<std::string> options{};           ///< key=value, of the method (method_options.hpp); in no text

  /// Is it Coulomb's law? The others solve a problem of their own.
  bool exact() const { return law == Law::Glocker || law == Law::Ncp1; }
  bool faceted() const { return law == Law::Inner || law == Law::Outer; }
  bool automatic() const { return law == Law::Glocker && method == "auto"; }
  bool homotopy() const { return law == Law::Glocker && method == "homotopy"; }
  /// Is it Glocker's NCP as it stands, by a method of `perp methods`? Encoding and disk row are of these.
  bool as_ncp() const { return law == Law::Glocker && !automatic() && !homotopy(); }
  std::string formulation() const;  ///< "glocker", "inner:8"
  /// The text it is parsed from, with its method, without what is as it would be anyway.
  std::string label() const;
  /// The flags of `perp contact` that ask for it.
  std::vector<std::string> flags() const;
  /// In words: "Glocker's NCP (encoding B, normalised disk row) by path".
  std::string words() const;
};

/// What flags say; what is not given follows from the rest.
struct VariantRequest {
  std::string formulation = "glocker";
  std::optional<std::string> method{};
  std::optional<std::string> encoding{};
  std::optional<std::string> row{};
  std::optional<std::string> form{};
  std::vector<std::string> options{};
};
/// Throws InputError naming flag and value: no such word, K < 3 or above 1000, a flag of another formulation or method.
Variant parse_variant(const VariantRequest& request);
/// Of the text above.
Variant parse_variant(const std::string& text);
/// Of a comma-separated list; refuses repetitions.
std::vector<Variant> parse_variants(const std::string& list);

/// The formulations, as --help writes them.
inline constexpr const char* formulation_names = "glocker, ncp1, inner:K, outer:K, frictionless";
/// What `--compare` runs where nothing else is asked for.
inline constexpr const char* default_variants =
    "glocker+auto,glocker+homotopy,glocker+path/B,glocker+semismooth/B,glocker+smooth/B,inner:8,outer:8,frictionless";

}  // namespace perp::app::contacts
