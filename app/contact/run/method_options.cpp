// SPDX-License-Identifier: Apache-2.0
#include "app/contact/run/variant.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <variant>

#include "app/options/methods.hpp"
#include "app/options/options.hpp"
#include "app/program/program.hpp"

namespace perp::app::contacts {

namespace {

constexpr const char* source = "--option";

template <class Method>
ncp::Fields own_options(Method& method) {
  ncp::Fields fields;
  describe(method, fields);
  return fields;
}

std::vector<std::string_view> keys(const ncp::Fields& options) {
  std::vector<std::string_view> names;
  for (const ncp::Field& option : options.options()) names.push_back(option.key);
  return names;
}

/// Sets the one it names. False: none of them.
bool set_own(const Assignment& given, const ncp::Fields& options, std::vector<std::string>& notes) {
  const ncp::Field* found = options.find(lowercase(given.key));
  if (found != nullptr) set(*found, given, notes);
  return found != nullptr;
}

/// What the library says of them.
void check(const contact::Options& options) {
  if (const auto why = contact::invalid(options)) throw input_error("{}: {}", source, *why);
}

void note_without_effect(Variant& variant, std::string_view key) {
  variant.notes.push_back(fmt::format("{}: {} has no effect on perp contact", source, key));
}

/// The method of `perp methods` with these options; what flags of `perp contact` say is refused.
ncp::Method with_options(Variant& variant, std::vector<Assignment> given) {
  given.insert(given.begin(), Assignment{"method", variant.method, source});
  Applied applied = apply_options(given);
  Settings& settings = applied.settings;
  const auto set_by_flag = [](const char* what, const char* flag) {
    throw input_error("{}: {} is what {} says", source, what, flag);
  };
  if (settings.method_name != variant.method) set_by_flag("the method", "--method");
  const ncp::Method plain = find_method(variant.method)->method;
  const ncp::Stop& usual = ncp::stop(plain);
  const ncp::Stop& now = ncp::stop(settings.method);
  if (now.max_time != usual.max_time) set_by_flag("the time limit", "--time-limit");
  if (variant.as_ncp() == nullptr && now.tol != usual.tol) set_by_flag("the tolerance", "--tol");
  variant.notes.insert(variant.notes.end(), applied.notes.begin(), applied.notes.end());
  Output any;
  ncp::Fields output;
  describe(any, output);
  for (const Assignment& one : given)
    if (output.find(lowercase(one.key)) != nullptr) note_without_effect(variant, one.key);
  return settings.method;
}

/// The same for an affine law, which takes none of these limits.
lcp::Method affine_with_options(Variant& variant, std::vector<Assignment> given) {
  const auto method = std::get<ncp::Affine>(with_options(variant, std::move(given)));
  const ncp::Stop usual = ncp::Affine{}.stop;
  if (method.stop.max_F_evals != usual.max_F_evals) note_without_effect(variant, "evaluation_limit");
  if (method.stop.tol_relative != usual.tol_relative) note_without_effect(variant, "relative_tolerance");
  if (method.stop.check_derivatives) note_without_effect(variant, "check_derivatives");
  return method.method;
}

/// All of them are the method's own.
template <class Method>
void set_all(const std::vector<Assignment>& given, Variant& variant, Method& method) {
  const ncp::Fields own = own_options(method);
  for (const Assignment& one : given)
    if (!set_own(one, own, variant.notes))
      throw input_error("{}: method {} has no option '{}'; it has {}.{}", source, variant.method, one.key,
                        fmt::join(keys(own), ", "), did_you_mean(lowercase(one.key), keys(own)));
  check({.method = method});
}

/// Those of Glocker's NCP, and of its method.
void set_all(std::vector<Assignment> given, Variant& variant, contact::GlockerNcp& ncp) {
  const ncp::Fields own = own_options(ncp);
  std::erase_if(given, [&](const Assignment& one) { return set_own(one, own, variant.notes); });
  try {
    ncp.method = with_options(variant, std::move(given));
  } catch (const UnknownOption& error) {
    throw input_error("{} Of Glocker's NCP there are also {}.", error.what(), glocker_keys());
  }
  check({.method = ncp});
}

}  // namespace

void set_options(Variant& variant) {
  std::vector<Assignment> given;
  for (const std::string& option : variant.options) given.push_back(parse_assignment(option, source));
  const auto set_own_ones = [&](auto& solver) {
    if constexpr (contact::is_method<std::remove_cvref_t<decltype(solver)>>) set_all(given, variant, solver);
  };
  std::visit(set_own_ones, variant.solver);
  if (auto* method = std::get_if<ncp::Method>(&variant.solver))
    *method = with_options(variant, std::move(given));
  else if (auto* affine = std::get_if<lcp::Method>(&variant.solver))
    *affine = affine_with_options(variant, std::move(given));
  else if (std::holds_alternative<contact::EncodingAuto>(variant.solver) &&
           !given.empty())  // Lemke's method first, then lcp::Auto
    throw input_error("{} {}: {} by auto has no options; name a --method, lemke for instance", source,
                      variant.options.front(), variant.formulation());
}

std::string auto_keys() {
  contact::Auto any;
  std::vector<std::string_view> all = keys(own_options(any));
  all.resize(all.size() - own_options(any.homotopy).options().size());
  return fmt::format("{}", fmt::join(all, ", "));
}

std::string homotopy_keys() {
  contact::GlockerHomotopy any;
  return fmt::format("{}", fmt::join(keys(own_options(any)), ", "));
}

std::string glocker_keys() {
  contact::GlockerNcp any;
  return fmt::format("{}", fmt::join(keys(own_options(any)), ", "));
}

std::string classic_names() {
  std::vector<std::string_view> names;
  for (const contact::MethodEntry& entry : contact::methods())
    if (!entry.glocker) names.push_back(entry.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string classic_keys() {
  std::vector<std::string> kinds;
  for (const contact::MethodEntry& entry : contact::methods()) {
    if (entry.glocker) continue;
    contact::Method any = entry.method;
    const auto of = [&](auto& method) { return fmt::format("{}", fmt::join(keys(own_options(method)), ", ")); };
    kinds.push_back(fmt::format("of {} {}", entry.name, std::visit(of, any)));
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

}  // namespace perp::app::contacts
