// SPDX-License-Identifier: Apache-2.0
#include "app/options/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <ostream>

#include "app/options/options.hpp"
#include "app/text/json_parts.hpp"
#include "app/text/table.hpp"
#include "ncp/reformulation/cfunction.hpp"

namespace perp::app {

namespace {

/// "umfpack; klu with x, y; no effect on z": the default of an option, method by method.
std::string defaults(const Option& option) {
  struct Group {
    std::string value;
    std::vector<std::string_view> methods{};
  };
  std::vector<Group> groups;
  std::vector<std::string_view> with, without;
  std::string inert;  // why no method has a default where none does
  for (const MethodEntry& entry : methods()) {
    Settings settings{.method_name = std::string(entry.name), .method = entry.method};
    const ncp::Fields fields = fields_of(settings);
    const ncp::Field* field = fields.find(option.key);
    const std::string value = field == nullptr ? "-" : value_text(*field);
    (value == "-" ? without : with).push_back(entry.name);
    if (field != nullptr && !field->inert.empty()) inert = field->inert;
    if (value == "-") continue;
    auto group = std::ranges::find(groups, value, &Group::value);
    if (group == groups.end()) group = groups.insert(groups.end(), {.value = value});
    group->methods.push_back(entry.name);
  }
  std::ranges::stable_sort(groups, std::greater{}, [](const Group& group) { return group.methods.size(); });
  if (groups.empty()) return inert.empty() ? "" : fmt::format("no effect with {}, the default", inert);
  std::string text = "default " + groups[0].value;
  for (std::size_t k = 1; k < groups.size(); ++k)
    text += fmt::format("; {} with {}", groups[k].value, fmt::join(groups[k].methods, ", "));
  if (without.empty() || with.empty()) return text;
  return text + (with.size() <= without.size() ? fmt::format("; for {}", fmt::join(with, ", "))
                                               : fmt::format("; no effect on {}", fmt::join(without, ", ")));
}

/// Those of the parts that are not empty.
std::vector<std::string> known(std::vector<std::string> parts) {
  std::erase(parts, "");
  return parts;
}

void print_entries(std::ostream& out, bool affine, bool published) {
  for (const MethodEntry& entry : methods())
    if (entry.affine() == affine && entry.published == published)
      out << fmt::format("\n  {}{}\n      {}\n      {}\n", entry.name,
                         entry.name == default_method ? "  (default)" : "", entry.what, entry.reference);
}

void print_options_of(std::ostream& out, Settings settings) {
  out << "\nIts options:\n";
  for (const ncp::Field& field : fields_of(settings).options()) {
    if (field.key == "method") continue;
    out << fmt::format("\n  {}{}\n", field.key, field.alias.empty() ? "" : fmt::format(" ({})", field.alias));
    print_wrapped(out, std::string(field.help), 6);
    const std::string value = value_text(field);
    print_wrapped(out,
                  takes(field) + (!field.inert.empty() ? fmt::format("; no effect with {}", field.inert)
                                  : value == "-"       ? "; the function has none"
                                                       : "; default " + value),
                  6);
  }
}

}  // namespace

int show_method(const std::string& text, Streams streams) {
  const std::optional<ncp::Method> method = method_named(text);
  if (!method)
    throw input_error("--show: there is no method '{}'.{} 'perp methods' lists them.", text,
                      did_you_mean(text, method_names()));
  const std::vector<ncp::OutlineLine> lines = ncp::outline(*method);
  streams.out << fmt::format("{}:\n", text);
  for (const ncp::OutlineLine& line : lines) {
    const int indent = 2 + 2 * line.depth;
    streams.out << fmt::format("{:{}}{}{}\n", "", indent, line.method, line.when.empty() ? "" : ", " + line.when);
    for (const std::string& why : {line.reason, line.worth})
      if (!why.empty()) print_wrapped(streams.out, why, indent + 4);
  }
  streams.out << (lines.size() > 1 ? "\nThe next one begins where one is stuck. A limit ends them all. Left out are "
                                     "those whose condition does not hold\n"
                                     "and those whose start was had before. An option reaches all of them but those "
                                     "that were given another value;\n"
                                     "NAME.key=value, such as semismooth.sigma=0.1, reaches those of that name.\n"
                                   : "");
  print_options_of(streams.out, {.method_name = text, .method = *method});
  return exit_solved;
}

std::string methods_json(const std::string& method, const std::vector<std::string>& options) {
  Json json = json_header(Document::Methods);
  json["methods"] = Json::array();
  for (const MethodEntry& entry : methods())
    json["methods"].push_back({{"name", entry.name},
                               {"what", entry.what},
                               {"reference", entry.reference},
                               {"affine", entry.affine()},
                               {"published", entry.published}});
  json["libraries"] = library_versions();
  json["cfunctions"] = Json::array();
  for (const ncp::CFunction& c : ncp::cfunctions()) {
    Json parameter = nullptr;
    if (const auto& p = c.parameter) {
      parameter = {{"name", p->name}, {"above", p->low}, {"below", json_number(p->high)}, {"values", Json::array()}};
      for (const ncp::CFunction& at : ncp::cfunction_grid())
        if (at.name == c.name) parameter["values"].push_back(at.parameter->value);
    }
    json["cfunctions"].push_back({{"name", c.name}, {"parameter", std::move(parameter)}});
  }
  if (method.empty()) return json_text(json);
  std::vector<Assignment> given{{"method", method, "--show"}};
  for (const std::string& option : options) {
    given.push_back(parse_assignment(option, "--option"));
    if (given.back().key == "method") throw InputError("--option: --show names the method");
  }
  Applied applied = apply_options(given);
  json["method"] = applied.settings.method_name;
  json["affine"] = std::holds_alternative<ncp::Affine>(applied.settings.method);
  json["options"] = Json::object();
  for (const ncp::Field& field : fields_of(applied.settings).options())
    if (const std::string value = value_text(field); value != "-" && field.key != "method")
      json["options"][std::string(field.key)] = value;
  json["notes"] = applied.notes;
  return json_text(json);
}

int print_methods(Streams streams) {
  std::ostream& out = streams.out;
  out << "Methods: --method NAME\n";
  print_entries(out, false, false);
  out << "\nThe systems of 1997 as published, for comparisons:\n";
  print_entries(out, false, true);
  out << "\nFor affine problems, F(x) = M x + q, where auto chooses among them:\n";
  print_entries(out, true, false);
  out << "\nStrategies, put together from those for nonlinear problems: --method 'first(path, on(scaled, "
         "smooth), escape(semismooth))'\n";
  print_wrapped(
      out,
      "first(...): one after the other, until one is not stuck; on(presolved, M), on(scaled, M), on(rescaled, M), "
      "on(blocks, M): M on the presolved problem, on the problem scaled by the Jacobian at the start or at the best "
      "point, on its diagonal blocks; escape(M): M with proximal escapes where it is stuck. Options reach every method "
      "in it; path.crash_method=none reaches those named path.",
      2);

  out << '\n';
  print_wrapped(out,
                "Options: --option key=value, a line of an options file, or an AMPL option. A key may be shortened as "
                "long as it is unique.",
                0);
  for (const Option& option : options()) {
    out << "\n  " << option.key;
    if (!option.alias.empty()) out << fmt::format(" ({})", option.alias);
    out << '\n';
    print_wrapped(out, option.help, 6);
    print_wrapped(out,
                  option.key == "method" ? fmt::format("one of those above; default {}", default_method)
                                         : fmt::format("{}", fmt::join(known({option.takes, defaults(option)}), "; ")),
                  6);
  }

  out << "\nOptions of PATH that are accepted, so that its option files can be read, but have no effect in this "
         "version:\n";
  print_wrapped(out, fmt::format("{}", fmt::join(ignored_options(), ", ")), 2);
  return exit_solved;
}

}  // namespace perp::app
