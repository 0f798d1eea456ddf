// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One way to solve a contact problem: a law of friction, its form, and a method. As text
///     FORMULATION[+METHOD][/WORD]...
/// "glocker", "glocker+homotopy", "glocker+path/B/original", "inner:8", "outer:16+lemke/mixed", "frictionless",
/// "ncp1+semismooth", "coulomb+nsgs". Of a method with a name of its own the formulation follows: "glocker+nsgs" is
/// "coulomb+nsgs", and "coulomb+homotopy" is "glocker+homotopy". contact::run (run.hpp) solves a problem by it.
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "contact/laws/affine_encoding.hpp"
#include "contact/solvers/solve.hpp"
#include "lcp/solve/solve.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::contact {

/// solve(encoding) of contact/laws/affine_encoding.hpp: Lemke's method from the encoding's own start, and more.
struct EncodingAuto {};

namespace detail {
template <class... Methods>
std::variant<Methods..., ncp::Method, EncodingAuto, lcp::Method> with_others(const std::variant<Methods...>&);
template <class T, class... Methods>
constexpr bool among(const std::variant<Methods...>* /*of*/) {
  return (std::is_same_v<T, Methods> || ...);
}
}  // namespace detail
/// One of contact::Method?
template <class T>
inline constexpr bool is_method = detail::among<T>(static_cast<const Method*>(nullptr));

struct Variant {
  /// Coulomb: his exact law on r alone, by a method of contact/classics. Glocker and Ncp1 are NCPs of the same law.
  enum class Law { Glocker, Ncp1, Inner, Outer, Frictionless, Coulomb };
  /// Of Glocker and Coulomb a contact::Method, of Ncp1 a method of ncp/, of the affine laws EncodingAuto, a method of
  /// lcp/, or one of ncp/ on the affine problem as an MCP.
  using Solver = decltype(detail::with_others(Method{}));

  Law law = Law::Glocker;
  int facets = 0;               ///< K of Inner and Outer
  std::string method = "auto";  ///< the name of `solver`: of contact::methods(), of a preset of ncp/, or of a method of
                                ///< lcp/
  Solver solver{};              ///< with its options
  Form form = Form::Reduced;    ///< of Inner and Outer
  double rotation = 0;          ///< of their polygons [rad]; in no text

  /// Returns whether the law is Coulomb's. The other laws have problems of their own.
  bool exact() const { return law == Law::Glocker || law == Law::Ncp1 || law == Law::Coulomb; }
  bool faceted() const { return law == Law::Inner || law == Law::Outer; }
  bool automatic() const { return std::holds_alternative<Auto>(solver); }
  /// Returns the solver if it is a method of ncp/ on Glocker's NCP, which has an encoding and a disk row; otherwise
  /// null.
  const GlockerNcp* as_ncp() const { return std::get_if<GlockerNcp>(&solver); }
  /// Returns the polygon of Inner and Outer for problems of that dimension, one for all contacts.
  Polygons polygons(int dimension) const;

  std::string formulation() const;  ///< "glocker", "coulomb", "inner:8"
  /// Returns the text that variant_of() reads, with the method and without words that are defaults.
  std::string label() const;
  /// Describes it in words: "Glocker's NCP (encoding B, normalised disk row) by path".
  std::string words() const;
};

/// The words of a variant. Words that are not given have their defaults.
struct VariantWords {
  std::string formulation = "glocker";
  std::optional<std::string> method{};
  std::optional<std::string> encoding{};  ///< "A", "B"
  std::optional<std::string> row{};       ///< "original", "normalised"
  std::optional<std::string> form{};      ///< "mixed", "reduced"
};

/// Thrown for an unknown word. known() has the words that were possible.
class UnknownWord : public std::invalid_argument {
 public:
  UnknownWord(const std::string& why, std::string word, std::vector<std::string_view> known)
      : std::invalid_argument(why), word_(std::move(word)), known_(std::move(known)) {}
  const std::string& word() const { return word_; }
  const std::vector<std::string_view>& known() const { return known_; }

 private:
  std::string word_;
  std::vector<std::string_view> known_;
};

/// Makes a variant of the words. Throws UnknownWord, or std::invalid_argument with the name of the field at the
/// beginning of what(), for K < 3 or above most_facets and for a word of another formulation or method.
Variant variant_of(const VariantWords& words);
/// Makes a variant of the text described above.
Variant variant_of(std::string_view text);
/// Makes the variants that a text with stars stands for: METHOD * is each method of the formulation but auto, and a
/// last word /* each form: encodings and rows of Glocker's NCP, LCP and MLCP of polygons. "glocker+*/*" is all of ncp/
/// on Glocker's NCP, four times, and the homotopy; "inner:8+lemke/*" is two variants.
std::vector<Variant> variants_of(std::string_view pattern);

/// The formulations, as one writes them.
inline constexpr const char* formulation_names = "glocker, coulomb, ncp1, inner:K, outer:K, frictionless";

}  // namespace perp::contact
