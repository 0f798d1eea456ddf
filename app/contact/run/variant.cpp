// SPDX-License-Identifier: Apache-2.0
#include "app/contact/run/variant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "app/options/options.hpp"
#include "app/program/program.hpp"
#include "app/text/table.hpp"

namespace perp::app::contacts {

namespace {

/// What `make` reads; what it refuses is said with a word that is near.
template <class Make>
auto read_words(std::string_view before, const Make& make) {
  try {
    return make();
  } catch (const contact::UnknownWord& error) {
    throw input_error("{}{}{}", before, error.what(), did_you_mean(error.word(), error.known()));
  } catch (const std::invalid_argument& error) {
    throw input_error("{}{}", before, error.what());
  }
}

}  // namespace

std::vector<std::string> Variant::flags() const {
  std::vector<std::string> flags{"--formulation", formulation(), "--method", method};
  const auto add = [&](const char* flag, const char* value) { flags.insert(flags.end(), {flag, value}); };
  if (const contact::GlockerNcp* ncp = as_ncp()) {
    add("--encoding", ncp->formulation.encoding == contact::Encoding::A ? "A" : "B");
    if (ncp->formulation.row == contact::DiskRow::Original) add("--row", "original");
  }
  if (form == contact::Form::Mixed) add("--form", "mixed");
  for (const std::string& option : options) add("--option", option.c_str());
  return flags;
}

Variant parse_variant(const VariantRequest& request) {
  // What is refused begins with the field's name, which is the flag's.
  const contact::VariantWords words{.formulation = request.formulation,
                                    .method = request.method,
                                    .encoding = request.encoding,
                                    .row = request.row,
                                    .form = request.form};
  Variant variant{read_words("--", [&] { return contact::variant_of(words); }), request.options};
  if (request.rotation && (!variant.faceted() || !std::isfinite(*request.rotation)))
    throw input_error("--rotation {:g}: a finite angle in radians, of inner:K and outer:K", *request.rotation);
  variant.rotation = request.rotation.value_or(0);
  std::vector<Assignment> given;
  for (const std::string& option : variant.options) {
    given.push_back(parse_assignment(option, "--option"));
    if (lowercase(given.back().key) == "method") throw InputError("--option: the method is what --method says");
  }
  variant.applied = contact::apply_options(variant, std::move(given));
  return variant;
}

Variant parse_variant(const std::string& text) {
  return {read_words(fmt::format("'{}': ", text), [&] { return contact::variant_of(text); })};
}

std::vector<Variant> parse_variants(const std::string& list) {
  std::vector<Variant> variants;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    const std::string text = list.substr(at, end - at);
    for (contact::Variant& variant :
         read_words(fmt::format("'{}': ", text), [&] { return contact::variants_of(text); })) {
      if (std::ranges::any_of(variants, [&](const Variant& other) { return other.label() == variant.label(); }))
        throw input_error("--variants: {} is there twice", variant.label());
      variants.push_back({std::move(variant)});
    }
    at = end + 1;
  }
  return variants;
}

std::string classic_names() {
  std::vector<std::string_view> names;
  for (const contact::MethodEntry& entry : contact::methods())
    if (!entry.glocker) names.push_back(entry.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string classic_keys() {
  std::vector<std::string> kinds;
  for (const contact::MethodEntry& entry : contact::methods())
    if (!entry.glocker) {
      const auto solver = std::visit([](const auto& m) { return contact::Variant::Solver(m); }, entry.method);
      kinds.push_back(fmt::format("of {} {}", entry.name, contact::own_keys(solver)));
    }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

void show(std::ostream& out, Variant variant) {
  out << fmt::format("{}: {}\n", variant.label(), variant.words());
  if (variant.automatic())
    for (const ncp::OutlineLine& line : contact::outline_of_auto()) {
      out << fmt::format("  {}{}\n", line.method, line.when.empty() ? "" : ", " + line.when);
      for (const std::string& why : {line.reason, line.worth})
        if (!why.empty()) print_wrapped(out, why, 6);
    }
  out << "\nIts options:\n";
  for (const ncp::Field& field : contact::own_options(variant.solver).options()) {
    out << fmt::format("\n  {}\n", field.key);
    print_wrapped(out, std::string(field.help), 6);
    print_wrapped(out, fmt::format("{}; default {}", takes(field), value_text(field)), 6);
  }
}

}  // namespace perp::app::contacts
