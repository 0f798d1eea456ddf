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

using Target = std::variant<int*, double*, bool*, lcp::LuBackend*>;
struct OwnOption {
  std::string_view key;
  Target target;
};

std::vector<OwnOption> own_options(contact::GlockerHomotopy& m) {
  return {{"max_iterations", &m.max_iterations},
          {"other_settings", &m.other_settings},
          {"scaling", &m.scaling},
          {"delta_share", &m.options.delta_share},
          {"eps_share", &m.options.eps_share},
          {"least_centring", &m.options.least_centring},
          {"to_boundary", &m.options.to_boundary},
          {"neighbourhood", &m.options.neighbourhood},
          {"lu", &m.options.lu}};
}

/// Of auto, but for the homotopy's.
std::vector<OwnOption> further_options(contact::Auto& m) {
  return {{"sweeps", &m.sweeps}, {"polish", &m.polish}, {"polish_at", &m.polish_at}, {"proximal", &m.proximal}};
}

std::vector<OwnOption> own_options(contact::GlockerNcp& m) {
  return {{"delta", &m.formulation.delta}, {"eps", &m.formulation.eps}, {"stages", &m.stages}, {"scaling", &m.scaling}};
}

std::vector<std::string_view> keys(const std::vector<OwnOption>& options) {
  std::vector<std::string_view> names(options.size());
  std::ranges::transform(options, names.begin(), &OwnOption::key);
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
bool set_own(const Assignment& given, const std::vector<OwnOption>& options) {
  const auto found = std::ranges::find(options, lower(given.key), &OwnOption::key);
  if (found == options.end()) return false;
  std::visit([&](auto* target) { set(given, *target); }, found->target);
  return true;
}

/// What the library says of them.
void check(const contact::Options& options) {
  if (const auto why = contact::invalid(options)) throw InputError(fmt::format("{}: {}", source, *why));
}

/// The method of `perp methods` with these options; what flags of `perp contact` say is refused.
ncp::Method with_options(const Variant& variant, std::vector<Assignment> given, MethodOptions& result) {
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
  if (variant.law != Variant::Law::Glocker && now.tol != usual.tol) set_by_flag("the tolerance", "--tol");
  Output any;
  ncp::Fields output;
  describe(any, output);
  for (const Assignment& one : given)
    if (output.find(lower(one.key)) != nullptr)
      applied.notes.push_back(fmt::format("{}: {} has no effect on perp contact", source, one.key));
  result.notes = std::move(applied.notes);
  return settings.method;
}

}  // namespace

MethodOptions method_options(const Variant& variant) {
  MethodOptions result;
  result.glocker.formulation = {.encoding = variant.encoding, .row = variant.row};
  std::vector<Assignment> given;
  for (const std::string& option : variant.options) given.push_back(parse_assignment(option, source));
  const auto set_all = [&given, &variant](const std::vector<OwnOption>& own) {
    for (const Assignment& one : given)
      if (!set_own(one, own))
        throw InputError(fmt::format("{}: method {} has no option '{}'; it has {}.{}", source, variant.method, one.key,
                                     fmt::join(keys(own), ", "), did_you_mean(lower(one.key), keys(own))));
  };
  if (variant.automatic()) {
    std::vector<OwnOption> own = further_options(result.automatic);
    for (const OwnOption& one : own_options(result.automatic.homotopy)) own.push_back(one);
    set_all(own);
    check({.method = result.automatic});
    return result;
  }
  if (variant.homotopy()) {
    set_all(own_options(result.homotopy));
    check({.method = result.homotopy});
    return result;
  }
  if (!variant.exact() && variant.method == "auto") {  // Lemke's method first, then lcp::Auto
    if (!given.empty())
      throw InputError(fmt::format("{} {}: {} by auto has no options; name a --method, lemke for instance", source,
                                   variant.options.front(), variant.formulation()));
    return result;
  }
  if (variant.law != Variant::Law::Glocker) {
    result.method = with_options(variant, std::move(given), result);
    return result;
  }
  const std::vector<OwnOption> own = own_options(result.glocker);
  std::erase_if(given, [&](const Assignment& one) { return set_own(one, own); });
  try {
    result.glocker.method = with_options(variant, std::move(given), result);
  } catch (const UnknownOption& error) {
    throw InputError(fmt::format("{} Of Glocker's NCP there are also {}.", error.what(), glocker_keys()));
  }
  check({.method = result.glocker});
  return result;
}

std::string auto_keys() {
  contact::Auto any;
  return fmt::format("{}", fmt::join(keys(further_options(any)), ", "));
}

std::string homotopy_keys() {
  contact::GlockerHomotopy any;
  return fmt::format("{}", fmt::join(keys(own_options(any)), ", "));
}

std::string glocker_keys() {
  contact::GlockerNcp any;
  return fmt::format("{}", fmt::join(keys(own_options(any)), ", "));
}

}  // namespace perp::app::contacts
