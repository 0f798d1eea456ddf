// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/named_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "ncp/settings/settings.hpp"

namespace perp::contact {

namespace {

using settings::Assignment;
using settings::InputError;

std::vector<std::string_view> keys(const ncp::Fields& fields) {
  std::vector<std::string_view> all;
  for (const ncp::Field& field : fields.options()) all.push_back(field.key);
  return all;
}

/// Tells whether it is about what is logged, of which contact problems have nothing.
bool is_output(const Assignment& one) {
  settings::Output any;
  ncp::Fields fields;
  settings::describe(any, fields);
  return fields.find(settings::lowercase(one.key)) != nullptr;
}

void note_without_effect(const Assignment& one, AppliedOptions& out) {
  out.notes.push_back(fmt::format("{}: {} has no effect on contact problems", one.source, one.key));
}

/// A solver of contact/ has no others than its own but tolerance and time limit.
void take_limits(const Variant& variant, const std::vector<Assignment>& given, const ncp::Fields& own,
                 AppliedOptions& out) {
  ncp::Stop stop;
  ncp::Fields limits;
  describe(stop, limits);
  for (const Assignment& one : given) {
    const std::string key = settings::lowercase(one.key);
    const bool tol = key == "convergence_tolerance" || key == "tol";
    const bool time = key == "time_limit" || key == "max_time";
    if (tol || time) {
      settings::set(*limits.find(tol ? "convergence_tolerance" : "time_limit"), one, out.notes);
      if (tol) out.tol = stop.tol;
      if (time) out.seconds = stop.max_time.count();
    } else if (is_output(one)) {
      note_without_effect(one, out);
    } else if (keys(own).empty()) {
      throw InputError(fmt::format("{} {}: {} by {} has no options; name a method, lemke for instance", one.source,
                                   one.key, variant.formulation(), variant.method));
    } else {
      throw InputError(fmt::format("{}: method {} has no option '{}'; it has {}.{}", one.source, variant.method,
                                   one.key, fmt::join(keys(own), ", "), settings::did_you_mean(key, keys(own))));
    }
  }
}

/// Options of a method of ncp/ or lcp/.
settings::Settings apply_others(const Variant& variant, std::vector<Assignment> given, AppliedOptions& out) {
  for (const Assignment& one : given)
    if (is_output(one)) note_without_effect(one, out);
  given.push_back({"method", variant.method, "variant"});
  settings::Applied applied = settings::apply_options(given);
  out.notes.insert(out.notes.end(), applied.notes.begin(), applied.notes.end());
  const ncp::Method plain = settings::find_method(variant.method)->method;
  const ncp::Stop& usual = ncp::stop(plain);
  const ncp::Stop& now = ncp::stop(applied.settings.method);
  if (now.tol != usual.tol) out.tol = now.tol;
  if (now.max_time != usual.max_time) out.seconds = now.max_time.count();
  return applied.settings;
}

}  // namespace

ncp::Fields own_options(Variant::Solver& of) {
  ncp::Fields fields;
  const auto describe_own = [&fields](auto& solver) {
    if constexpr (is_method<std::remove_cvref_t<decltype(solver)>>) describe(solver, fields);
  };
  std::visit(describe_own, of);
  return fields;
}

std::string own_keys(Variant::Solver of) { return fmt::format("{}", fmt::join(keys(own_options(of)), ", ")); }

AppliedOptions apply_options(Variant& variant, std::vector<Assignment> given) {
  AppliedOptions out;
  const ncp::Fields own = own_options(variant.solver);
  std::erase_if(given, [&](const Assignment& one) {
    const ncp::Field* field = own.find(settings::lowercase(one.key));
    if (field != nullptr) settings::set(*field, one, out.notes);
    return field != nullptr;
  });
  if (auto* of_glocker = std::get_if<GlockerNcp>(&variant.solver)) {
    try {
      of_glocker->method = apply_others(variant, given, out).method;
    } catch (const settings::UnknownOption& error) {
      throw InputError(fmt::format("{} Of Glocker's NCP there are also {}.", error.what(), fmt::join(keys(own), ", ")));
    }
  } else if (auto* of_ncp = std::get_if<ncp::Method>(&variant.solver)) {
    *of_ncp = apply_others(variant, given, out).method;
  } else if (auto* affine = std::get_if<lcp::Method>(&variant.solver)) {
    *affine = std::get<ncp::Affine>(apply_others(variant, given, out).method).method;
  } else {
    take_limits(variant, given, own, out);
  }
  return out;
}

}  // namespace perp::contact
