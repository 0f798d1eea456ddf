// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/variant.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <utility>

#include "ncp/problem/fields.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::contact {
namespace {

using Law = Variant::Law;
constexpr std::array<std::string_view, 6> laws{"glocker", "ncp1", "inner", "outer", "frictionless", "coulomb"};

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument(why); }

int facets_of(const std::string& formulation, std::string_view digits) {
  int facets = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), facets);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
    refuse("formulation " + formulation + ": '" + std::string(digits) + "' is no number of facets");
  if (facets < 3 || facets > most_facets)
    refuse("formulation " + formulation + ": a polygon needs K = 3 to " + std::to_string(most_facets) + " facets");
  return facets;
}

void set_law(Variant& variant, const std::string& formulation) {
  const std::size_t colon = formulation.find(':');
  const std::string name = formulation.substr(0, colon);
  const auto* const found = std::ranges::find(laws, name);
  if (found == laws.end())
    throw UnknownWord("formulation: '" + formulation + "' is none of " + formulation_names + ".", name,
                      {laws.begin(), laws.end()});
  variant.law = static_cast<Law>(found - laws.begin());
  if (variant.faceted()) {
    if (colon == std::string::npos)
      refuse("formulation " + formulation + ": how many facets? " + formulation + ":8, say");
    variant.facets = facets_of(formulation, std::string_view(formulation).substr(colon + 1));
  } else if (colon != std::string::npos) {
    refuse("formulation " + formulation + ": " + name + " has no facets");
  }
}

const lcp::MethodEntry* find_affine(std::string_view name) {
  const auto found = std::ranges::find(lcp::methods(), name, &lcp::MethodEntry::name);
  return found == lcp::methods().end() ? nullptr : &*found;
}

const MethodEntry* find_own(std::string_view name) {
  const auto found = std::ranges::find(methods(), name, &MethodEntry::name);
  return found == methods().end() ? nullptr : &*found;
}

/// The methods of the variant's law.
std::vector<std::string_view> method_names(const Variant& variant) {
  std::vector<std::string_view> names;
  if (variant.law == Law::Coulomb) {
    for (const MethodEntry& entry : methods()) names.push_back(entry.name);
    return names;
  }
  if (variant.exact())
    for (const auto table : {ncp::presets(), ncp::published()})
      for (const ncp::Preset& preset : table) names.push_back(preset.name);
  else
    for (const lcp::MethodEntry& entry : lcp::methods()) names.push_back(entry.name);
  if (variant.law == Law::Glocker)
    for (const MethodEntry& entry : methods())
      if (entry.name != "auto") names.push_back(entry.name);
  return names;
}

/// What a name means for the variant's law.
Variant::Solver solver_named(const Variant& variant, const std::string& name) {
  const bool glocker = variant.law == Law::Glocker;
  const MethodEntry* own = find_own(name);
  if ((glocker || variant.law == Law::Coulomb) && own != nullptr)
    return std::visit([](const auto& m) { return Variant::Solver(m); }, own->method);
  if (!variant.exact() && name == "auto") return EncodingAuto{};
  const ncp::Preset* preset = ncp::find_preset(name);
  const lcp::MethodEntry* affine = find_affine(name);
  if (glocker && preset != nullptr) return GlockerNcp{.method = preset->method};
  if (variant.law == Law::Ncp1 && preset != nullptr) return preset->method;
  if (!variant.exact() && affine != nullptr) return affine->method;
  if (!variant.exact() && preset != nullptr) return preset->method;  // an affine problem is an MCP, too
  const std::string method = "method " + name;
  if (own != nullptr && name != "auto")
    refuse(method + " is of formulation " + (own->glocker ? "glocker" : "coulomb") + ", not of " +
           variant.formulation());
  if (affine != nullptr) refuse(method + " is for affine problems; " + variant.formulation() + " is nonlinear");
  const std::vector<std::string_view> known = method_names(variant);
  if (preset != nullptr && variant.law == Law::Coulomb)
    refuse(method + " is for NCPs: of glocker and ncp1, not of coulomb");
  throw UnknownWord("method: there is no method '" + name + "'; " + variant.formulation() + " is solved by " +
                        ncp::alternatives(known) + ".",
                    name, known);
}

void set_method(Variant& variant, const VariantWords& words) {
  const bool as_ncp = words.encoding.has_value() || words.row.has_value();
  const bool by_path = variant.law == Law::Ncp1 || (variant.law == Law::Glocker && as_ncp);
  const bool coulomb = variant.law == Law::Coulomb;
  variant.method = words.method.value_or(coulomb ? "nsgs" : by_path ? "path" : "auto");
  variant.solver = solver_named(variant, variant.method);
  if (const MethodEntry* own = find_own(variant.method); own != nullptr && (coulomb || variant.law == Law::Glocker))
    variant.law = own->glocker ? Law::Glocker : Law::Coulomb;
}

/// 0 if it is the first of the two, 1 if the second.
int one_of(const std::string& field, const std::string& given, std::string_view first, std::string_view second) {
  if (given != first && given != second)
    refuse(field + ": '" + given + "' is neither " + std::string(first) + " nor " + std::string(second));
  return given == first ? 0 : 1;
}

void set_form(Variant& variant, const VariantWords& words) {
  auto* ncp = std::get_if<GlockerNcp>(&variant.solver);
  for (const auto& [field, given] : {std::pair{"encoding ", words.encoding}, std::pair{"row ", words.row}}) {
    if (given && variant.law != Law::Glocker)
      refuse(field + *given + " is of formulation glocker, not of " + variant.formulation());
    if (given && ncp == nullptr)
      refuse(field + *given + ": method " + variant.method +
             " has its own form; name another method, path for instance");
  }
  if (words.form && !variant.faceted())
    refuse("form " + *words.form + " is of the faceted formulations, not of " + variant.formulation());
  if (words.encoding) ncp->formulation.encoding = static_cast<Encoding>(one_of("encoding", *words.encoding, "A", "B"));
  if (words.row) ncp->formulation.row = static_cast<DiskRow>(one_of("row", *words.row, "original", "normalised"));
  if (words.form) variant.form = static_cast<Form>(one_of("form", *words.form, "mixed", "reduced"));
}

}  // namespace

Polygons Variant::polygons(int dimension) const {
  if (dimension == 2) return {Polygon::interval()};
  return {law == Law::Inner ? Polygon::inscribed(facets, rotation) : Polygon::circumscribed(facets, rotation)};
}

std::string Variant::formulation() const {
  const std::string name(laws.at(static_cast<std::size_t>(law)));
  return faceted() ? name + ":" + std::to_string(facets) : name;
}

std::string Variant::label() const {
  std::string text = formulation();
  if (exact() || method != "auto") text += "+" + method;
  if (const GlockerNcp* ncp = as_ncp()) {
    text += ncp->formulation.encoding == Encoding::A ? "/A" : "/B";
    if (ncp->formulation.row == DiskRow::Original) text += "/original";
  }
  if (form == Form::Mixed) text += "/mixed";
  return text;
}

std::string Variant::words() const {
  const std::string shape = form == Form::Mixed ? "MLCP" : "LCP";
  const std::string by = " by " + method;
  switch (law) {
    case Law::Glocker:
      if (const GlockerNcp* ncp = as_ncp())
        return std::string("Glocker's ") +
               (ncp->formulation.encoding == Encoding::A ? "MCP (encoding A, " : "NCP (encoding B, ") +
               (ncp->formulation.row == DiskRow::Original ? "original" : "normalised") + " disk row)" + by;
      if (const MethodEntry* own = find_own(method)) return std::string(own->what);
      return "Glocker's NCP" + by;
    case Law::Coulomb:
      return "Coulomb's law: " + std::string(find_own(method)->what);
    case Law::Ncp1:
      return "the first NCP, by norms," + by;
    case Law::Inner:
      return "friction polygons of " + std::to_string(facets) + " vertices on the disk's rim (" + shape + ")" + by;
    case Law::Outer:
      return "friction polygons of " + std::to_string(facets) + " edges that touch the disk (" + shape + ")" + by;
    case Law::Frictionless:
      return "no friction at all (LCP)" + by;
  }
  return "";
}

Variant variant_of(const VariantWords& words) {
  Variant variant;
  set_law(variant, words.formulation);
  set_method(variant, words);
  set_form(variant, words);
  return variant;
}

namespace {

VariantWords words_of(std::string_view text) {
  VariantWords words;
  const std::string_view head = text.substr(0, text.find('/'));
  const std::size_t plus = head.find('+');
  words.formulation = head.substr(0, plus);
  if (plus != std::string_view::npos) words.method = head.substr(plus + 1);
  for (std::size_t at = head.size(); at < text.size();) {
    const std::size_t end = std::min(text.find('/', at + 1), text.size());
    const std::string word(text.substr(at + 1, end - at - 1));
    if (word == "A" || word == "B")
      words.encoding = word;
    else if (word == "original" || word == "normalised")
      words.row = word;
    else if (word == "mixed" || word == "reduced")
      words.form = word;
    else
      refuse("'" + word + "' is none of A, B, original, normalised, mixed, reduced");
    at = end;
  }
  return words;
}

/// The variant in each of its forms.
std::vector<Variant> forms_of(const Variant& one) {
  std::vector<Variant> forms;
  if (one.as_ncp() != nullptr) {
    for (const Encoding encoding : {Encoding::B, Encoding::A})
      for (const DiskRow row : {DiskRow::Normalised, DiskRow::Original}) {
        GlockerOptions& formulation = std::get<GlockerNcp>(forms.emplace_back(one).solver).formulation;
        formulation.encoding = encoding;
        formulation.row = row;
      }
  } else if (one.faceted()) {
    for (const Form form : {Form::Reduced, Form::Mixed}) forms.emplace_back(one).form = form;
  } else {
    forms.push_back(one);
  }
  return forms;
}

}  // namespace

Variant variant_of(std::string_view text) { return variant_of(words_of(text)); }

std::vector<Variant> variants_of(std::string_view pattern) {
  const bool every_form = pattern.ends_with("/*");
  if (every_form) pattern.remove_suffix(2);
  VariantWords words = words_of(pattern);
  std::vector<std::string> names{words.method.value_or("")};
  Variant every;
  const bool every_method = words.method == "*";
  if (every_method) {
    set_law(every, words.formulation);
    const std::vector<std::string_view> known = method_names(every);
    names.assign(known.begin(), known.end());
    std::erase(names, "auto");  // which chooses among the others
  }
  std::vector<Variant> variants;
  for (const std::string& name : names) {
    if (words.method) words.method = name;
    const Variant one = variant_of(words);
    std::ranges::move(every_form ? forms_of(one) : std::vector{one}, std::back_inserter(variants));
  }
  // A method's name can lead to its own formulation.
  if (every_method) std::erase_if(variants, [&](const Variant& variant) { return variant.law != every.law; });
  return variants;
}

}  // namespace perp::contact
