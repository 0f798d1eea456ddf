#include "app/contact/method_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <variant>

#include "app/methods.hpp"
#include "app/options.hpp"
#include "app/program.hpp"

namespace perp::app::contacts {

namespace {

constexpr const char* source = "--option";
constexpr std::array<std::pair<std::string_view, lcp::LuBackend>, 5> factorizations{
    {{"umfpack", lcp::LuBackend::Umfpack},
     {"klu", lcp::LuBackend::Klu},
     {"eigen", lcp::LuBackend::Eigen},
     {"dense", lcp::LuBackend::Dense},
     {"auto", lcp::LuBackend::Auto}}};

using Named = std::vector<contact::NamedOption>;

std::vector<std::string_view> keys(const Named& options) {
  std::vector<std::string_view> names(options.size());
  std::ranges::transform(options, names.begin(), &contact::NamedOption::key);
  return names;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return result;
}

[[noreturn]] void refuse(const Assignment& given, std::string_view takes) {
  throw InputError(fmt::format("{}: {} = {} is refused; it takes {}", source, given.key,
                               given.value.empty() ? "(nothing)" : given.value, takes));
}

template <class Number>
void set_number(const Assignment& given, Number& target, const char* takes) {
  const std::string& text = given.value;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), target);
  if (error != std::errc{} || end != text.data() + text.size()) refuse(given, takes);
}

void set(const Assignment& given, int& target) { set_number(given, target, "an integer"); }
void set(const Assignment& given, double& target) {
  set_number(given, target, "a number");
  if (!std::isfinite(target)) refuse(given, "a finite number");
}
void set(const Assignment& given, bool& target) {
  const std::string word = lower(given.value);
  const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
    return std::ranges::find(words, word) != words.end();
  };
  if (!is_one_of({"yes", "true", "on", "1", "no", "false", "off", "0"})) refuse(given, "yes or no");
  target = is_one_of({"yes", "true", "on", "1"});
}
void set(const Assignment& given, lcp::LuBackend& target) {
  for (const auto& [name, backend] : factorizations)
    if (name == lower(given.value)) {
      target = backend;
      return;
    }
  refuse(given, "umfpack, klu, eigen, dense or auto");
}

/// Sets the one it names. False: none of them.
bool set_own(const Assignment& given, const Named& options) {
  const auto found = std::ranges::find(options, lower(given.key), &contact::NamedOption::key);
  if (found == options.end()) return false;
  std::visit([&](auto* field) { set(given, *field); }, found->field);
  return true;
}

/// What the library says of them.
void check(const contact::Options& options) {
  if (const auto why = contact::invalid(options)) throw InputError(fmt::format("{}: {}", source, *why));
}

/// The method of `perp methods` with these options; what flags of `perp contact` say is refused.
ncp::Method with_options(Variant& variant, std::vector<Assignment> given) {
  given.insert(given.begin(), Assignment{"method", variant.method, source});
  Applied applied = apply_options(given);
  Settings& settings = applied.settings;
  const auto set_by_flag = [](const char* what, const char* flag) {
    throw InputError(fmt::format("{}: {} is what {} says", source, what, flag));
  };
  if (settings.method_name != variant.method) set_by_flag("the method", "--method");
  const ncp::Method plain = find_method(variant.method)->method;
  const ncp::Stop& usual = ncp::stop(plain);
  const ncp::Stop& now = ncp::stop(settings.method);
  if (now.max_time != usual.max_time) set_by_flag("the time limit", "--time-limit");
  if (variant.as_ncp() == nullptr && now.tol != usual.tol) set_by_flag("the tolerance", "--tol");
  if (variant.as_ncp() == nullptr && (now.max_F_evals != usual.max_F_evals || now.tol_relative != usual.tol_relative))
    applied.notes.push_back(
        fmt::format("{}: evaluation_limit and relative_tolerance have no effect on affine laws", source));
  Output any;
  ncp::Fields output;
  describe(any, output);
  for (const Assignment& one : given)
    if (output.find(lower(one.key)) != nullptr)
      applied.notes.push_back(fmt::format("{}: {} has no effect on perp contact", source, one.key));
  variant.notes = std::move(applied.notes);
  return settings.method;
}

/// All of them are the method's own.
template <class Method>
void set_all(const std::vector<Assignment>& given, const std::string& name, Method& method) {
  const Named own = contact::named_options(method);
  for (const Assignment& one : given)
    if (!set_own(one, own))
      throw InputError(fmt::format("{}: method {} has no option '{}'; it has {}.{}", source, name, one.key,
                                   fmt::join(keys(own), ", "), did_you_mean(lower(one.key), keys(own))));
  check({.method = method});
}

/// Those of Glocker's NCP, and of its method.
void set_all(std::vector<Assignment> given, Variant& variant, contact::GlockerNcp& ncp) {
  const Named own = contact::named_options(ncp);
  std::erase_if(given, [&](const Assignment& one) { return set_own(one, own); });
  try {
    ncp.method = with_options(variant, std::move(given));
  } catch (const UnknownOption& error) {
    throw InputError(fmt::format("{} Of Glocker's NCP there are also {}.", error.what(), glocker_keys()));
  }
  check({.method = ncp});
}

}  // namespace

void set_options(Variant& variant) {
  std::vector<Assignment> given;
  for (const std::string& option : variant.options) given.push_back(parse_assignment(option, source));
  if (auto* automatic = std::get_if<contact::Auto>(&variant.solver))
    set_all(given, variant.method, *automatic);
  else if (auto* homotopy = std::get_if<contact::GlockerHomotopy>(&variant.solver))
    set_all(given, variant.method, *homotopy);
  else if (auto* ncp = std::get_if<contact::GlockerNcp>(&variant.solver))
    set_all(std::move(given), variant, *ncp);
  else if (auto* method = std::get_if<ncp::Method>(&variant.solver))
    *method = with_options(variant, std::move(given));
  else if (auto* affine = std::get_if<lcp::Method>(&variant.solver))
    *affine = std::get<ncp::Affine>(with_options(variant, std::move(given))).method;
  else if (!given.empty())  // Lemke's method first, then lcp::Auto
    throw InputError(fmt::format("{} {}: {} by auto has no options; name a --method, lemke for instance", source,
                                 variant.options.front(), variant.formulation()));
}

std::string auto_keys() {
  contact::Auto any;
  std::vector<std::string_view> all = keys(contact::named_options(any));
  all.resize(all.size() - contact::named_options(any.homotopy).size());
  return fmt::format("{}", fmt::join(all, ", "));
}

std::string homotopy_keys() {
  contact::GlockerHomotopy any;
  return fmt::format("{}", fmt::join(keys(contact::named_options(any)), ", "));
}

std::string glocker_keys() {
  contact::GlockerNcp any;
  return fmt::format("{}", fmt::join(keys(contact::named_options(any)), ", "));
}

}  // namespace perp::app::contacts
