#include "app/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ostream>

#include "app/options.hpp"
#include "app/table.hpp"
#include "ncp/presets.hpp"

namespace perp::app {

namespace {

std::vector<MethodEntry> all_methods() {
  std::vector<MethodEntry> table;
  for (const ncp::Preset& preset : ncp::presets())
    table.push_back({preset.name, preset.what, preset.reference, preset.method});
  for (const lcp::MethodEntry& entry : lcp::methods())
    if (!std::holds_alternative<lcp::Auto>(entry.method))  // auto calls it
      table.push_back({entry.name, entry.what, entry.reference, ncp::Affine{.method = entry.method}});
  return table;
}

/// Those whose options and defaults are shown; the others differ from them as print_methods() says.
bool stands_for_others(const MethodEntry& entry) {
  constexpr std::array names{"path", "josephy", "qpcomp", "proxi", "smooth", "semicomp"};
  return entry.affine() || std::ranges::find(names, entry.name) != names.end();
}

/// The options that have an effect on at least one of these methods, with the default of each.
Table defaults(bool affine) {
  std::vector<Column> columns{{"key", Align::Left}, {"values", Align::Left}};
  for (const MethodEntry& entry : methods())
    if (entry.affine() == affine && stands_for_others(entry))
      columns.push_back({std::string(entry.name), Align::Right});
  Table table(columns);
  for (const Option& option : options()) {
    std::vector<std::string> row{std::string(option.key),
                                 option.key == "method" ? "a name above" : values_text(option)};
    bool used = false;
    for (const MethodEntry& entry : methods()) {
      if (entry.affine() != affine || !stands_for_others(entry)) continue;
      Settings settings{.method_name = std::string(entry.name), .method = entry.method};
      row.push_back(value_text(option.field(settings)));
      used = used || row.back() != "-";
    }
    if (used) table.add(std::move(row));
  }
  return table;
}

void print_entries(std::ostream& out, bool affine) {
  for (const MethodEntry& entry : methods())
    if (entry.affine() == affine)
      out << fmt::format("\n  {}{}\n      {}\n      {}\n", entry.name,
                         entry.name == default_method ? "  (default)" : "", entry.what, entry.reference);
}

}  // namespace

std::span<const MethodEntry> methods() {
  static const std::vector<MethodEntry> table = all_methods();
  return table;
}

const MethodEntry* find_method(std::string_view name) {
  const auto entry = std::ranges::find(methods(), name, &MethodEntry::name);
  return entry == methods().end() ? nullptr : &*entry;
}

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names;
  for (const MethodEntry& entry : methods()) names.push_back(entry.name);
  return names;
}

int print_methods(Streams streams) {
  std::ostream& out = streams.out;
  out << "Methods: --method NAME\n";
  print_entries(out, false);
  out << "\nFor affine problems, F(x) = M x + q, where auto chooses among them:\n";
  print_entries(out, true);

  out << "\nOptions: --option key=value, a line of an options file, or an AMPL option. A key may be shortened as long "
         "as\n"
         "it is unique. Defaults a method, '-' where the option has no effect on it; auto has path's, miles, nesqp,\n"
         "newton-min and semismooth have those of josephy, qpcomp, proxi and semicomp but escape_rounds = 0, and "
         "miles\n"
         "and nesqp a monotone search; semismooth-min and semismooth-penalised are semismooth with another "
         "cfunction:\n\n";
  defaults(false).print(out, 2);
  out << "\nFor affine problems:\n\n";
  defaults(true).print(out, 2);

  out << "\nWhat they mean:\n\n";
  for (const Option& option : options()) {
    out << "  " << option.key;
    if (!option.aliases.empty()) out << fmt::format(" ({})", fmt::join(option.aliases, ", "));
    out << "\n      " << option.help << '\n';
  }

  out << "\nOptions of PATH that are accepted, so that its option files can be read, but have no effect in this "
         "version:\n";
  print_wrapped(out, ignored_options(), 2, 100);
  return exit_solved;
}

}  // namespace perp::app
