#include "app/contact/variant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "app/contact/method_options.hpp"
#include "app/contact/number_list.hpp"
#include "app/methods.hpp"
#include "app/program.hpp"

namespace perp::app::contacts {

namespace {

using Law = Variant::Law;
constexpr int least_facets = 3;
constexpr std::array<std::string_view, 5> laws{"glocker", "ncp1", "inner", "outer", "frictionless"};

int parse_facets(const std::string& formulation, std::string_view digits) {
  int facets = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), facets);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
    throw InputError(fmt::format("--formulation {}: '{}' is no number of facets", formulation, digits));
  if (facets < least_facets || facets > most_facets)
    throw InputError(
        fmt::format("--formulation {}: a polygon needs K = {} to {} facets", formulation, least_facets, most_facets));
  return facets;
}

void set_law(Variant& variant, const std::string& formulation) {
  const std::size_t colon = formulation.find(':');
  const std::string name = formulation.substr(0, colon);
  const auto found = std::ranges::find(laws, name);
  if (found == laws.end())
    throw InputError(
        fmt::format("--formulation: '{}' is none of {}.{}", formulation, formulation_names, did_you_mean(name, laws)));
  variant.law = static_cast<Law>(found - laws.begin());
  if (variant.faceted()) {
    if (colon == std::string::npos)
      throw InputError(fmt::format("--formulation {0}: how many facets? {0}:8, say", formulation));
    variant.facets = parse_facets(formulation, std::string_view(formulation).substr(colon + 1));
  } else if (colon != std::string::npos) {
    throw InputError(fmt::format("--formulation {}: {} has no facets", formulation, name));
  }
}

void set_method(Variant& variant, const VariantRequest& request) {
  if (!request.method) {
    const bool as_ncp = request.encoding.has_value() || request.row.has_value();
    variant.method = variant.law == Law::Ncp1 || (variant.law == Law::Glocker && as_ncp) ? "path" : "auto";
    return;
  }
  variant.method = *request.method;
  if (variant.homotopy() || variant.automatic()) return;
  if (variant.method == "homotopy")
    throw InputError(fmt::format("--method homotopy is of --formulation glocker, not of {}", variant.formulation()));
  const MethodEntry* entry = find_method(variant.method);
  if (entry == nullptr) {
    std::vector<std::string_view> names = method_names();
    names.emplace_back("homotopy");
    throw InputError(fmt::format("--method: there is no method '{}'.{} 'perp methods' lists them; homotopy is one more",
                                 variant.method, did_you_mean(variant.method, names)));
  }
  const bool affine_law = !variant.exact();
  if (affine_law && !entry->affine() && variant.method != "auto")
    throw InputError(fmt::format("--method {}: {} is an affine problem, solved by {}", variant.method,
                                 variant.formulation(), "the methods for affine problems that 'perp methods' lists"));
  if (!affine_law && entry->affine())
    throw InputError(
        fmt::format("--method {} is for affine problems; {} is nonlinear", variant.method, variant.formulation()));
}

std::size_t one_of(const char* flag, const std::string& given, std::string_view first, std::string_view second) {
  if (given != first && given != second)
    throw InputError(fmt::format("{}: '{}' is neither {} nor {}", flag, given, first, second));
  return given == first ? 0 : 1;
}

void set_form(Variant& variant, const VariantRequest& request) {
  for (const auto& [flag, given] : {std::pair{"--encoding", request.encoding}, std::pair{"--row", request.row}})
    if (given && variant.law != Law::Glocker)
      throw InputError(
          fmt::format("{} {} is of --formulation glocker, not of {}", flag, *given, variant.formulation()));
  if (request.form && !variant.faceted())
    throw InputError(
        fmt::format("--form {} is of the faceted formulations, not of {}", *request.form, variant.formulation()));
  if (request.encoding)
    variant.encoding = static_cast<contact::Encoding>(one_of("--encoding", *request.encoding, "A", "B"));
  if (request.row) variant.row = static_cast<contact::DiskRow>(one_of("--row", *request.row, "original", "normalised"));
  if (request.form) variant.form = static_cast<contact::Form>(one_of("--form", *request.form, "mixed", "reduced"));
  for (const auto& [flag, given] : {std::pair{"--encoding", request.encoding}, std::pair{"--row", request.row}})
    if (given && !variant.as_ncp() && variant.law == Law::Glocker)
      throw InputError(fmt::format("{} {}: method {} has its own form; name another --method, path for instance", flag,
                                   *given, variant.method));
}

}  // namespace

std::string Variant::formulation() const {
  const std::string name(laws.at(static_cast<std::size_t>(law)));
  return faceted() ? fmt::format("{}:{}", name, facets) : name;
}

std::string Variant::label() const {
  std::string text = formulation();
  if (exact() || method != "auto") text += "+" + method;
  if (as_ncp()) text += encoding == contact::Encoding::A ? "/A" : "/B";
  if (row == contact::DiskRow::Original) text += "/original";
  if (form == contact::Form::Mixed) text += "/mixed";
  return text;
}

std::vector<std::string> Variant::flags() const {
  std::vector<std::string> flags{"--formulation", formulation(), "--method", method};
  const auto add = [&](const char* flag, const char* value) { flags.insert(flags.end(), {flag, value}); };
  if (as_ncp()) add("--encoding", encoding == contact::Encoding::A ? "A" : "B");
  if (row == contact::DiskRow::Original) add("--row", "original");
  if (form == contact::Form::Mixed) add("--form", "mixed");
  for (const std::string& option : options) add("--option", option.c_str());
  return flags;
}

std::string Variant::words() const {
  const char* shape = form == contact::Form::Mixed ? "MLCP" : "LCP";
  switch (law) {
    case Law::Glocker:
      if (automatic()) return "Gauss-Seidel, Glocker's homotopy, Newton steps, a proximal loop, until one solves it";
      if (homotopy()) return "Glocker's NCP by the interior-point homotopy";
      return fmt::format("Glocker's {} (encoding {}, {} disk row) by {}",
                         encoding == contact::Encoding::A ? "MCP" : "NCP", encoding == contact::Encoding::A ? "A" : "B",
                         row == contact::DiskRow::Original ? "original" : "normalised", method);
    case Law::Ncp1:
      return fmt::format("the first NCP, by norms, by {}", method);
    case Law::Inner:
      return fmt::format("friction polygons of {} vertices on the disk's rim ({}) by {}", facets, shape, method);
    case Law::Outer:
      return fmt::format("friction polygons of {} edges that touch the disk ({}) by {}", facets, shape, method);
    case Law::Frictionless:
      return fmt::format("no friction at all (LCP) by {}", method);
  }
  return "";
}

Variant parse_variant(const VariantRequest& request) {
  Variant variant;
  set_law(variant, request.formulation);
  set_method(variant, request);
  set_form(variant, request);
  variant.options = request.options;
  method_options(variant);  // says why
  return variant;
}

Variant parse_variant(const std::string& text) {
  VariantRequest request;
  const std::string head = text.substr(0, text.find('/'));
  const std::size_t plus = head.find('+');
  request.formulation = head.substr(0, plus);
  if (plus != std::string::npos) request.method = head.substr(plus + 1);
  for (std::size_t at = head.size(); at < text.size();) {
    const std::size_t end = std::min(text.find('/', at + 1), text.size());
    const std::string word = text.substr(at + 1, end - at - 1);
    if (word == "A" || word == "B")
      request.encoding = word;
    else if (word == "original" || word == "normalised")
      request.row = word;
    else if (word == "mixed" || word == "reduced")
      request.form = word;
    else
      throw InputError(fmt::format("'{}': '{}' is none of A, B, original, normalised, mixed, reduced", text, word));
    at = end;
  }
  try {
    return parse_variant(request);
  } catch (const InputError& error) {
    throw InputError(fmt::format("'{}': {}", text, error.what()));
  }
}

std::vector<Variant> parse_variants(const std::string& list) {
  std::vector<Variant> variants;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    Variant variant = parse_variant(list.substr(at, end - at));
    if (std::ranges::any_of(variants, [&](const Variant& other) { return other.label() == variant.label(); }))
      throw InputError(fmt::format("--variants: {} is there twice", variant.label()));
    variants.push_back(std::move(variant));
    at = end + 1;
  }
  return variants;
}

}  // namespace perp::app::contacts
