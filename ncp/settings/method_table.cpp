// SPDX-License-Identifier: Apache-2.0
#include "ncp/settings/method_table.hpp"

#include <algorithm>
#include <stdexcept>

#include "ncp/settings/input_error.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::settings {

namespace {

std::vector<MethodEntry> all_methods() {
  std::vector<MethodEntry> table;
  for (const ncp::Preset& preset : ncp::presets())
    table.push_back({preset.name, preset.what, preset.reference, preset.method});
  for (const ncp::Preset& preset : ncp::published())
    table.push_back({preset.name, preset.what, preset.reference, preset.method, true});
  for (const lcp::MethodEntry& entry : lcp::methods())
    if (!std::holds_alternative<lcp::Auto>(entry.method))  // auto calls it
      table.push_back({entry.name, entry.what, entry.reference, ncp::Affine{.method = entry.method}, false});
  return table;
}

}  // namespace

std::span<const MethodEntry> methods() {
  static const std::vector<MethodEntry> table = all_methods();
  return table;
}

const MethodEntry* find_method(std::string_view name) {
  if (name == "min-newton") name = "newton-min";  // names that methods for affine problems had
  if (name == "fb-newton") name = "semismooth";
  const auto entry = std::ranges::find(methods(), name, &MethodEntry::name);
  return entry == methods().end() ? nullptr : &*entry;
}

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names;
  for (const MethodEntry& entry : methods()) names.push_back(entry.name);
  return names;
}

std::optional<ncp::Method> method_named(const std::string& text) {
  if (const MethodEntry* entry = find_method(text)) return entry->method;
  if (text.find('(') == std::string::npos) return std::nullopt;
  try {
    return ncp::method_of(text);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

}  // namespace perp::settings
