// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/named_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "ncp/settings/settings.hpp"

namespace perp::contact {

namespace {

using settings::Assignment;
using settings::InputError;

/// Sets those that this method of contact/ has, and takes them out.
template <class Method>
void set_own(Method& method, std::vector<Assignment>& given) {
  ncp::Fields fields;
  describe(method, fields);
  std::vector<std::string> notes;
  std::erase_if(given, [&](const Assignment& one) {
    const ncp::Field* field = fields.find(settings::lowercase(one.key));
    if (field != nullptr) settings::set(*field, one, notes);
    return field != nullptr;
  });
  Options options;
  options.method = method;
  if (const auto why = invalid(options)) throw InputError(*why);
}

/// Is it one of the limits, or of what is logged? Other options would be for the methods of ncp/.
bool only_a_limit(const Assignment& one) {
  settings::Applied with = settings::apply_options({&one, 1});
  settings::Settings plain;
  const ncp::Stop& limits = ncp::stop(with.settings.method);
  ncp::stop(plain.method).tol = limits.tol;
  ncp::stop(plain.method).max_time = limits.max_time;
  plain.output = with.settings.output;
  const ncp::Fields usual = settings::fields_of(plain);
  const auto same = [&](const ncp::Field& field) {
    const ncp::Field* there = usual.find(field.key);
    return there != nullptr && (field.key == "method" || settings::value_text(field) == settings::value_text(*there));
  };
  return with.notes.empty() && with.settings.method_name == plain.method_name &&
         std::ranges::all_of(settings::fields_of(with.settings).options(), same);
}

/// Throws if one is given that this method of contact/ has not.
void refuse_others(const std::vector<Assignment>& given, const Variant& variant) {
  for (const Assignment& one : given)
    if (!only_a_limit(one))
      throw InputError(
          fmt::format("option: {} by {} has no option '{}'", variant.formulation(), variant.method, one.key));
}

}  // namespace

RunLimits apply_options(Variant& variant, std::vector<Assignment> given) {
  RunLimits limits;
  const auto own = [&](auto& solver) {
    if constexpr (is_method<std::remove_cvref_t<decltype(solver)>>) set_own(solver, given);
  };
  std::visit(own, variant.solver);
  auto* of_glocker = std::get_if<GlockerNcp>(&variant.solver);
  auto* of_ncp = std::get_if<ncp::Method>(&variant.solver);
  auto* affine = std::get_if<lcp::Method>(&variant.solver);
  const bool of_another = of_glocker != nullptr || of_ncp != nullptr || affine != nullptr;
  if (!of_another) refuse_others(given, variant);
  // What is given later holds: these stand for what is not given.
  given.insert(given.begin(), {{"convergence_tolerance", fmt::format("{}", limits.tol), "contact"},
                               {"time_limit", fmt::format("{}", limits.seconds), "contact"}});
  if (of_another) given.push_back({"method", variant.method, "variant"});
  const settings::Settings settings = settings::apply_options(given).settings;
  limits.tol = ncp::stop(settings.method).tol;
  limits.seconds = ncp::stop(settings.method).max_time.count();
  if (of_glocker != nullptr)
    of_glocker->method = settings.method;
  else if (of_ncp != nullptr)
    *of_ncp = settings.method;
  else if (affine != nullptr)
    *affine = std::get<ncp::Affine>(settings.method).method;
  return limits;
}

}  // namespace perp::contact
